// The fluid's outline before and after the frame that is shown, of an animation whose outline moves.
import { effect, signal } from "@preact/signals";
import * as api from "./api";
import * as state from "./state";
import * as view from "./view";

/** Frames apart. */
const kSteps = [-12, -8, -4, 4, 8, 12, 0] as const;

const outlines = signal<{ reel: number; frames: number[][][] } | null>(null);

/** Asks for the outlines of the reel that plays, when it is whole. Returns how to end it. */
export function followOutlines(): () => void {
  return effect(() => {
    const reel = state.player.reel.value;
    const coming = state.player.coming.value;
    const id = state.project.value?.id;
    if (!view.onion.value || !reel || coming === reel || !id || outlines.peek()?.reel === reel.news.number) return;
    const { number } = reel.news;
    api.outlines(id, number).then(
      (frames) => {
        if (state.player.reel.value?.news.number === number) outlines.value = { reel: number, frames };
      },
      () => undefined, // a newer reel took its place
    );
  });
}

/** The closed lines to be drawn, the shown frame's last. by   frames from it. */
export function outlinesNow(): { by: number; lines: number[][] }[] {
  const reel = state.player.reel.value;
  const known = outlines.value;
  const frame = state.player.frame.value;
  if (!view.onion.value || !reel || known?.reel !== reel.news.number) return [];
  const { length } = known.frames;
  return kSteps.flatMap((by) => {
    const at = state.doc.value?.loop && length > 0 ? (frame + by + length) % length : frame + by;
    const lines = known.frames[at];
    return lines ? [{ by, lines }] : [];
  });
}

/** Before it blue, after it orange, the further the fainter. */
export function outlineLook(by: number): { stroke: string; opacity: number } {
  if (by === 0) return { stroke: "#ffffff", opacity: 0.95 };
  return { stroke: by < 0 ? "#6ea8ff" : "#f28f3b", opacity: 1.05 - Math.abs(by) / 16 };
}
