// The scene's layers while they are drawn: a small film that follows each change, and goes on where the last one was.
import { effect, signal } from "@preact/signals";
import { showLayers } from "./api";
import { kFurthestLead, Player } from "./player";
import type { ReelNews } from "./types";

export interface LayersNews {
  reel: ReelNews | null;
  problem: string;
}

export const liveLayers = new Player();
const kSpare = 1; // frames by which newer layers may come later than the last ones did
let lead = 6; // frames that play until newer layers come
let askedAt = 0; // ms
export const layersProblem = signal("");
let asked = ""; // the project, until what was asked for it plays: a newer wish waits, or none would ever be seen
let newest = 0; // reel that was heard of
let wished = false;

/** Makes them anew. */
export async function renewLayers(project: string): Promise<void> {
  wished = asked !== "";
  if (asked) return;
  asked = project;
  askedAt = performance.now();
  try {
    await showLayers(project, liveLayers.frame.value + (liveLayers.reel.value && liveLayers.playing.value ? lead : 0));
  } catch (fault) {
    asked = "";
    layersProblem.value = (fault as Error).message;
  }
}

/** The same where news of them may have been missed. */
export function renewLostLayers(project: string): void {
  asked = "";
  void renewLayers(project);
}

export function heardOfLayers(project: string, news: LayersNews): void {
  layersProblem.value = news.problem;
  if (news.reel) {
    liveLayers.follow(project, news.reel);
    newest = Math.max(newest, news.reel.number);
  } else {
    answered();
  }
}

/** What was wished for meanwhile is asked for. */
function answered(): void {
  const project = asked;
  asked = "";
  if (project && wished) void renewLayers(project);
}

// While a slider is pulled, each reel plays before a newer one takes its place, which is asked for as soon as enough
// frames are here to play until it comes.
let played = 0; // reel
let settled = 0; // reel that answered what was asked
effect(() => {
  const reel = liveLayers.reel.value;
  const loaded = liveLayers.loaded.value;
  const number = reel?.news.number ?? 0;
  if (!reel || number < newest) return;
  if (number > played) {
    const took = Math.ceil(((reel.enough - askedAt) * reel.news.fps) / 1000) + kSpare;
    // The first one cut its layers, which takes long once.
    if (asked && played > 0) lead = Math.min(kFurthestLead, Math.max(took, Math.ceil((lead + took) / 2)));
    played = number;
  }
  if (number === settled || (liveLayers.playing.value && loaded < Math.min(reel.news.total, lead + 1))) return;
  settled = number;
  queueMicrotask(answered); // which reads what plays
});

export function clearLayers(): void {
  liveLayers.clear();
  layersProblem.value = "";
  asked = "";
  wished = false;
}
