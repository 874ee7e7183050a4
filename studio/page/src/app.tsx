// The page: a way in, and the work area.
import type { JSX } from "preact";
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { ArrowLeft, Download, Maximize, Redo2, SlidersHorizontal, Undo2, ZoomIn, ZoomOut } from "lucide-preact";
import { Canvas } from "./canvas";
import { removeLine } from "./cliplines";
import { Exporter } from "./exporter";
import { HomePage } from "./homepage";
import { KeysDialog } from "./keys";
import { kModeNames, kModes } from "./modes";
import { LargePicture } from "./largepicture";
import { NameDialog } from "./namedialog";
import { addressed, go } from "./navigation";
import { IconButton } from "./parts";
import * as state from "./state";
import { pinBegun, removePin } from "./stillpins";
import { ThemeButton } from "./themebutton";
import { takesShown } from "./takes";
import { stepFrame, togglePlaying, Transport } from "./transport";
import * as view from "./view";

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
  const [naming, setNaming] = useState(false);
  const open = state.project.value;
  useEffect(() => {
    if (!box.current) return;
    const made = new Canvas(box.current);
    canvas.current = made;
    return () => made.end();
  }, []);
  useEffect(() => canvas.current?.refit(), [panel, takesShown.value, state.takes.value]);
  const modes = useRef<HTMLElement>(null);
  // Which edges have more of them beyond.
  const hint = (): void => {
    const nav = modes.current;
    if (!nav) return;
    const beyond = nav.scrollWidth - nav.clientWidth;
    nav.dataset["more"] = [nav.scrollLeft > 4 ? "before" : "", nav.scrollLeft < beyond - 4 ? "after" : ""].join(" ").trim();
  };
  useEffect(() => {
    hint();
    window.addEventListener("resize", hint);
    return () => window.removeEventListener("resize", hint);
  }, []);
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
        <button type="button" class="title quiet" title={`Rename; it lies in ${open?.folder}`} onClick={() => setNaming(true)}>
          {open?.id}
        </button>
        <nav class="modes" aria-label="What to work on" ref={modes} onScroll={hint}>
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
      {open && <NameDialog key={open.id} id={open.id} open={naming} onClose={() => setNaming(false)} named={go} />}
      {open && <LargePicture key={`${open.id} large`} open={open} />}
      <KeysDialog open={keys} onClose={() => setKeys(false)} />
      <Exporter open={exporting} onClose={() => setExporting(false)} />
    </main>
  );
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
      else if (key === "t") takesShown.value = !takesShown.value;
      else if (key === "?") showKeys();
      else if (key === "o" && state.doc.value?.moving_outline) view.onion.value = !view.onion.value;
      else if (key === "c") view.compare.value = view.compare.value === null ? 0.5 : null;
      else if ((key === "arrowleft" || key === "arrowright") && !target.matches("input, button")) {
        stepFrame(key === "arrowleft" ? -1 : 1);
      } else if (key === "delete" || key === "backspace") removeSelected();
      else if (key === "enter" && view.corners.value > 0) canvas.current?.closeCorners();
      else if (key === "escape") {
        canvas.current?.dropCorners();
        view.selected.value = null;
        view.line.value = null;
        view.pin.value = null;
        pinBegun.value = null;
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
  if (view.panning.value && !view.panned.value && performance.now() - spaceTime < 250) togglePlaying();
  view.panning.value = false;
}

function removeSelected(): void {
  const chosen = view.selected.value;
  const document = state.doc.value;
  if (state.mode.value === "flowlines") return removeLine();
  if (state.mode.value === "stills") return removePin(view.pin.value);
  if (chosen === null || !document || state.mode.value !== "flow") return;
  state.edit({ strokes: document.strokes.filter((_, i) => i !== chosen) });
  view.selected.value = null;
}
