// The lines of a clip as they are changed: copies of those that are there go by their names.
import { simplified } from "./pen";
import * as state from "./state";
import type { ClipLine, Flowlines, Point } from "./types";
import * as view from "./view";

const kTidy = 1.5; // px that a copy may leave its line by, so that it has few handles

/** Lines of an SVG that freshet wrote: paths of "Mx,y Lx,y ..". */
export function linesOf(svg: string): ClipLine[] {
  const page = new DOMParser().parseFromString(svg, "image/svg+xml");
  return [...page.querySelectorAll("path[id]")].flatMap((path): ClipLine[] => {
    const numbers = (path.getAttribute("d") ?? "").match(/-?\d+(\.\d+)?/g)?.map(Number) ?? [];
    const points = numbers.flatMap((x, i): Point[] => (i % 2 === 0 && i + 1 < numbers.length ? [[x, numbers[i + 1] as number]] : []));
    return points.length > 1 ? [{ id: path.id, points: simplified(points, 0.3), speeds: [], later: [] }] : [];
  });
}

/** The input line whose texture an edited one shows. */
export function inputOf(id: string, lines: ClipLine[]): string {
  if (lines.some((line) => line.id === id)) return id;
  const dash = id.lastIndexOf("-");
  return dash > 0 ? id.slice(0, dash) : id;
}

function freshId(input: string, lines: ClipLine[]): string {
  const ids = new Set(lines.map(({ id }) => id));
  if (!ids.has(input)) return input;
  let number = 2;
  while (ids.has(`${input}-${number}`)) ++number;
  return `${input}-${number}`;
}

const flowlines = (): Flowlines | undefined => state.doc.value?.flowlines;

/** Where it flows: as it was drawn, or else found. */
export function inputLines(): ClipLine[] {
  const drawn = flowlines()?.lines ?? [];
  return drawn.length > 0 ? drawn : view.foundLines.value;
}

/** Where it shall flow; without a change, where it flows. */
export function editedLines(): ClipLine[] {
  const changed = flowlines()?.edited ?? [];
  return changed.length > 0 ? changed : inputLines().map((line) => ({ ...line, points: simplified(line.points, kTidy) }));
}

export const shownLines = (): ClipLine[] => (view.lineTool.value === "edited" ? editedLines() : inputLines());

/** Takes changed lines of the tool that is chosen. key   as state.edit. */
export function takeLines(changed: ClipLine[], key = ""): void {
  const now = flowlines();
  if (!now) return;
  if (view.lineTool.value === "edited") state.edit({ flowlines: { ...now, lines: inputLines(), edited: changed } }, key);
  else {
    // Edited lines without an input line would show nothing.
    const edited = now.edited.filter(({ id }) => changed.some((line) => line.id === inputOf(id, changed)));
    state.edit({ flowlines: { ...now, lines: changed, edited: changed.length > 0 ? edited : [] } }, key);
  }
}

export function changeLine(index: number, part: Partial<ClipLine>, key = ""): void {
  takeLines(shownLines().map((line, i) => (i === index ? { ...line, ...part } : line)), key);
}

/** Where a line lies at one of its positions; 0 is the first. */
export const pointsAt = (line: ClipLine, position: number): Point[] => line.later[position - 1]?.points ?? line.points;

/** The chosen position of a line; one that was taken back is none. */
export const positionOf = (line: ClipLine): number => Math.min(view.position.value, line.later.length);

/** Moves the chosen position of a line. */
export function moveLine(index: number, points: Point[]): void {
  const line = shownLines()[index];
  if (!line) return;
  const position = positionOf(line);
  if (position === 0) return changeLine(index, { points });
  changeLine(index, { later: line.later.map((each, i) => (i === position - 1 ? { ...each, points } : each)) });
}

const kBetween = 1; // s between a new position and the last
export const kMostPositions = 60; // of a line, beside the first

/** One more position, after the last, where the line lies then. */
export function addPosition(index: number): void {
  const line = shownLines()[index];
  if (!line || line.later.length >= kMostPositions) return;
  const last = line.later[line.later.length - 1];
  changeLine(index, { later: [...line.later, { time: (last?.time ?? 0) + kBetween, points: pointsAt(line, line.later.length) }] });
  view.position.value = line.later.length + 1;
}

/** The chosen position happens at another time, between those beside it. */
export function timePosition(index: number, seconds: number): void {
  const line = shownLines()[index];
  const at = line ? positionOf(line) - 1 : -1;
  if (!line?.later[at]) return;
  const apart = 0.04;
  const from = (line.later[at - 1]?.time ?? 0) + apart;
  const to = (line.later[at + 1]?.time ?? 1000 + apart) - apart;
  const time = Number(Math.max(from, Math.min(to, seconds)).toFixed(2));
  changeLine(index, { later: line.later.map((each, i) => (i === at ? { ...each, time } : each)) }, "line-time");
}

export function removePosition(index: number): void {
  const line = shownLines()[index];
  const at = line ? positionOf(line) - 1 : -1;
  if (!line?.later[at]) return;
  view.position.value = at;
  changeLine(index, { later: line.later.filter((_, i) => i !== at) });
}

/** The edited line shows another input line's texture. */
export function pairLine(index: number, input: string): void {
  const others = editedLines().filter((_, i) => i !== index);
  changeLine(index, { id: freshId(input, others) });
}

/** A new line; an edited one shows what the chosen one does, or the input line that lies nearest. */
export function addLine(points: Point[]): void {
  const lines = shownLines();
  if (view.lineTool.value === "lines") {
    let number = lines.length + 1;
    while (lines.some(({ id }) => id === `m${number}`)) ++number;
    takeLines([...lines, { id: `m${number}`, points, speeds: [], later: [] }]);
  } else {
    const chosen = view.line.value === null ? undefined : lines[view.line.value];
    const input = chosen ? inputOf(chosen.id, inputLines()) : nearest(points);
    if (!input) return;
    takeLines([...lines, { id: freshId(input, lines), points, speeds: [], later: [] }]);
  }
  view.line.value = lines.length;
  view.position.value = 0;
}

function nearest(points: Point[]): string | undefined {
  const ends = (line: Point[]): Point[] => [line[0] as Point, line[line.length - 1] as Point];
  const [from, to] = ends(points) as [Point, Point];
  let best: string | undefined;
  let least = Infinity;
  for (const line of inputLines()) {
    const [a, b] = ends(line.points) as [Point, Point];
    const far = Math.hypot(a[0] - from[0], a[1] - from[1]) + Math.hypot(b[0] - to[0], b[1] - to[1]);
    if (far < least) [least, best] = [far, line.id];
  }
  return best;
}

/** Takes away the line that is chosen; the last one stays, for nothing would flow. */
export function removeLine(): void {
  const chosen = view.line.value;
  const lines = shownLines();
  if (chosen === null || lines.length < 2) return;
  view.line.value = null;
  takeLines(lines.filter((_, i) => i !== chosen));
}
