// Whether a point lies in an area.
import type { Point } from "./types";

/** Whether a point lies inside of an outline. */
export function holds(outline: Point[], [px, py]: Point): boolean {
  let inside = false;
  outline.forEach(([x, y], i) => {
    const [bx, by] = outline[(i + outline.length - 1) % outline.length] ?? [x, y];
    if (y > py !== by > py && px < x + ((py - y) * (bx - x)) / (by - y)) inside = !inside;
  });
  return inside;
}
