// Pins of a scene from stills, as they are set: where something of one still lies in another.
import { signal } from "@preact/signals";
import { rounded } from "./pen";
import * as state from "./state";
import type { FoundRegion, FoundStills, Point, Stills, StillsPin } from "./types";
import * as view from "./view";

const stills = (): Stills | undefined => state.doc.value?.stills;

/** Of a pin that is begun, and on which of the two stills. */
export const pinBegun = signal<{ side: 0 | 1; point: Point } | null>(null);

const sameStills = ([from, to]: view.Pair, [a, b]: view.Pair): boolean => (from === a && to === b) || (from === b && to === a);

/** What was found in the stills as they are. */
export const found = signal<FoundStills | null>(null);

/** Stills that a region shows one after the other. */
function steps({ kind, sequence }: FoundRegion): view.Pair[] {
  if (kind !== "independent") return []; // it fades
  const next = (i: number): string | undefined => sequence[i + 1] ?? (stills()?.loop ? sequence[0] : undefined);
  return sequence.flatMap((name, i): view.Pair[] => {
    const after = next(i);
    return after && after !== name ? [[name, after]] : [];
  });
}

/** Of the regions that show the chosen two one after the other. */
export const pairBoxes = (): FoundRegion["box"][] =>
  (found.value?.regions ?? []).filter((region) => steps(region).some((two) => view.pair.value && sameStills(two, view.pair.value))).map(({ box }) => box);

/** Stills that follow each other where something moves, and those that are pinned; each two once. */
export function neighbours(): view.Pair[] {
  const all = [...(found.value?.regions ?? []).flatMap(steps), ...(stills()?.pins ?? []).map(({ from, to }): view.Pair => [from, to])];
  const sorted = all.map((two): view.Pair => [...two].sort() as [string, string]);
  return [...new Map(sorted.map((two) => [two.join("\n"), two])).entries()].sort(([a], [b]) => (a < b ? -1 : 1)).map(([, two]) => two);
}

/** Shows the first of two stills on the canvas; null: the film. */
export function choosePair(pair: view.Pair | null): void {
  view.pair.value = pair;
  view.pairSide.value = 0;
  view.pin.value = null;
  pinBegun.value = null;
}

/** And the two stills that it is of. */
export function choosePin(index: number): void {
  const pin = stills()?.pins[index];
  if (!pin) return;
  if (!view.pair.value || !sameStills([pin.from, pin.to], view.pair.value)) choosePair([pin.from, pin.to]);
  pinBegun.value = null;
  view.pin.value = index;
}

/** Those of the two stills that are chosen, and where each lies in the one on the canvas. */
export function pinsShown(): { index: number; pin: StillsPin; here: Point }[] {
  const pair = view.pair.value;
  if (!pair) return [];
  const shown = pair[view.pairSide.value];
  return (stills()?.pins ?? []).flatMap((pin, index) => {
    return sameStills([pin.from, pin.to], pair) ? [{ index, pin, here: pin.points[pin.from === shown ? 0 : 1] }] : [];
  });
}

/** Within the still: a pointer may leave it. */
function within([x, y]: Point): Point {
  const ground = view.ground.value;
  const least = 0.5; // the middle of the first pixel
  const clamped = (value: number, size: number): number => rounded(Math.max(least, Math.min(size - least, value)));
  return [clamped(x, ground?.naturalWidth ?? Infinity), clamped(y, ground?.naturalHeight ?? Infinity)];
}

/** A pin begins on the still that is shown; the other one takes its place. */
export function beginPin(point: Point): void {
  view.pin.value = null;
  pinBegun.value = { side: view.pairSide.value, point: within(point) };
  view.pairSide.value = view.pairSide.value === 0 ? 1 : 0;
}

export function endPin(point: Point): void {
  const [now, pair, begun, ground, home] = [stills(), view.pair.value, pinBegun.value, view.ground.value, state.home.value];
  if (!now || !pair || !begun || !ground || !home) return;
  const from = pair[begun.side];
  const to = pair[begun.side === 0 ? 1 : 0];
  const reach = Math.round(home.pin_reach * Math.max(ground.naturalWidth, ground.naturalHeight));
  state.edit({ stills: { ...now, pins: [...now.pins, { from, to, points: [begun.point, within(point)], reach }] } });
  view.pin.value = now.pins.length;
  view.pairSide.value = begun.side;
  pinBegun.value = null;
}

function changePins(change: (pins: StillsPin[]) => StillsPin[], key = ""): void {
  const now = stills();
  if (now) state.edit({ stills: { ...now, pins: change(now.pins) } }, key);
}

/** Moves the end of a pin that lies on the still that is shown. */
export function movePin(index: number, point: Point): void {
  const shown = view.pair.value?.[view.pairSide.value];
  view.pin.value = index;
  changePins((pins) => pins.map((pin, i) => (i !== index ? pin : { ...pin, points: pin.from === shown ? [within(point), pin.points[1]] : [pin.points[0], within(point)] })));
}

export const reachPin = (index: number, reach: number): void => changePins((pins) => pins.map((pin, i) => (i === index ? { ...pin, reach } : pin)), "pin-reach");

export function removePin(index: number | null): void {
  if (index === null) return;
  view.pin.value = null;
  changePins((pins) => pins.filter((_, i) => i !== index));
}
