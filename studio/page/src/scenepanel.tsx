// A picture in layers that one wind moves: where each is, what it is, and what is drawn for it.
import type { JSX } from "preact";
import { useEffect } from "preact/hooks";
import { ArrowDown, ArrowUp, Brush, Eraser, Shapes, Spline, Trash2 } from "lucide-preact";
import * as api from "./api";
import { FilmSection, useWay } from "./filmsection";
import { addLayer, changeLayer, changeLayerOf, changeScene, chooseLayer, chosenLayer, findLayers, kMotions, moveLayer, placeFilm, removeLayer } from "./layers";
import { layersProblem, liveLayers, renewLayers } from "./livelayers";
import { DropClip, useOwnClips } from "./ownclips";
import { Choice, IconButton, named, Section, Select, Slider, Switch } from "./parts";
import * as state from "./state";
import { SwayChoice } from "./swaychoice";
import type { Blend, Document, DrawnLayer, DrawnScene, Ground, LayerFilm, LayerMatte, LayerMotion } from "./types";
import * as view from "./view";

const kWay = "scene";
const kFilmed = new Map<string, DrawnScene | null>(); // what films show, by their numbers
const kMattes: readonly (readonly [LayerMatte, string])[] = [["painted", "Painted"], ["scribbled", "Scribbled"], ["rest", "The rest"]];
const kBlends: readonly (readonly [Blend, string])[] = [["over", "Covers it"], ["screen", "Its light, by Screen"], ["add", "Its light, added"]];
const kTools = [
  ["paint", "Paint", Brush],
  ["erase", "Erase", Eraser],
  ["area", "Area", Shapes],
  ["line", "Line", Spline],
] as const;

export function ScenePanel({ document }: { document: Document }): JSX.Element {
  const { scene } = document;
  const way = useWay(kWay, scene);
  const id = state.project.value?.id ?? "";
  const layer = chosenLayer();
  const saved = state.saving.value === "saved";
  useEffect(() => {
    if (saved) findLayers(id);
  }, [id, saved, scene.layers]);
  const kept = state.keptScene.value;
  useEffect(() => {
    if (kept && kept.layers.length > 0) void renewLayers(id);
  }, [id, kept]);
  const film = way?.film ?? "";
  if (film && !kFilmed.has(film)) kFilmed.set(film, kept);
  return (
    <>
      <ListSection layers={scene.layers} />
      {layer && <LayerSection layer={layer} />}
      {scene.layers.length > 0 && (
        <>
          <WindSection scene={scene} />
          {layersProblem.value && !way?.lacks && <p class="problem section">{layersProblem.value}</p>}
          <FilmSection name={kWay} way={way} ready={true} live={!!liveLayers.reel.value} stale={film !== "" && kept !== kFilmed.get(film)} said={way?.lacks ? "" : layersProblem.value} />
          {way?.made && way.shown[0] && (
            <Section title="What was understood">
              <img class="sheet" src={api.address.wayFile(id, kWay, way.shown[0], way.made)} alt="The layers, their lines, and the water's plane" />
            </Section>
          )}
        </>
      )}
    </>
  );
}

function ListSection({ layers }: { layers: DrawnLayer[] }): JSX.Element {
  const chosen = view.layer.value;
  return (
    <Section title="Layers" aside={<span class="figure">{layers.length || ""}</span>}>
      <p class="hint">{layers.length === 0 ? "Add what moves: it is painted over the picture. What is left stands still." : "The nearest first."}</p>
      {layers.length > 0 && (
        <ul class="layers">
          {layers.map((layer, i) => (
            <li key={layer.name}>
              <button type="button" aria-pressed={i === chosen} onClick={() => chooseLayer(i)}>
                <span class="swatch" style={{ background: view.clipColour(i) }} aria-hidden />
                <span class="name">{layer.name}</span>
                <small>{kMotions[layer.motion].label}</small>
              </button>
            </li>
          ))}
        </ul>
      )}
      <label class="field">
        <span>Add a layer</span>
        <select
          value=""
          onChange={(event) => {
            addLayer(event.currentTarget.value as LayerMotion);
            event.currentTarget.value = "";
          }}
        >
          <option value="">Of what kind?</option>
          {Object.entries(kMotions).map(([motion, { label }]) => (
            <option key={motion} value={motion}>
              {label}
            </option>
          ))}
        </select>
      </label>
    </Section>
  );
}

function LayerSection({ layer }: { layer: DrawnLayer }): JSX.Element {
  const tool = view.layerTool.value;
  const words = kMotions[layer.motion].line;
  const film = layer.motion === "footage"; // it brings its own pixels; paint says what of them is seen
  const tools = kTools.filter(([id]) => id === "line" ? !!words : layer.matte !== "rest" && !(film && layer.matte_clip));
  const hints: Record<view.LayerTool, string> = {
    paint: film ? "Paint what of the film is seen. Without paint all of it is." : layer.matte === "scribbled" ? "Scribble on the layer; the rest of it is found." : "Paint where the layer is.",
    erase: film ? "Take away what of the film is not seen." : layer.matte === "scribbled" ? "Scribble beside the layer." : "Take away where the layer is not.",
    area: "Draw around the layer, or click its corners and then the first one again.",
    line: words ?? "",
  };
  return (
    <Section
      title={layer.name}
      aside={
        <span class="row">
          <IconButton icon={ArrowUp} label="Nearer" onClick={() => moveLayer(-1)} />
          <IconButton icon={ArrowDown} label="Further" onClick={() => moveLayer(1)} />
          <IconButton icon={Trash2} label="Remove this layer" onClick={removeLayer} />
        </span>
      }
    >
      <LayerName layer={layer} />
      {!film && <Choice label="Where the layer is" value={layer.matte} options={kMattes} onChange={(matte) => changeLayer({ matte })} />}
      {words && layer.lines.length === 0 && tool !== "line" && <p class="hint">Then choose Line. {words}</p>}
      {tools.length > 0 && (
        <div class="tools four" role="group" aria-label="Drawing tools">
          {tools.map(([id, label, Icon]) => (
            <button key={id} type="button" class="tool" aria-pressed={tool === id} onClick={() => (view.layerTool.value = id)}>
              <Icon size={18} strokeWidth={1.75} aria-hidden />
              <span>{label}</span>
            </button>
          ))}
        </div>
      )}
      {tools.some(([id]) => id === tool) && <p class="hint">{hints[tool]}</p>}
      {(tool === "paint" || tool === "erase") && layer.matte !== "rest" && (
        <Slider label="Brush" value={view.brush.value} min={2} max={400} logarithmic shown={`${Math.round(view.brush.value)} px`} onInput={(value) => (view.brush.value = value)} />
      )}
      <MotionOptions layer={layer} />
      {layer.matte !== "rest" && <Select label="Over what lies behind it" value={layer.blend} options={kBlends} onChange={(blend) => changeLayer({ blend })} />}
      <div class="row">
        <button type="button" class="quiet" disabled={layer.paint.length === 0} onClick={() => changeLayer({ paint: [] })}>
          Clear paint
        </button>
        {words && (
          <button type="button" class="quiet" disabled={layer.lines.length === 0} onClick={() => (film ? placeFilm([]) : changeLayer({ lines: [] }))}>
            {film ? "As wide as the picture" : "Clear lines"}
          </button>
        )}
      </div>
    </Section>
  );
}

function LayerName({ layer }: { layer: DrawnLayer }): JSX.Element {
  const rename = (text: string): void => {
    const name = text.replace(/[^A-Za-z0-9_-]+/g, " ").trim().slice(0, 60);
    const taken = state.doc.value?.scene.layers.some((other) => other !== layer && other.name === name);
    if (name && !taken) changeLayer({ name });
    else if (taken) state.toast.value = "Another layer has this name.";
  };
  return (
    <label class="field">
      <span>Name</span>
      <input key={layer.name} defaultValue={layer.name} onChange={(event) => rename(event.currentTarget.value)} />
    </label>
  );
}

function MotionOptions({ layer }: { layer: DrawnLayer }): JSX.Element | null {
  switch (layer.motion) {
    case "tree":
      return (
        <>
          <Select label="Plant" value={layer.plant} options={[["tree", "Tree"], ["flower", "Flower"], ["grass", "Grass"]] as const} onChange={(plant) => changeLayer({ plant })} />
          <SwayChoice layer={layer} />
          <Slider label="Shimmer of leaves" value={layer.shimmer} {...state.range("tree.shimmer")} step={0.1} shown={`${layer.shimmer.toFixed(1)} px`} onInput={(shimmer) => changeLayer({ shimmer }, "layer-shimmer")} />
        </>
      );
    case "water":
      return (
        <>
          <Slider label="Waves" value={layer.waves} {...state.range("water.amplitude")} step={0.01} shown={layer.waves === 0 ? "as usual" : layer.waves.toFixed(2)} onInput={(waves) => changeLayer({ waves }, "layer-waves")} />
          <Switch label="Mirrors" hint="What moves above it moves in it, too" checked={layer.mirrors} onChange={(mirrors) => changeLayer({ mirrors })} />
          <Glow layer={layer} />
        </>
      );
    case "boat":
      return (
        <>
          <Slider label="Rocks" value={layer.roll} {...state.range("boat.roll")} step={0.1} shown={`${layer.roll.toFixed(1)} ×`} onInput={(roll) => changeLayer({ roll }, "layer-roll")} />
          <Switch label="In three dimensions" hint="It pitches and yaws on the water, too" checked={layer.in_3d} onChange={(in_3d) => changeLayer({ in_3d })} />
        </>
      );
    case "clouds":
      return (
        <>
          <Slider label="Drift" value={layer.drift} {...state.range("clouds.speed")} step={1} shown={layer.drift === 0 ? "with the wind" : `${layer.drift} px/s`} onInput={(drift) => changeLayer({ drift }, "layer-drift")} />
          <Slider label="Shadows on the ground" value={layer.shade} {...state.range("clouds.shade")} step={0.05} shown={layer.shade === 0 ? "none" : layer.shade.toFixed(2)} onInput={(shade) => changeLayer({ shade }, "layer-shade")} />
        </>
      );
    case "patches":
      return (
        <>
          <Select label="Kind of fluid" value={layer.class} options={[["", "As it looks"], ["any", "Any"], ...named(state.classesOf(state.store.value))]} onChange={(kind) => changeLayer({ class: kind })} />
          <Glow layer={layer} />
        </>
      );
    case "footage":
      return (
        <>
          <FilmChoice layer={layer} />
          <Glow layer={layer} />
        </>
      );
    case "still":
      return null;
  }
}

const kGlitter = 5; // glow of glittering water, which is little light: 2 to 5 is usual

function Glow({ layer }: { layer: DrawnLayer }): JSX.Element {
  const { width = 1, height = 1 } = state.project.value ?? {};
  return (
    <>
      <Slider label="Lights what is around it" value={layer.glow} {...state.range("layer.glow")} {...(layer.motion === "water" ? { max: kGlitter } : {})} step={0.01} shown={layer.glow === 0 ? "not" : layer.glow.toFixed(2)} onInput={(glow) => changeLayer({ glow }, "layer-glow")} />
      {layer.glow > 0 && <Slider label="Half as bright after" value={layer.glow_reach} min={0} max={Math.max(width, height, Math.ceil(layer.glow_reach))} step={1} shown={layer.glow_reach === 0 ? "as usual" : `${layer.glow_reach} px`} onInput={(glow_reach) => changeLayer({ glow_reach }, "layer-reach")} />}
    </>
  );
}

const kFilms = { design: "What Design has made", flowlines: "The endless clip of Flow lines", stills: "The film of Stills" } as const;
const kGrounds: readonly (readonly [Ground, string])[] = [["none", "in front of something"], ["black", "on black (light: fire)"], ["white", "on white"]];

function FilmChoice({ layer }: { layer: DrawnLayer }): JSX.Element {
  const own = useOwnClips(layer.clip + layer.matte_clip);
  const document = state.doc.value;
  const stills = useWay("stills", document?.stills);
  const there = { design: !!document?.design.look, flowlines: !!document?.flowlines.clip, stills: stills ? !!stills.film : layer.film === "stills" }; // until the server has said
  const made = (["design", "flowlines", "stills"] as const).filter((film) => there[film]);
  const value = layer.film === "clip" ? `clip:${layer.clip}` : layer.film;
  const known = layer.film === "clip" ? layer.clip !== "" : there[layer.film];
  const choose = (text: string): void => changeLayer(text.startsWith("clip:") ? { film: "clip", clip: text.slice(5) } : { film: text as LayerFilm, ...(text === "design" ? { ground: "none" as const } : {}) });
  const last = Math.max(0, (document?.scene.frames ?? 1) - 1) / 25;
  return (
    <>
      <Select label="Film" value={known ? value : ""} options={[...(known ? [] : [["", "Choose one"] as const]), ...made.map((film) => [film, kFilms[film]] as const), ...own.map((name) => [`clip:${name}`, name] as const)]} onChange={choose} />
      <DropClip taken={(clip) => changeLayerOf(layer.name, { film: "clip", clip })} />
      {layer.film !== "design" && <Select label="It was filmed" value={layer.ground} options={kGrounds} onChange={(ground) => changeLayer({ ground })} />}
      <Select label="Seen" value={layer.matte_clip} options={[["", "all of it, or where it is painted"], ...named(own)]} onChange={(matte_clip) => changeLayer({ matte_clip })} />
      <DropClip words="Drop a matte that moves with it" label="Choose a matte's file" taken={(matte_clip) => changeLayerOf(layer.name, { matte_clip })} />
      <Slider label="Begins after" value={Math.min(layer.start, last)} min={0} max={last} step={0.04} shown={`${layer.start.toFixed(2)} s`} onInput={(start) => changeLayer({ start: Number(start.toFixed(2)) }, "layer-start")} />
      <Switch label="Comes again" hint="Without it, it plays once" checked={layer.repeats} onChange={(repeats) => changeLayer({ repeats })} />
    </>
  );
}

function WindSection({ scene }: { scene: DrawnScene }): JSX.Element {
  return (
    <Section title="Wind">
      <Slider label="Wind" value={scene.wind} {...state.range("wind.speed")} step={0.5} shown={`${scene.wind.toFixed(1)} m/s`} onInput={(wind) => changeScene({ wind }, "wind")} />
      <Slider label="Blows to" value={scene.direction} {...state.range("wind.direction")} step={5} shown={`${scene.direction}°`} onInput={(direction) => changeScene({ direction }, "wind-direction")} />
      <Slider label="Gusts" value={scene.gustiness} {...state.range("wind.gustiness")} step={0.05} shown={scene.gustiness === 0 ? "none" : scene.gustiness.toFixed(2)} onInput={(gustiness) => changeScene({ gustiness }, "gusts")} />
      <Switch label="The weather changes" checked={scene.changes} onChange={(changes) => changeScene({ changes })} />
      {scene.changes && <Slider label={scene.loop ? "By the middle" : "By the end"} value={scene.becomes} {...state.range("wind.speed")} step={0.5} shown={`${scene.becomes.toFixed(1)} m/s`} onInput={(becomes) => changeScene({ becomes }, "wind-becomes")} />}
      <p class="hint">0° to the right, 90° away, 180° to the left, as seen from above.</p>
      <Slider label="Length" value={scene.frames / 25} min={0.4} max={20} step={0.2} shown={`${(scene.frames / 25).toFixed(1)} s`} onInput={(seconds) => changeScene({ frames: Math.max(1, Math.round(seconds * 25)) }, "scene-frames")} />
      <Switch label="Seamless loop" checked={scene.loop} onChange={(loop) => changeScene({ loop })} />
    </Section>
  );
}
