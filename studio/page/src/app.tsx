// The page: a way in, and the work area.
import type { JSX } from "preact";
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { ArrowLeft, CircleDashed, Download, Maximize, Pause, Play, Redo2, Repeat, SlidersHorizontal, SplitSquareHorizontal, Undo2, ZoomIn, ZoomOut } from "lucide-preact";
import { Canvas } from "./canvas";
import { removeLine } from "./cliplines";
import { Exporter } from "./exporter";
import { HomePage } from "./homepage";
import { KeysDialog } from "./keys";
import { kModeNames, kModes } from "./modes";
import { addressed, go } from "./navigation";
import { IconButton } from "./parts";
import * as state from "./state";
import { ThemeButton } from "./themebutton";
import * as view from "./view";
import { stageWords } from "./words";

export function App(): JSX.Element {
  const [fault, setFault] = useState("");
  useEffect(() => {
    const open = (): void => {
      const id = addressed();
      setFault("");
      (id ? state.openProject(id) : state.showHome()).catch((error: Error) => setFault(error.message));
    };
    open();
    window.addEventListener("hashchange", open);
    return () => window.removeEventListener("hashchange", open);
  }, []);
  return (
    <>
      {fault ? (
        <main class="notice">
          <h1>That did not open</h1>
          <p>{fault}</p>
          <button type="button" class="primary" onClick={() => go("")}>
            All projects
          </button>
        </main>
      ) : state.project.value ? (
        <Work />
      ) : state.home.value ? (
        <HomePage />
      ) : (
        <main class="notice" aria-busy="true" />
      )}
      <Toast />
    </>
  );
}

function Toast(): JSX.Element {
  const text = state.toast.value;
  useEffect(() => {
    if (!text) return;
    const timer = window.setTimeout(() => (state.toast.value = ""), 8000);
    return () => window.clearTimeout(timer);
  }, [text]);
  const words = state.connected.value ? text : "The studio's server is away. What you draw is kept here until it is back.";
  return (
    <div class="toasts" role="status" aria-live="polite">
      {words && (
        <p class="toast">
          {words}
          {state.connected.value && (
            <button type="button" class="quiet small" onClick={() => (state.toast.value = "")}>
              Dismiss
            </button>
          )}
        </p>
      )}
    </div>
  );
}

function Work(): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  const canvas = useRef<Canvas | null>(null);
  const [exporting, setExporting] = useState(false);
  const [panel, setPanel] = useState(true);
  const [keys, setKeys] = useState(false);
  const open = state.project.value;
  useEffect(() => {
    if (!box.current) return;
    const made = new Canvas(box.current);
    canvas.current = made;
    return () => made.end();
  }, []);
  useEffect(() => canvas.current?.refit(), [panel]);
  // Where there is no room for all of them, the one that is chosen is in sight.
  useEffect(() => document.querySelector(".modes [aria-pressed=true]")?.scrollIntoView({ block: "nearest", inline: "center" }), [state.mode.value]);
  useShortcuts(canvas, () => setExporting(true), () => setKeys(true));
  const zoom = view.zoom.value;
  return (
    <main class={`work ${panel ? "" : "panel-away"}`}>
      <h1 class="unseen">{open?.id}</h1>
      <div class="canvas" ref={box} role="application" aria-label="The picture: draw on it with the pointer" onContextMenu={(event) => event.preventDefault()} />
      <header class="bar">
        <IconButton icon={ArrowLeft} label="All projects" onClick={() => go("")} />
        <span class="title" title={open?.folder}>
          {open?.id}
        </span>
        <nav class="modes" aria-label="What to work on">
          {kModeNames.map((id, i) => (
            <button key={id} type="button" aria-pressed={state.mode.value === id} title={`${kModes[id].label}  (${i + 1})`} onClick={() => { state.mode.value = id; setPanel(true); }}>
              {kModes[id].label}
            </button>
          ))}
        </nav>
        <span class="spread" />
        <span class="saved" role="status">
          {state.saving.value === "offline" ? "Not saved" : state.saving.value === "saving" ? "Saving" : "Saved"}
        </span>
        <IconButton icon={Undo2} label="Undo" shortcut="Ctrl+Z" disabled={!state.canUndo.value} onClick={state.undo} />
        <IconButton icon={Redo2} label="Redo" shortcut="Ctrl+Shift+Z" disabled={!state.canRedo.value} onClick={state.redo} />
        <ThemeButton />
        <IconButton icon={SlidersHorizontal} label="Show or hide the settings" pressed={panel} class="panel-toggle" onClick={() => setPanel(!panel)} />
        <button type="button" class="primary" aria-label="Export" title="Export  (Ctrl+E)" onClick={() => setExporting(true)}>
          <Download size={16} aria-hidden /> <span>Export</span>
        </button>
      </header>
      {panel && <Panel />}
      <Transport />
      <div class="zooms">
        <IconButton icon={ZoomOut} label="Smaller" shortcut="-" onClick={() => canvas.current?.zoomBy(1 / 1.4)} />
        <button type="button" class="quiet small" title="Show at 100 %" onClick={() => canvas.current?.zoomTo(1)}>
          {Math.round(zoom * 100)} %
        </button>
        <IconButton icon={ZoomIn} label="Larger" shortcut="+" onClick={() => canvas.current?.zoomBy(1.4)} />
        <IconButton icon={Maximize} label="Fit" shortcut="0" onClick={() => canvas.current?.fit()} />
      </div>
      <KeysDialog open={keys} onClose={() => setKeys(false)} />
      <Exporter open={exporting} onClose={() => setExporting(false)} />
    </main>
  );
}

function statusWords(): string {
  if (state.problem.value) return state.problem.value;
  const job = state.previewJob.value;
  if (view.arriving.value) return "Opening the picture…";
  if (kModes[state.mode.value].way) return "";
  if (!state.doc.value?.store) return "Choose a store under Look, and it moves.";
  if (!state.matte.value && !job) return "Scribble on what flows.";
  if (job && job.state === "running" && job.stage)
    return job.of > 0 ? `${stageWords(job.stage)} ${Math.round((100 * job.done) / job.of)} %` : `${stageWords(job.stage)}…`;
  return "";
}

function Panel(): JSX.Element | null {
  const document = state.doc.value;
  const Chosen = kModes[state.mode.value].panel;
  return document && (
    <aside class="panel" aria-label="Settings">
      <Chosen document={document} />
    </aside>
  );
}

function Transport(): JSX.Element {
  const player = state.player;
  const reel = player.reel.value;
  const coming = player.coming.value;
  const total = reel?.news.total ?? 0;
  const busy = !!state.previewJob.value;
  const made = coming ? coming.loaded / Math.max(1, coming.news.total) : 0;
  return (
    <footer class="transport" data-state={busy || coming || state.saving.value !== "saved" ? "busy" : (reel?.news.stage ?? "none")} data-reel={reel?.news.number ?? 0}>
      <div class="row">
        <IconButton icon={player.playing.value ? Pause : Play} label={player.playing.value ? "Pause" : "Play"} shortcut="Space" disabled={!reel} onClick={() => player.toggle()} class="play" />
        <input
          type="range"
          class="scrub"
          aria-label="Frame"
          min={0}
          max={Math.max(1, total - 1)}
          value={player.told.value}
          disabled={!reel}
          style={{ "--fill": `${(100 * player.told.value) / Math.max(1, total - 1)}%` }}
          onInput={(event) => {
            player.playing.value = false;
            player.seek(event.currentTarget.valueAsNumber);
          }}
        />
        <output class="time">
          {reel ? `${(player.told.value / reel.news.fps).toFixed(2)} s` : "–"}
        </output>
        <select class="rate" aria-label="Speed of playing" value={String(player.rate.value)} onChange={(event) => (player.rate.value = Number(event.currentTarget.value))}>
          {[0.25, 0.5, 1, 2].map((rate) => (
            <option key={rate} value={String(rate)}>
              {rate} ×
            </option>
          ))}
        </select>
        <IconButton icon={Repeat} label="Play again and again" pressed={player.loop.value} onClick={() => (player.loop.value = !player.loop.value)} />
        {state.doc.value?.moving_outline && (
          <IconButton icon={CircleDashed} label="Outlines before (blue) and after (orange)" shortcut="O" pressed={view.onion.value} onClick={() => (view.onion.value = !view.onion.value)} />
        )}
        <IconButton icon={SplitSquareHorizontal} label="Compare with the picture" shortcut="C" pressed={view.compare.value !== null} onClick={() => (view.compare.value = view.compare.value === null ? 0.5 : null)} />
      </div>
      {view.compare.value !== null && (
        <input type="range" class="split" aria-label="How much of the picture as it was" min={0} max={1000} value={view.compare.value * 1000} style={{ "--fill": `${view.compare.value * 100}%` }} onInput={(event) => (view.compare.value = event.currentTarget.valueAsNumber / 1000)} />
      )}
      <div class={`progress ${busy ? "busy" : ""}`} aria-hidden>
        <span style={{ width: `${100 * made}%` }} />
      </div>
      <p class={`status ${state.problem.value ? "problem" : ""}`} role="status">
        {statusWords()}
        {!state.problem.value && !busy && reel && <span class="stage-words">{reel.news.stage === "small" ? "First look" : `${reel.news.width} × ${reel.news.height}`}</span>}
      </p>
    </footer>
  );
}

function useShortcuts(canvas: { current: Canvas | null }, exportNow: () => void, showKeys: () => void): void {
  // With the first sight of the page: an effect that waits for a frame lost keys on a busy machine.
  useLayoutEffect(() => {
    let byPointer = false; // how what has the focus was come to; :focus-visible is true for any once a key is pressed
    const press = (): void => {
      byPointer = true;
    };
    const down = (event: KeyboardEvent): void => {
      if (event.key === "Tab") byPointer = false;
      const target = event.target as HTMLElement;
      const types = target.matches("input:not([type=range], [type=checkbox]), textarea, select") || !!target.closest("dialog");
      if (types) return;
      const key = event.key.toLowerCase();
      if (event.ctrlKey || event.metaKey) {
        if (key === "z") event.shiftKey ? state.redo() : state.undo();
        else if (key === "y") state.redo();
        else if (key === "e") exportNow();
        else return;
        event.preventDefault();
        return;
      }
      if (event.key === " ") {
        // A button that was clicked keeps the focus, but is not what the space bar is for; one that Tab came to is.
        if (target.matches("summary, a, [type=checkbox]") || (target.matches("button") && !byPointer)) return;
        if (target.matches("button")) target.blur();
        event.preventDefault();
        if (!event.repeat) spaceDown(true);
        return;
      }
      const tools: Record<string, view.FluidTool> = { b: "fluid", n: "still", p: "paint", e: "erase", a: "area", h: "hold" };
      const chosen = tools[key];
      const numbered = kModeNames[Number(key) - 1];
      if (chosen && state.mode.value === "fluid") view.fluidTool.value = chosen;
      else if (numbered) state.mode.value = numbered;
      else if (key === "[") view.brush.value = Math.max(2, view.brush.value / 1.2);
      else if (key === "]") view.brush.value = Math.min(400, view.brush.value * 1.2);
      else if (key === "+" || key === "=") canvas.current?.zoomBy(1.4);
      else if (key === "-") canvas.current?.zoomBy(1 / 1.4);
      else if (key === "0") canvas.current?.fit();
      else if (key === "?") showKeys();
      else if (key === "o" && state.doc.value?.moving_outline) view.onion.value = !view.onion.value;
      else if (key === "c") view.compare.value = view.compare.value === null ? 0.5 : null;
      else if ((key === "arrowleft" || key === "arrowright") && !target.matches("input, button")) {
        state.player.playing.value = false;
        state.player.seek(state.player.frame.value + (key === "arrowleft" ? -1 : 1));
      } else if (key === "delete" || key === "backspace") removeSelected();
      else if (key === "enter" && view.corners.value > 0) canvas.current?.closeCorners();
      else if (key === "escape") {
        canvas.current?.dropCorners();
        view.selected.value = null;
        view.line.value = null;
        view.piece.value = null;
      }
    };
    const up = (event: KeyboardEvent): void => {
      if (event.key === " ") spaceDown(false);
    };
    window.addEventListener("pointerdown", press, true);
    window.addEventListener("keydown", down);
    window.addEventListener("keyup", up);
    return () => {
      window.removeEventListener("pointerdown", press, true);
      window.removeEventListener("keydown", down);
      window.removeEventListener("keyup", up);
    };
  }, []);
}

let spaceTime = 0;
/** A tap of the space bar plays; held, it lets the pointer move the picture. */
function spaceDown(yes: boolean): void {
  if (yes) {
    spaceTime = performance.now();
    view.panned.value = false;
    view.panning.value = true;
    return;
  }
  if (view.panning.value && !view.panned.value && performance.now() - spaceTime < 250) state.player.toggle();
  view.panning.value = false;
}

function removeSelected(): void {
  const chosen = view.selected.value;
  const document = state.doc.value;
  if (state.mode.value === "flowlines") return removeLine();
  if (chosen === null || !document || state.mode.value !== "flow") return;
  state.edit({ strokes: document.strokes.filter((_, i) => i !== chosen) });
  view.selected.value = null;
}
