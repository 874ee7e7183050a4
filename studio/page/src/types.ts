// What the server and the page say to each other.

export type Point = [number, number];

/** A line or an area, px of the picture. */
export interface Drawn {
  points: Point[];
  width: number;
  adds: boolean;
  area: boolean;
}

export interface Stroke {
  points: Point[];
  speed: number | null; // px/s
}

/** Where clips play slower or faster: 0.5..2 times. */
export interface Tempo {
  points: Point[];
  width: number;
  factor: number;
}

export interface Pin {
  x: number;
  y: number;
  clip: string;
  variant: number;
  patch_x: number;
  patch_y: number;
}

/** What one works on: documents, ways, folders and commands of these have the same names. */
export type Mode = "fluid" | "flow" | "look" | "why" | "design" | "stills" | "flowlines" | "scene";

export type MatteBase = "scribbles" | "alpha" | "whole" | "file";
export type Edge = "guided" | "information-flow" | "none";

export interface Document {
  store: string;
  matte_base: MatteBase;
  edge: Edge;
  scribbles: Drawn[];
  paint: Drawn[];
  held: Drawn[];
  strokes: Stroke[];
  directions: Drawn[]; // what does not add takes away
  tempo: Tempo[];
  class: string;
  excluded_clips: string[];
  pins: Pin[];
  frames: number;
  fps: number;
  loop: boolean;
  speed: number; // times as fast as filmed; 0: auto
  horizon: "auto" | "none";
  moving_outline: boolean;
  layout: "" | "goes" | "stands"; // these three as a take has changed them
  detail_life: number; // s; 0: as the clips have it
  flames: "" | "clips";
  design: Design;
  stills: Stills;
  flowlines: Flowlines;
  scene: DrawnScene;
  sweep: Sweep;
}

export type SweepSetting = "speed" | "class" | "outline" | "lines";
export interface SweepAxis {
  setting: SweepSetting;
  values: string[];
}

/** Settings that are tried beside each other. */
export interface Sweep {
  axes: SweepAxis[];
  full: boolean;
}

/** One film of them; its settings are options of the command line. */
export interface SweptAnimation {
  settings: Record<string, string>;
  result: string;
  video: string;
  assignment: string;
}
export interface FoundSweep {
  animations: SweptAnimation[];
}

export type LayerMotion = "still" | "tree" | "water" | "boat" | "clouds" | "patches" | "footage";
export type LayerFilm = "design" | "flowlines" | "stills" | "clip";
export type Blend = "over" | "add" | "screen";
export type LayerMatte = "painted" | "scribbled" | "rest";

/** Of what its motion does not have, the values do not matter. */
export interface DrawnLayer {
  name: string;
  motion: LayerMotion;
  matte: LayerMatte;
  paint: Drawn[];
  lines: Stroke[];
  plant: "tree" | "flower" | "grass";
  sway_clip: string; // of a tree: in which such a plant sways; "": none
  sway_dropped: boolean; // that was dropped, or the store's
  sway_lines: Stroke[]; // from root to tip in its first frame, px of it
  shimmer: number;
  waves: number;
  mirrors: boolean;
  roll: number;
  in_3d: boolean; // of a boat
  drift: number;
  shade: number; // of clouds, on the ground
  class: string;
  film: LayerFilm; // footage of what these modes have made, or of a clip
  clip: string; // that was dropped
  matte_clip: string; // of footage, in place of paint: one that was dropped, a matte for each frame
  start: number; // of footage, s
  repeats: boolean;
  ground: Ground; // of footage: what it was filmed on, taken off
  blend: Blend;
  glow: number; // of patches, footage and water, on the layers around
  glow_reach: number; // px; 0: as usual
}

/** A picture in layers that one wind moves, nearest first. */
export interface DrawnScene {
  wind: number;
  direction: number;
  gustiness: number;
  changes: boolean; // it becomes the next by the end, or by a loop's middle and back
  becomes: number;
  frames: number;
  loop: boolean;
  layers: DrawnLayer[];
}

/** Where a line that moves lies later, s. */
export interface LinePosition {
  time: number;
  points: Point[];
}

/** A line that particles of a clip ride, px of its frames. */
export interface ClipLine {
  id: string;
  points: Point[];
  speeds: number[]; // times as fast, at even distances along it; none: 1
  later: LinePosition[]; // of an edited line that moves, by time
}

/** A clip that is to go on without an end. */
export interface Flowlines {
  clip: string;
  dropped: boolean;
  lines: ClipLine[];
  edited: ClipLine[];
  join: number;
  stretched: boolean;
  ground: Ground;
  frames: number;
  loop: boolean;
  moving_camera: boolean;
}

/** What is said of an order that was found: not walked, or in this order alone. */
export interface StillsPath {
  region: string;
  names: string[];
  refused: boolean;
}

/** Where something of one still lies in another, px of the stills. */
export interface StillsPin {
  from: string;
  to: string;
  points: [Point, Point]; // in the one, and in the other
  reach: number; // px
}

/** A moving scene from some stills of it. */
export interface Stills {
  seconds: number;
  speed: number;
  loop: boolean;
  split: number;
  full: boolean;
  paths: StillsPath[];
  pins: StillsPin[];
}

export interface FoundRegion {
  name: string;
  kind: string;
  box: [number, number, number, number]; // left, top, width and height, shares of the stills' sizes
  paths: string[][];
  sequence: string[];
}
export interface FoundStills {
  notices: string[];
  regions: FoundRegion[];
}

export type Fluid = "smoke" | "fire" | "water";
export type Ground = "none" | "black" | "white";

/** A motion that is simulated, and may be given the look of a clip. */
export interface Design {
  fluid: Fluid;
  sources: Drawn[]; // what does not add is an obstacle
  winds: Stroke[];
  look: string;
  ground: Ground;
  frames: number;
  full: boolean;
}

/** Another way to synthesise: what is typed for it, the film that it has made, if any, and what it found. */
export interface Way {
  film: string | null;
  made: string | null;
  found: unknown;
  shown: string[]; // names of files
  commands: string[];
  lacks: string; // what has to be drawn before; empty: nothing
  alone: "" | "fluid" | "layers"; // what can be exported in place of the film
}

export interface Clip {
  name: string;
  class: string;
  licence: string;
  width: number;
  height: number;
  frames: number;
  fps: number;
  patches: number;
}

export interface Store {
  id: string;
  name: string;
  path: string;
  clips: Clip[];
  patches: number;
  fault?: string;
}

/** What an export can be: a row of the engine's table of endings. */
export interface OutputFormat {
  ending: string;
  name: string;
  use: string;
  alpha: boolean;
  sequence: boolean; // a folder of pictures
  depths: string[]; // bits per channel that it can hold
}

export interface Home {
  projects: { id: string; seconds_ago: number }[];
  stores: Store[];
  folder: string;
  formats: OutputFormat[];
  films: string[]; // endings of films that are read
  ranges: Record<string, [number, number]>; // of a scene's numbers, by table and key: what sliders show
  pin_reach: number; // that a pin between stills has at first, of the longer side
  furthest: number; // px of a point, and
  widest: number; // of a brush: what a document holds
}

export interface MatteNews {
  number: number;
  share: number;
  held: boolean;
  notices: string[];
}

export interface ReelNews {
  number: number;
  stage: "small" | "full" | "layers";
  width: number;
  height: number;
  fps: number;
  total: number;
  ready: number;
  first: number; // which frame of the film the reel begins with; it goes round
}

export interface Made {
  matte: MatteNews | null;
  small: ReelNews | null;
  full: ReelNews | null;
  labels: boolean;
  problem: string;
  field: boolean;
}

export interface Project {
  id: string;
  folder: string;
  width: number;
  height: number;
  alpha: boolean;
  notices: string[];
  notice: string;
  document: Document;
  version: number;
  event: number;
  made: Made;
}

export interface Field {
  columns: number;
  rows: number;
  width: number;
  height: number;
  source: "strokes" | "patches";
  u: number[];
  v: number[];
}

/** x, y, clip, score, pinned, by how much the next best patch there is worse (null: there is none) */
export type Piece = [number, number, number, number, boolean, number | null];

export type Pace = "auto" | "slow" | "natural" | "fast";

/** What a take changes of the document: `pace` and `own_speeds` of its strokes' speeds. */
export interface TakeChange extends Partial<Pick<Document, "speed" | "layout" | "detail_life" | "flames">> {
  pace?: number;
  own_speeds?: boolean;
}

/** Other takes of the animation that is there; the first is that itself. */
export interface Takes {
  number: number;
  takes: { name: string; faults: number | null; says: string; change: TakeChange }[];
  best: number;
  marked: boolean; // there is a map of where the first is worst
}

export interface Pieces {
  side: number;
  energy: number;
  gap?: number;
  notices: string[];
  paces: Record<Pace, number>;
  kind: { class: string; share: number; sure: boolean; only: string | null }; // by its look; only: the class that is taken for it
  clips: { name: string; class: string; licence: string; pieces: number }[];
  pieces: Piece[];
}

export interface Candidate {
  place: number;
  clip: string;
  clip_index: number;
  class: string;
  licence: string;
  score: number;
  variant: number;
  scale: number;
  rotation: number;
  flip: boolean;
  x: number;
  y: number;
  corners: Point[];
}

export interface Candidates {
  piece: number;
  x: number;
  y: number;
  chosen: number;
  pinned: boolean;
  candidates: Candidate[];
}

export interface Job {
  lane: "preview" | "live" | "command";
  id: number;
  key: string;
  title: string;
  state: "waiting" | "running" | "done" | "failed" | "stopped";
  stage: string;
  done: number;
  of: number;
  fault: string;
}
