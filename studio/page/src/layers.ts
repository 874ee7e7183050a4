// The layers of a picture as they are changed.
import { address } from "./api";
import { rounded } from "./pen";
import * as state from "./state";
import type { Drawn, DrawnLayer, DrawnScene, LayerMotion, Point, Stroke } from "./types";
import * as view from "./view";

interface MotionRow {
  label: string;
  usual: string; // name of a layer
  line?: string; // what a line is, of a motion that has one
}

/** The motions of a layer, a row for each. */
export const kMotions: Record<LayerMotion, MotionRow> = {
  tree: { label: "Tree or plant", usual: "tree", line: "Draw from a root to a tip: what sways. Several lines each move what is near." },
  water: { label: "Water", usual: "water", line: "Draw a line on the horizon, where the water's plane ends." },
  boat: { label: "Boat", usual: "boat", line: "Draw a line along the hull, at the water." },
  clouds: { label: "Clouds", usual: "clouds" },
  patches: { label: "Fluid of the store", usual: "fluid", line: "Draw lines along the flow." },
  footage: { label: "Film", usual: "film", line: "Draw from its upper left corner to its lower right one: it is as wide as that." },
  still: { label: "Stands still", usual: "still" },
};

const scene = (): DrawnScene | undefined => state.doc.value?.scene;
export const chosenLayer = (): DrawnLayer | undefined => scene()?.layers[view.layer.value];

export function changeScene(part: Partial<DrawnScene>, key = ""): void {
  const now = scene();
  if (now) state.edit({ scene: { ...now, ...part } }, key);
}

export function changeLayer(part: Partial<DrawnLayer>, key = ""): void {
  const chosen = chosenLayer();
  if (chosen) changeLayerOf(chosen.name, part, key);
}

/** Of this name, whichever is chosen by now. */
export function changeLayerOf(name: string, part: Partial<DrawnLayer>, key = ""): void {
  const now = scene();
  if (now) changeScene({ layers: now.layers.map((layer) => (layer.name === name ? { ...layer, ...part } : layer)) }, key);
}

/** Is drawn on from now on. */
export function chooseLayer(index: number): void {
  view.layer.value = index;
  if (chosenLayer()?.motion === "footage") view.layerTool.value = "line";
}

/** A new layer lies before all others, and is drawn on. as   what of it is not as usual. */
export function addLayer(motion: LayerMotion, as: Partial<DrawnLayer> = {}): void {
  const layers = scene()?.layers ?? [];
  const usual = as.name ?? kMotions[motion].usual;
  let name = usual;
  for (let number = 2; layers.some((layer) => layer.name === name); ++number) name = `${usual} ${number}`;
  const made: DrawnLayer = { motion, matte: "painted", paint: [], lines: [], plant: "tree", sway_clip: "", sway_dropped: true, sway_lines: [], shimmer: 0, waves: 0, mirrors: false, roll: 1, in_3d: false, drift: 0, shade: 0, class: "", film: "design", clip: "", matte_clip: "", start: 0, repeats: true, ground: "none", blend: "over", glow: 0, glow_reach: 0, ...as, name };
  changeScene({ layers: [made, ...layers] });
  view.layer.value = 0;
  view.layerTool.value = motion === "footage" ? "line" : "paint";
}

/** What another mode has made, over the picture. */
export function layOver(as: Partial<DrawnLayer>): void {
  addLayer("footage", as);
  state.mode.value = "scene";
}

export function removeLayer(): void {
  const layers = scene()?.layers ?? [];
  changeScene({ layers: layers.filter((_, i) => i !== view.layer.value) });
  view.layer.value = Math.max(0, Math.min(view.layer.value, layers.length - 2));
}

/** The chosen layer goes before the one before it, or behind the one behind it. */
export function moveLayer(by: -1 | 1): void {
  const layers = [...(scene()?.layers ?? [])];
  const from = view.layer.value;
  const [one, other] = [layers[from], layers[from + by]];
  if (!one || !other) return;
  [layers[from], layers[from + by]] = [other, one];
  changeScene({ layers });
  view.layer.value = from + by;
}

export function paintLayer(drawn: Drawn[]): void {
  const layer = chosenLayer();
  if (layer) changeLayer({ paint: [...layer.paint, ...drawn], ...(layer.matte === "rest" ? { matte: "painted" as const } : {}) });
}

export function addLayerLine(points: Point[]): void {
  const layer = chosenLayer();
  if (!layer || !kMotions[layer.motion].line) return;
  const ends = [points[0], points[points.length - 1]].map((point): Point => [rounded(point?.[0] ?? 0), rounded(point?.[1] ?? 0)]);
  if (layer.motion === "footage") return placeFilm(ends);
  const line = { points: layer.motion === "patches" ? points : ends, speed: null };
  const others = layer.motion === "tree" || layer.motion === "patches" ? layer.lines : [];
  changeLayer({ lines: [...others, line] });
}

/** Where a film lies, as ways/layer_scene.cc has it: as wide as its line, or as the picture. */
function placeOf(lines: Stroke[]): { left: number; top: number; width: number } {
  const points = lines[0]?.points ?? [[0, 0], [state.project.value?.width ?? 1, 0]];
  const [from, to] = [points[0], points[points.length - 1]] as [Point, Point];
  const [left, top] = [0, 1].map((axis) => Math.round(Math.min(from[axis] as number, to[axis] as number))) as Point;
  return { left, top, width: Math.max(1, Math.round(Math.abs(to[0] - from[0]))) };
}

/** Lays the chosen film from one corner to the other, or over all of the picture. Paint over it goes along. */
export function placeFilm(corners: Point[]): void {
  const [layer, home] = [chosenLayer(), state.home.value];
  if (!layer || !home) return;
  const lines = corners.length > 1 ? [{ points: corners, speed: null }] : [];
  const [from, to] = [placeOf(layer.lines), placeOf(lines)];
  const scale = to.width / from.width;
  const held = (value: number): number => Math.max(-home.furthest, Math.min(home.furthest, value));
  const carried = ({ points, width, ...rest }: Drawn): Drawn => ({ ...rest, width: Math.min(home.widest, width * scale), points: points.map(([x, y]): Point => [held(to.left + (x - from.left) * scale), held(to.top + (y - from.top) * scale)]) });
  changeLayer({ lines, paint: layer.paint.map(carried) });
}

const kFound = new WeakMap<Drawn[], HTMLImageElement>();
let asked = 0;

/** Asks for the mattes that layers' scribbles mean; the server has them by now. */
export function findLayers(project: string): void {
  scene()?.layers.forEach(({ matte, paint }, index) => {
    if (matte !== "scribbled" || !paint.some(({ adds }) => adds) || kFound.has(paint)) return;
    const image = new Image();
    image.onload = () => {
      kFound.set(paint, image);
      view.foundLayers.value += 1;
    };
    image.src = address.layerMatte(project, index, ++asked); // what cannot be found is said when it is made
  });
}

const kTinted = new WeakMap<HTMLImageElement, { colour: string; canvas: HTMLCanvasElement }>();

/** Where a layer is that was found from scribbles, in one colour; null: it is not known yet. */
export function foundShape(paint: Drawn[], colour: string): HTMLCanvasElement | null {
  const image = kFound.get(paint);
  if (!image) return null;
  const known = kTinted.get(image);
  if (known?.colour === colour) return known.canvas;
  const canvas = document.createElement("canvas");
  canvas.width = image.naturalWidth;
  canvas.height = image.naturalHeight;
  const context = canvas.getContext("2d");
  if (context) {
    context.drawImage(image, 0, 0);
    context.globalCompositeOperation = "source-in";
    context.fillStyle = colour;
    context.fillRect(0, 0, canvas.width, canvas.height);
  }
  kTinted.set(image, { colour, canvas });
  return canvas;
}

const kLongest = 1024; // px of a matte as it is shown
const kShown = new WeakMap<Drawn[], { colour: string; width: number; height: number; canvas: HTMLCanvasElement }>();

/** Where a layer was painted, in one colour. */
export function layerShape(paint: Drawn[], colour: string, width: number, height: number): HTMLCanvasElement {
  const known = kShown.get(paint);
  if (known?.colour === colour && known.width === width && known.height === height) return known.canvas;
  const canvas = document.createElement("canvas");
  const scale = Math.min(1, kLongest / Math.max(width, height));
  canvas.width = Math.max(1, Math.round(width * scale));
  canvas.height = Math.max(1, Math.round(height * scale));
  const context = canvas.getContext("2d");
  if (context) {
    context.scale(scale, scale);
    context.strokeStyle = context.fillStyle = colour;
    context.lineCap = context.lineJoin = "round";
    for (const line of paint) {
      context.globalCompositeOperation = line.adds ? "source-over" : "destination-out";
      context.beginPath();
      line.points.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
      if (line.area) context.fill();
      else {
        const [first] = line.points;
        if (line.points.length === 1 && first) context.lineTo(first[0], first[1]);
        context.lineWidth = line.width;
        context.stroke();
      }
    }
  }
  kShown.set(paint, { colour, width, height, canvas });
  return canvas;
}
