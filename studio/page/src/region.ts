// The thing that lies at a point of the picture, by its colour: what a click takes hold of.
import { simplified } from "./pen";
import type { Point } from "./types";

const kSide = 256; // px that it is looked for in
const kAlike = 30; // levels from the mean of what was taken so far
const kAcross = 18; // levels from one pixel to the next
const kSmallest = 12; // px of these
const kLargest = 0.4; // of the picture

/** Its outline, px of the picture; null: there is nothing with an edge of its own. */
export function regionAt(image: HTMLImageElement, size: { width: number; height: number }, [px, py]: Point): Point[] | null {
  const scale = Math.min(1, kSide / Math.max(image.naturalWidth, image.naturalHeight));
  const width = Math.max(1, Math.round(image.naturalWidth * scale));
  const height = Math.max(1, Math.round(image.naturalHeight * scale));
  const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  if (!context) return null;
  context.drawImage(image, 0, 0, width, height);
  const { data } = context.getImageData(0, 0, width, height);
  const seed = Math.min(height - 1, Math.floor((py * height) / size.height)) * width + Math.min(width - 1, Math.floor((px * width) / size.width));
  if (!(seed >= 0)) return null;
  const taken = grown(data, width, height, seed);
  if (!taken) return null;
  const outline = outlineOf(taken, width, height);
  const back = (v: number, of: number, to: number): number => Math.round((v * to * 10) / of) / 10;
  return simplified(outline, 0.7).map(([x, y]): Point => [back(x + 0.5, width, size.width), back(y + 0.5, height, size.height)]);
}

/** Whether a point lies inside of an outline. */
export function holds(outline: Point[], [px, py]: Point): boolean {
  let inside = false;
  outline.forEach(([x, y], i) => {
    const [bx, by] = outline[(i + outline.length - 1) % outline.length] ?? [x, y];
    if (y > py !== by > py && px < x + ((py - y) * (bx - x)) / (by - y)) inside = !inside;
  });
  return inside;
}

/** Pixels that hang together with the first one; null: too few or too many. */
function grown(data: Uint8ClampedArray, width: number, height: number, seed: number): Uint8Array | null {
  const taken = new Uint8Array(width * height);
  const mean = [0, 1, 2].map((c) => data[4 * seed + c] ?? 0);
  const queue = [seed];
  taken[seed] = 1;
  let count = 0;
  const far = (at: number, from: (c: number) => number): number => Math.max(...[0, 1, 2].map((c) => Math.abs((data[4 * at + c] ?? 0) - from(c))));
  for (let at = queue.pop(); at !== undefined; at = queue.pop()) {
    count += 1;
    if (count > kLargest * width * height) return null;
    for (let c = 0; c < 3; ++c) mean[c] = (mean[c] ?? 0) + ((data[4 * at + c] ?? 0) - (mean[c] ?? 0)) / Math.min(count, 400);
    const x = at % width;
    const next = [x > 0 ? at - 1 : -1, x < width - 1 ? at + 1 : -1, at - width, at + width];
    for (const other of next) {
      if (other < 0 || other >= taken.length || taken[other]) continue;
      const here = at;
      if (far(other, (c) => mean[c] ?? 0) > kAlike || far(other, (c) => data[4 * here + c] ?? 0) > kAcross) continue;
      taken[other] = 1;
      queue.push(other);
    }
  }
  return count < kSmallest ? null : taken;
}

/** Once around the outside, clockwise, from its uppermost pixel (Moore's neighbours). */
function outlineOf(taken: Uint8Array, width: number, height: number): Point[] {
  const is = (x: number, y: number): boolean => x >= 0 && y >= 0 && x < width && y < height && taken[y * width + x] === 1;
  const first = taken.indexOf(1);
  const [fx, fy] = [first % width, Math.floor(first / width)];
  const around: readonly Point[] = [[-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1]];
  const outline: Point[] = [];
  let [x, y, from] = [fx, fy, 0];
  for (let steps = 0; steps < 4 * taken.length; ++steps) {
    outline.push([x, y]);
    const turn = Array.from({ length: 8 }, (_, i) => (from + i) % 8).find((way) => is(x + (around[way]?.[0] ?? 0), y + (around[way]?.[1] ?? 0)));
    if (turn === undefined) break;
    x += around[turn]?.[0] ?? 0;
    y += around[turn]?.[1] ?? 0;
    from = (turn + 6) % 8; // back to where it came from, and one further
    if (x === fx && y === fy) break;
  }
  return outline;
}
