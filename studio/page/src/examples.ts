// What can be tried without a file at hand: a picture of ours, and clips of a store that is open.
import * as api from "./api";
import { go } from "./navigation";
import * as state from "./state";
import type { Point, Store, Stroke } from "./types";

export interface ExampleClip {
  store: string;
  index: number; // of the clip in it
  name: string;
}

/** A clip to show what can be done with one: of the sea or a river, if there is such. */
export function exampleClip(stores: Store[]): (ExampleClip & { aspect: number }) | null {
  const [store] = [...stores].sort((a, b) => b.clips.length - a.clips.length);
  if (!store) return null;
  const likely = store.clips.findIndex(({ name }) => /swell|sea|river/.test(name));
  const index = Math.max(0, likely);
  const clip = store.clips[index];
  return clip ? { store: store.id, index, name: clip.name, aspect: clip.width / clip.height } : null;
}

export async function openStored({ store, index }: ExampleClip, as: "clip" | "stills"): Promise<void> {
  const id = await api.openStoredClip(store, index, as);
  state.beginWith(as === "clip" ? "flowlines" : "stills");
  go(id);
}

/** A project of its own, in which a clip goes on without an end. */
export async function openEndless(file: File): Promise<void> {
  const id = await api.openClip(file);
  state.beginWith("flowlines");
  go(id);
}

const kPoints = 8; // of a line

/** Paths of an SVG as lines of the flow. */
function strokesOf(svg: string): Stroke[] {
  const paths = [...new DOMParser().parseFromString(svg, "image/svg+xml").querySelectorAll("path")];
  return paths.map((path) => {
    const length = path.getTotalLength();
    const points = Array.from({ length: kPoints }, (_, i): Point => {
      const { x, y } = path.getPointAtLength((i * length) / (kPoints - 1));
      return [Math.round(x), Math.round(y)];
    });
    return { points, speed: Number(path.dataset["speed"]) || null };
  });
}

const asset = async (name: string): Promise<Blob> => (await fetch(name)).blob();

/** A bay in the evening with its matte and its lines; opened again, as it was left. */
export async function openExample(): Promise<void> {
  const [picture, matte, flow] = await Promise.all(["example.jpg", "example_matte.png", "example_flow.svg"].map(asset));
  if (!picture || !matte || !flow) return;
  const id = await api.openPicture(new File([picture], "bay in the evening.jpg"));
  const { document, version } = await api.project(id);
  if (document.matte_base === "scribbles" && document.scribbles.length + document.strokes.length === 0) {
    await api.giveMatte(id, new File([matte], "matte.png"));
    await api.save(id, { ...document, matte_base: "file", strokes: strokesOf(await flow.text()) }, version, "example");
  }
  go(id);
}
