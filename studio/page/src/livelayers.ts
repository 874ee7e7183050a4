// The scene's layers while they are drawn: a small film that follows each change, and goes on where the last one was.
import { effect, signal } from "@preact/signals";
import { showLayers } from "./api";
import { Player } from "./player";
import type { ReelNews } from "./types";

export interface LayersNews {
  reel: ReelNews | null;
  problem: string;
}

export const liveLayers = new Player();
const kLead = 6; // frames that are played until newer layers come
export const layersProblem = signal("");
let asked = ""; // the project, until what was asked for it plays: a newer wish waits, or none would ever be seen
let newest = 0; // reel that was heard of
let wished = false;

/** Makes them anew. */
export async function renewLayers(project: string): Promise<void> {
  wished = asked !== "";
  if (asked) return;
  asked = project;
  try {
    await showLayers(project, liveLayers.frame.value + (liveLayers.reel.value ? kLead : 0));
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

// While a slider is pulled, each reel plays before a newer one takes its place.
let played = 0;
effect(() => {
  const number = liveLayers.reel.value?.news.number ?? 0;
  if (number <= played || number < newest) return;
  played = number;
  queueMicrotask(answered); // which reads what plays
});

export function clearLayers(): void {
  liveLayers.clear();
  layersProblem.value = "";
  asked = "";
  wished = false;
}
