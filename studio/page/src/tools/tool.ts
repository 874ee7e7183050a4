// What the pointer does on the canvas in one mode, and what of the document is shown there: one object a mode.
import type Konva from "konva/lib/Core";
import { Circle } from "konva/lib/shapes/Circle";
import { Line } from "konva/lib/shapes/Line";
import { flat, rounded, type Run } from "../pen";
import type { Drawn, Point } from "../types";

export const accent = (): string => getComputedStyle(document.documentElement).getPropertyValue("--accent").trim() || "#4fc3c7";
export const kTakes = "#e5484d"; // the colour of what takes away
export const kShade = "#00171a"; // below light lines

/** A line or an area that has been drawn. */
export interface Gesture {
  runs: Run[];
  points: Point[]; // of all runs
  area: boolean;
  isClick: boolean;
  erasing: boolean; // with the right button, or Alt
}

/** Where a tool shows things: nodes are px of the picture, what is to be as thin at any zoom is divided by the scale. */
export interface Sheet {
  scale: number;
  width: number;
  height: number;
  add(node: Konva.Shape): void;
}

/** How the pointer draws: with the brush's width, as an arrow, as an area that is filled, or not at all. */
export type Pen = "brush" | "arrow" | "area" | "none";

export interface Tool {
  readonly pans: boolean; // the pointer moves the picture
  readonly showsMatte: boolean;
  readonly showsStreaks: boolean;
  readonly showsStill: boolean; // the picture itself while nothing plays
  pen(): Pen;
  colour(erasing: boolean): string;
  /** Whether a line begins here. */
  press(point: Point): boolean;
  finish(gesture: Gesture): void;
  show(sheet: Sheet): void;
}

export const kPlainTool: Tool = {
  pans: false,
  showsMatte: false,
  showsStreaks: false,
  showsStill: false,
  pen: () => "none",
  colour: accent,
  press: () => true,
  finish: () => undefined,
  show: () => undefined,
};

/** The pointer moves the picture. */
export const kPanTool: Tool = { ...kPlainTool, pans: true };

const round = { lineCap: "round", lineJoin: "round", listening: false } as const;

/** A line as the brush left it; one point is a dot. */
export function brushed(points: Point[], width: number, colour: string, opacity: number): Line {
  return new Line({ ...round, points: [...flat(points), ...flat(points.slice(-1))], stroke: colour, strokeWidth: width, opacity });
}

export function showScribbles(lines: Drawn[], sheet: Sheet): void {
  for (const line of lines) sheet.add(brushed(line.points, line.width, line.adds ? "#e8fffb" : kTakes, line.adds ? 0.55 : 0.6));
}

/** Where a line's points can be taken hold of. */
export function showHandles(points: Point[], sheet: Sheet, moved: (points: Point[]) => void): void {
  const { scale } = sheet;
  points.forEach((point, k) => {
    if (k !== 0 && k !== points.length - 1 && points.length > 8 && k % 3 !== 0) return;
    // The last one stands beyond the arrow's tip, which it would cover.
    const before = points[k - 1] ?? point;
    const length = Math.hypot(point[0] - before[0], point[1] - before[1]) || 1;
    const beyond = k === points.length - 1 ? 13 / scale / length : 0;
    const [dx, dy] = [(point[0] - before[0]) * beyond, (point[1] - before[1]) * beyond];
    const handle = new Circle({ x: point[0] + dx, y: point[1] + dy, radius: 5 / scale, fill: "#fff", stroke: accent(), strokeWidth: 2 / scale, draggable: true, hitStrokeWidth: 14 / scale });
    handle.on("pointerdown", (event) => (event.cancelBubble = true));
    handle.on("dragend", () => moved(points.map((each, i): Point => (i === k ? [rounded(handle.x() - dx), rounded(handle.y() - dy)] : each))));
    sheet.add(handle);
  });
}
