// The scene's layers while they are drawn: a small film that follows each change, and goes on where the last one was.
import { signal } from "@preact/signals";
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
let asked = false; // and nothing has come of it yet: a newer wish waits, or none would ever be seen
let newest = 0; // reel that was heard of
let wished = false;

/** Makes them anew. */
export async function renewLayers(project: string): Promise<void> {
  wished = asked;
  if (asked) return;
  asked = true;
  try {
    await showLayers(project, liveLayers.frame.value + (liveLayers.reel.value ? kLead : 0));
  } catch (fault) {
    asked = false;
    layersProblem.value = (fault as Error).message;
  }
}

/** The same where news of them may have been missed. */
export function renewLostLayers(project: string): void {
  asked = false;
  void renewLayers(project);
}

export function heardOfLayers(project: string, news: LayersNews): void {
  layersProblem.value = news.problem;
  if (news.reel) {
    liveLayers.follow(project, news.reel);
    if (news.reel.number <= newest) return;
    newest = news.reel.number;
  }
  if (!asked) return;
  asked = false;
  if (wished) void renewLayers(project);
}

export function clearLayers(): void {
  liveLayers.clear();
  layersProblem.value = "";
  asked = wished = false;
}
