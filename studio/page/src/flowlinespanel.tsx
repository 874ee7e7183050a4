// A clip that goes on without an end: its flow lines, and where they shall lie instead.
import type { JSX } from "preact";
import { useEffect } from "preact/hooks";
import { Trash2 } from "lucide-preact";
import * as api from "./api";
import { addPosition, changeLine, inputLines, inputOf, linesOf, kMostPositions, pairLine, positionOf, removeLine, removePosition, shownLines, timePosition } from "./cliplines";
import { FilmSection, LayOver, runKept, useWay, wayJob } from "./filmsection";
import { DropClip, useOwnClips } from "./ownclips";
import { Choice, CommandLine, IconButton, named, Running, Section, Select, Slider, Switch } from "./parts";
import * as state from "./state";
import type { ClipLine, Document, Flowlines, Way } from "./types";
import * as view from "./view";
import { stageWords } from "./words";

const kWay = "flowlines";
const kFind = "lines";

type Change = (part: Partial<Flowlines>, key?: string) => void;

export function FlowlinesPanel({ document }: { document: Document }): JSX.Element {
  const { flowlines } = document;
  const way = useWay(kWay, flowlines);
  const found = useWay(kFind, flowlines.clip);
  useFrame(flowlines, document.store);
  useFoundLines(found);
  const change: Change = (part, key = "") => state.edit({ flowlines: { ...flowlines, ...part } }, key);
  const clip = flowlines.dropped ? undefined : state.store.value?.clips.find(({ name }) => name === flowlines.clip);
  const fps = clip?.fps ?? 25;
  return (
    <>
      <ClipSection flowlines={flowlines} />
      {flowlines.clip && (
        <>
          <LinesSection flowlines={flowlines} found={found} change={change} />
          <LineSection />
          <Section title="How it goes on">
            <Slider label="Length" value={flowlines.frames} min={25} max={2500} logarithmic shown={clip ? `${(flowlines.frames / fps).toFixed(1)} s` : `${flowlines.frames} frames`} onInput={(frames) => change({ frames: Math.round(frames) }, "flowlines-frames")} />
            <Switch label="Seamless loop" checked={flowlines.loop} onChange={(loop) => change({ loop })} />
            <Switch label="A camera that moves" hint="Without it such a clip is refused" checked={flowlines.moving_camera} onChange={(moving_camera) => change({ moving_camera })} />
          </Section>
          <FilmSection name={kWay} way={way} ready={true} />
          {way?.film && <LayOver film="flowlines" blend={flowlines.ground === "black" ? "screen" : "over"} ground={flowlines.ground === "white" ? "white" : "none"} />}
        </>
      )}
    </>
  );
}

/** The clip's first frame on the canvas, in place of the picture. */
function useFrame({ clip, dropped }: Flowlines, store: string): void {
  const id = state.project.value?.id ?? "";
  useEffect(() => {
    if (!clip) return;
    const image = new Image();
    let alive = true;
    image.onload = () => {
      if (alive) view.ground.value = image;
    };
    image.onerror = () => {
      if (alive) state.toast.value = "The clip cannot be shown.";
    };
    image.src = api.address.clipFrame(id, clip, dropped);
    return () => {
      alive = false;
      view.ground.value = null;
      view.line.value = null;
    };
  }, [id, clip, dropped, store]);
}

function useFoundLines(found: Way | null): void {
  const id = state.project.value?.id ?? "";
  const number = found?.made ?? null;
  const file = found?.shown[0] ?? "";
  useEffect(() => {
    view.foundLines.value = [];
    if (!number) return;
    let alive = true;
    api.foundLines(id, file, number).then(
      (svg) => {
        if (alive) view.foundLines.value = linesOf(svg);
      },
      () => undefined, // none were found yet
    );
    return () => {
      alive = false;
    };
  }, [id, file, number]);
}

function ClipSection({ flowlines }: { flowlines: Flowlines }): JSX.Element {
  const own = useOwnClips(flowlines.clip);
  const choose = (clip: string, dropped: boolean): void => {
    view.foundLines.value = [];
    state.edit({ flowlines: { ...(state.doc.value?.flowlines ?? flowlines), clip, dropped, lines: [], edited: [] } });
  };
  const clips = state.store.value?.clips ?? [];
  const value = flowlines.clip ? `${flowlines.dropped ? "own" : "store"}:${flowlines.clip}` : "";
  return (
    <Section title="A clip without an end">
      <label class="field">
        <span>Clip</span>
        <select
          value={value}
          onChange={(event) => {
            const [where = "", ...name] = event.currentTarget.value.split(":");
            choose(name.join(":"), where === "own");
          }}
        >
          <option value="">Choose one</option>
          {own.map((name) => (
            <option key={`own:${name}`} value={`own:${name}`}>
              {name}
            </option>
          ))}
          {clips.map(({ name }) => (
            <option key={`store:${name}`} value={`store:${name}`}>
              {name}
            </option>
          ))}
        </select>
      </label>
      <DropClip taken={(clip) => choose(clip, true)} />
    </Section>
  );
}

function LinesSection({ flowlines, found, change }: { flowlines: Flowlines; found: Way | null; change: Change }): JSX.Element {
  const id = state.project.value?.id ?? "";
  const job = wayJob(id, kFind);
  const runs = job?.state === "running" || job?.state === "waiting";
  const saved = state.saving.value === "saved";
  const input = inputLines();
  const edits = flowlines.edited.length > 0;
  return (
    <Section title="Flow lines" aside={<span class="figure">{input.length || ""}</span>}>
      <p class="hint">
        {input.length === 0
          ? "Find the lines that its fluid flows along, or draw them."
          : view.lineTool.value === "edited"
            ? "Drag a line, or its handles, to where the fluid shall go. A line drawn anew is a copy of the chosen one, or of the nearest."
            : "Draw along the flow, in its direction. Delete takes the chosen line away."}
      </p>
      <div class="row">
        {runs && job ? (
          <button type="button" onClick={() => void api.stopJob("command", job.id)}>
            Stop finding
          </button>
        ) : (
          <button type="button" class={input.length === 0 ? "primary" : "quiet"} disabled={!saved} onClick={() => { change({ lines: [], edited: [] }); void find(id); }}>
            Find lines
          </button>
        )}
      </div>
      {runs && job && <Running job={job} label="Finding lines" words={stageWords(job.stage)} />}
      {job?.state === "failed" && <p class="problem">{job.fault}</p>}
      <Choice label="Which lines the pointer changes" value={view.lineTool.value} options={[["edited", "Shall flow"], ["lines", "Flows"]] as const} onChange={(tool) => { view.lineTool.value = tool; view.line.value = null; }} />
      {edits && (
        <>
          <Slider label="Join neighbours" value={flowlines.join} min={0} max={400} step={5} shown={flowlines.join === 0 ? "as they lie" : `${flowlines.join} px`} onInput={(join) => change({ join }, "flowlines-join")} />
          <Switch label="Stretched" hint="The whole line's texture onto the changed one" checked={flowlines.stretched} onChange={(stretched) => change({ stretched })} />
          <Select label="It was filmed" value={flowlines.ground} options={[["none", "in front of something"], ["black", "on black (light: fire)"], ["white", "on white"]] as const} onChange={(ground) => change({ ground })} />
          <button type="button" class="quiet" onClick={() => { view.line.value = null; change({ edited: [] }); }}>
            As it flows in the clip
          </button>
        </>
      )}
      {found?.commands.map((line) => <CommandLine key={line} text={line} />)}
    </Section>
  );
}

async function find(id: string): Promise<void> {
  try {
    await runKept(id, kFind);
  } catch (fault) {
    state.toast.value = (fault as Error).message;
  }
}

function LineSection(): JSX.Element | null {
  const chosen = view.line.value;
  const line = chosen === null ? undefined : shownLines()[chosen];
  if (!line || chosen === null) return null;
  return (
    <Section title={`Line ${line.id}`} aside={<IconButton icon={Trash2} label="Take this line away" shortcut="Delete" onClick={removeLine} />}>
      {view.lineTool.value === "edited" ? (
        <EditedLine line={line} index={chosen} />
      ) : (
        <button type="button" class="quiet" onClick={() => changeLine(chosen, { points: [...line.points].reverse() })}>
          Turn the line round
        </button>
      )}
    </Section>
  );
}

function EditedLine({ line, index }: { line: ClipLine; index: number }): JSX.Element {
  const input = inputLines();
  const first = line.speeds[0] ?? 1;
  const last = line.speeds[line.speeds.length - 1] ?? 1;
  const changes = line.speeds.length > 1;
  const say = (...speeds: number[]): void => changeLine(index, { speeds: speeds.map((speed) => Number(speed.toFixed(2))) }, "line-speed");
  const times = (speed: number): string => `${speed.toFixed(2)} ×`;
  return (
    <>
      <Select label="Shows the texture of" value={inputOf(line.id, input)} options={named(input.map(({ id }) => id))} onChange={(id) => pairLine(index, id)} />
      <Slider label={changes ? "Pace where it begins" : "Pace"} value={first} min={0.25} max={4} logarithmic shown={times(first)} onInput={(speed) => (changes ? say(speed, last) : say(speed))} />
      {changes && <Slider label="Pace where it ends" value={last} min={0.25} max={4} logarithmic shown={times(last)} onInput={(speed) => say(first, speed)} />}
      <Switch label="Another pace at its end" checked={changes} onChange={(yes) => (yes ? say(first, last) : say(first))} />
      <Positions line={line} index={index} />
    </>
  );
}

/** A line that moves: where it lies at which time. */
function Positions({ line, index }: { line: ClipLine; index: number }): JSX.Element {
  const chosen = positionOf(line);
  const now = line.later[chosen - 1];
  return (
    <>
      <div class="row wraps" role="group" aria-label="Positions in time">
        {line.later.length > 0 &&
          [0, ...line.later.map(({ time }) => time)].map((time, i) => (
            <button key={i} type="button" class="small" aria-pressed={i === chosen} onClick={() => (view.position.value = i)}>
              {time.toFixed(2)} s
            </button>
          ))}
        <button type="button" class="small quiet" disabled={line.later.length >= kMostPositions} onClick={() => addPosition(index)}>
          {line.later.length > 0 ? "Another" : "Moves in time…"}
        </button>
      </div>
      {line.later.length > 0 && <p class="hint">Drag the line to where it lies at that time. In a loop it goes back to the first.</p>}
      {now && (
        <>
          <Slider label="At" value={now.time} min={0.04} max={Math.max(now.time, (state.doc.value?.flowlines.frames ?? 500) / 25)} step={0.04} shown={`${now.time.toFixed(2)} s`} onInput={(time) => timePosition(index, time)} />
          <button type="button" class="quiet" onClick={() => removePosition(index)}>
            Take this position away
          </button>
        </>
      )}
    </>
  );
}
