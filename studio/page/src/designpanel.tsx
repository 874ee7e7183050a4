// A motion of one's own: sources, obstacles and winds are drawn, simulated, and given the look of a clip.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { Circle, Square, Wind } from "lucide-preact";
import * as api from "./api";
import { stageWords } from "./app";
import { Choice, CommandLine, Running, Section, Slider, Switch } from "./parts";
import * as state from "./state";
import type { Design, Document, Ground, Way } from "./types";
import * as view from "./view";

const kWay = "design";
const kTools = [
  ["source", "Source", Circle, "Draw where it comes from. The brush is as wide as the vent."],
  ["obstacle", "Obstacle", Square, "Draw what it must go around."],
  ["wind", "Wind", Wind, "Draw an arrow: as long as the wind goes in a second."],
] as const;

export function DesignPanel({ document }: { document: Document }): JSX.Element {
  const { design } = document;
  const change = (part: Partial<Design>, key = ""): void => state.edit({ design: { ...design, ...part } }, key);
  const tool = view.designTool.value;
  const clips = state.store.value?.clips ?? [];
  return (
    <>
      <Section title="A motion of your own">
        <Choice label="Fluid" value={design.fluid} options={[["smoke", "Smoke"], ["fire", "Fire"], ["water", "Water"]] as const} onChange={(fluid) => change({ fluid })} />
        <div class="tools" role="group" aria-label="Drawing tools">
          {kTools.map(([id, label, Icon]) => (
            <button key={id} type="button" class="tool" aria-pressed={tool === id} onClick={() => (view.designTool.value = id)}>
              <Icon size={18} strokeWidth={1.75} aria-hidden />
              <span>{label}</span>
            </button>
          ))}
        </div>
        <p class="hint">{kTools.find(([id]) => id === tool)?.[3]}</p>
        {tool !== "wind" && (
          <Slider label="Brush" value={view.brush.value} min={2} max={400} logarithmic shown={`${Math.round(view.brush.value)} px`} onInput={(value) => (view.brush.value = value)} />
        )}
        <button type="button" class="quiet" disabled={design.sources.length + design.winds.length === 0} onClick={() => change({ sources: [], winds: [] })}>
          Clear
        </button>
      </Section>
      <Section title="Looks like">
        <label class="field">
          <span>Clip</span>
          <select value={design.look} onChange={(event) => change({ look: event.currentTarget.value })}>
            <option value="">As simulated (quick)</option>
            {clips.map((clip) => (
              <option key={clip.name} value={clip.name}>
                {clip.name}
              </option>
            ))}
          </select>
        </label>
        {design.look && (
          <label class="field">
            <span>It was filmed</span>
            <select value={design.ground} onChange={(event) => change({ ground: event.currentTarget.value as Ground })}>
              <option value="black">on black (light: fire)</option>
              <option value="white">on white</option>
              <option value="none">all of it fluid</option>
            </select>
          </label>
        )}
        <Slider label="Length" value={design.frames / 25} min={0.4} max={8} step={0.2} shown={`${(design.frames / 25).toFixed(1)} s`} onInput={(value) => change({ frames: Math.round(value * 25) }, "design-frames")} />
        <Switch label="Full size" hint="Without it a draft, 400 px wide or high" checked={design.full} onChange={(full) => change({ full })} />
      </Section>
      <FilmSection design={design} />
    </>
  );
}

function FilmSection({ design }: { design: Design }): JSX.Element {
  const id = state.project.value?.id ?? "";
  const [way, setWay] = useState<Way | null>(null);
  const [fault, setFault] = useState("");
  const saved = state.saving.value === "saved";
  const job = Object.values(state.jobs.value).filter((each) => each.key === `way ${id}/${kWay}`).at(-1);
  const runs = job?.state === "running" || job?.state === "waiting";
  const films = state.filmed.value;
  useEffect(() => {
    if (!saved) return;
    api.way(id, kWay).then(setWay, () => setWay(null)); // nothing is drawn yet
  }, [id, saved, films, design]);
  const source = way?.film ? api.address.film(id, kWay, way.film) : null;
  useEffect(() => {
    view.film.value = source;
    return () => {
      view.film.value = null;
    };
  }, [source]);
  const start = (): void => {
    setFault("");
    api.runWay(id, kWay).catch((error: Error) => setFault(error.message));
  };
  return (
    <Section title="Film">
      <div class="row">
        {source && (
          <a class="button small" href={source} download={`${id}-${kWay}.mp4`}>
            Save
          </a>
        )}
        <span class="spread" />
        {runs && job ? (
          <button type="button" onClick={() => void api.stopJob("command", job.id)}>
            Stop
          </button>
        ) : (
          <button type="button" class="primary" disabled={!way || !saved} onClick={start}>
            Make it
          </button>
        )}
      </div>
      {runs && job && <Running job={job} label="Film" words={stageWords(job.stage)} />}
      {(fault || job?.state === "failed") && <p class="problem">{fault || job?.fault}</p>}
      {way?.commands.map((line) => <CommandLine key={line} text={line} />)}
    </Section>
  );
}
