// What the pointer draws: a line whose width follows the pen.
import type { Point } from "./types";

/** A piece of a line that has one width, px of the picture. */
export interface Run {
  points: Point[];
  width: number;
}

const kStep = 1.15; // widths between these are not told apart

/** Half to one and a half times the brush, as the pen is pressed; a mouse and a finger have no pressure. */
export function widthOf(event: PointerEvent, brush: number): number {
  const pressed = event.pointerType === "pen" && event.pressure > 0 ? 0.4 + 1.2 * event.pressure : 1;
  return brush * kStep ** Math.round(Math.log(pressed) / Math.log(kStep));
}

/** Leaves out points that lie on the way (Ramer, Douglas and Peucker). */
export function simplified(points: Point[], tolerance: number): Point[] {
  const first = points[0];
  const last = points[points.length - 1];
  if (points.length < 3 || !first || !last) return points;
  let far = 0;
  let index = 0;
  const dx = last[0] - first[0];
  const dy = last[1] - first[1];
  const length = Math.hypot(dx, dy) || 1;
  for (let i = 1; i < points.length - 1; ++i) {
    const [x, y] = points[i] as Point;
    const distance =
      dx === 0 && dy === 0
        ? Math.hypot(x - first[0], y - first[1])
        : Math.abs(dy * (x - first[0]) - dx * (y - first[1])) / length;
    if (distance > far) [far, index] = [distance, i];
  }
  if (far <= tolerance) return [first, last];
  return [...simplified(points.slice(0, index + 1), tolerance).slice(0, -1), ...simplified(points.slice(index), tolerance)];
}

export const flat = (points: Point[]): number[] => points.flat();
/** Of x0, y0, x1, y1, .. */
export const paired = (values: number[]): Point[] => values.flatMap((x, i): Point[] => (i % 2 === 0 ? [[x, values[i + 1] ?? 0]] : []));
export const rounded = (value: number): number => Math.round(value * 10) / 10;
export const lengthOf = (points: Point[]): number =>
  points.reduce((sum, [x, y], i) => {
    const before = points[i - 1];
    return before ? sum + Math.hypot(x - before[0], y - before[1]) : 0;
  }, 0);

/** A line while it is drawn. Where the pen is pressed otherwise, another run begins at the last one's end. */
export class PenLine {
  readonly runs: Run[];

  constructor(point: Point, width: number) {
    this.runs = [{ points: [point], width }];
  }

  get last(): Run {
    return this.runs[this.runs.length - 1] as Run;
  }

  get points(): Point[] {
    return this.runs.flatMap(({ points }, i) => (i === 0 ? points : points.slice(1)));
  }

  /** nearest   px of the picture: what is nearer to the last point is left out. Returns whether another run has begun. */
  add(point: Point, width: number, nearest: number): boolean {
    const { points, width: before } = this.last;
    const end = points[points.length - 1] as Point;
    if (Math.hypot(point[0] - end[0], point[1] - end[1]) < nearest) return false;
    if (width === before) {
      points.push(point);
      return false;
    }
    this.runs.push({ points: [end, point], width });
    return true;
  }

  /** As they are kept. */
  simple(tolerance: number): Run[] {
    const tidy = (points: Point[]): Point[] => simplified(points, tolerance).map(([x, y]): Point => [rounded(x), rounded(y)]);
    return this.runs.map(({ points, width }) => ({ points: tidy(points), width: rounded(width) }));
  }
}
