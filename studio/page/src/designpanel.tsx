// A motion of one's own: sources, obstacles and winds are drawn, simulated, and given the look of a clip.
import type { JSX } from "preact";
import { Circle, Square, Wind } from "lucide-preact";
import { FilmSection, LayOver, useWay } from "./filmsection";
import { Choice, named, Section, Select, Slider, Switch } from "./parts";
import * as state from "./state";
import type { Design, Document } from "./types";
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
  const way = useWay(kWay, design);
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
        <Select label="Clip" value={design.look} options={[["", "As simulated (quick)"], ...named(clips.map(({ name }) => name))]} onChange={(look) => change({ look })} />
        {design.look && (
          <Select label="It was filmed" value={design.ground} options={[["black", "on black (light: fire)"], ["white", "on white"], ["none", "all of it fluid"]] as const} onChange={(ground) => change({ ground })} />
        )}
        <Slider label="Length" value={design.frames / 25} min={0.4} max={8} step={0.2} shown={`${(design.frames / 25).toFixed(1)} s`} onInput={(value) => change({ frames: Math.round(value * 25) }, "design-frames")} />
        <Switch label="Full size" hint="Without it a draft, 400 px wide or high" checked={design.full} onChange={(full) => change({ full })} />
      </Section>
      <FilmSection name={kWay} way={way} ready={true} />
      {way?.film && design.look && <LayOver film="design" blend={design.ground === "black" ? "screen" : "over"} />}
      {way?.film && !design.look && <p class="hint section">Shown over the picture here. Its file has it on black, to be laid over by Screen or Add; with a clip's look the picture is in it.</p>}
    </>
  );
}
