// What of the work area is shown, and with which tool the pointer draws.
import { signal } from "@preact/signals";
import type { ClipLine } from "./types";

export type FluidTool = "fluid" | "still" | "paint" | "erase" | "area" | "hold";
export const fluidTool = signal<FluidTool>("fluid");
export const brush = signal(24); // px of the picture
export const matteLook = signal<"tint" | "edge" | "cutout" | "off">("tint");
export const streaks = signal(true);
export type FlowTool = "line" | "direction" | "tempo";
export const flowTool = signal<FlowTool>("line");
export const tempo = signal(2); // times as fast, that the brush paints
export type DesignTool = "source" | "obstacle" | "wind";
export const designTool = signal<DesignTool>("source");
export type LayerTool = "paint" | "erase" | "area" | "line";
export const layerTool = signal<LayerTool>("paint");
export const layer = signal(0); // of the picture's layers, that is drawn on
export const foundLayers = signal(0); // counts the layers' mattes that were found from scribbles
export type LineTool = "edited" | "lines";
export const lineTool = signal<LineTool>("edited");
export const line = signal<number | null>(null); // of those that the tool changes
export const position = signal(0); // of the chosen line's, that is changed; 0: the first
export const foundLines = signal<ClipLine[]>([]); // in the clip that is chosen
export type Pair = readonly [string, string];
export const pair = signal<Pair | null>(null); // of stills that are pinned to each other
export const pairSide = signal<0 | 1>(0); // which of the two is on the canvas
export const pin = signal<number | null>(null); // of the document's, that is changed
/** What lies on the canvas in place of the picture. */
export const ground = signal<HTMLImageElement | null>(null);
export const picture = signal<HTMLImageElement | null>(null); // that is open, reduced
export const drawn = signal(true); // whether what was drawn lies over the film
export const film = signal<string | null>(null); // address of the film that plays over the picture
export const corners = signal(0); // of the area that is being clicked together
export const selected = signal<number | null>(null); // a stroke
export const fastByLength = signal(false);
export const pieceMap = signal<"none" | "clip" | "score" | "sure">("none");
export const piece = signal<number | null>(null);
export const compare = signal<number | null>(null); // 0..1 of the picture's width that shows the original; null: none
/** Outlines of the frames before and after the one that is shown. */
export const onion = signal(false);
export const worst = signal<string | null>(null); // address of the map of where it looks wrong
export const marksWorst = signal(true);
export const zoom = signal(1);
export const panning = signal(false); // the space bar is held
export const panned = signal(false); // the pointer has moved the picture since then
export const arriving = signal(false); // the picture is not there yet

/** Colours of clips in maps: told apart by eye, and by those who see fewer hues by their lightness. */
export const clipColours = [
  "#4fb3bf", "#e9b44c", "#d1495b", "#7a77b9", "#8fb339", "#f28f3b", "#5b8e7d", "#c8553d", "#a1c6ea", "#bc96e6",
  "#e5d4ce", "#587b7f",
];
export const clipColour = (index: number): string => clipColours[index % clipColours.length] ?? "#888";
