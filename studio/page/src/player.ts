// The animation's frames: fetched as they are made, and played.
import { batch, effect, signal } from "@preact/signals";
import { address } from "./api";
import type { ReelNews } from "./types";

const kAtOnce = 4; // requests
const kPatience = 1000; // ms until a frame that did not come is asked for again
const kBetweenTold = 120; // ms
const kEnough = 6; // frames with which a first preview begins
const kEnoughLayers = 2; // the same for layers
export const kFurthestLead = 25; // frames that layers may begin ahead of what plays
const kLate = 12; // frames of layers that begin behind it: with as many they take over all the same

export interface Reel {
  news: ReelNews;
  frames: (ImageBitmap | undefined)[];
  loaded: number; // frames without a gap
  enough: number; // ms, when as many were loaded as it begins with; 0: not yet
}

export class Player {
  readonly reel = signal<Reel | null>(null);
  readonly coming = signal<Reel | null>(null);
  readonly playing = signal(true);
  readonly loop = signal(true);
  readonly frame = signal(0);
  readonly loaded = signal(0); // frames without a gap, of the reel that plays
  readonly told = signal(0); // the frame, as numbers and sliders tell it: while it plays, a few times a second
  readonly rate = signal(1);
  private project = "";
  private next = 0; // of the coming reel, to be asked for
  private asking = 0;
  private time = 0;

  constructor() {
    let last = 0;
    effect(() => {
      const frame = this.frame.value;
      const now = performance.now();
      if (this.playing.value && now - last < kBetweenTold) return;
      last = now;
      this.told.value = frame;
    });
    const tick = (now: number): void => {
      this.advance(now);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  clear(): void {
    this.free(this.reel.value);
    this.free(this.coming.value);
    this.reel.value = null;
    this.coming.value = null;
    this.frame.value = 0;
  }

  /** Takes news of a reel: a new one is fetched beside the one that plays. */
  follow(project: string, news: ReelNews): void {
    const coming = this.coming.value;
    if (this.reel.value?.news.number === news.number && coming?.news.number !== news.number) return;
    this.project = project;
    if (!coming || coming.news.number !== news.number) {
      if (coming && coming.news.number > news.number) return;
      if (coming && coming !== this.reel.value) this.free(coming);
      this.coming.value = { news, frames: new Array<ImageBitmap | undefined>(news.total), loaded: 0, enough: 0 };
      this.next = 0;
    } else {
      coming.news = news;
    }
    this.fetchMore();
  }

  /** Nothing more comes: what was begun for a change that was taken back is dropped. news   the reel that stands, if any. */
  settle(project: string, news: ReelNews | null): void {
    const coming = this.coming.value;
    if (coming && coming.news.number !== news?.number) {
      if (coming !== this.reel.value) this.free(coming);
      this.coming.value = null;
    }
    if (news) this.follow(project, news);
  }

  private fetchMore(): void {
    const reel = this.coming.value;
    while (reel && this.asking < kAtOnce && this.next < reel.news.ready) void this.fetchOne(reel, this.next++);
  }

  private async fetchOne(reel: Reel, index: number): Promise<void> {
    this.asking += 1;
    try {
      const answer = await fetch(address.frame(this.project, reel.news.number, index));
      if (!answer.ok && answer.status !== 404) throw new Error(answer.statusText); // 404: a newer reel took its place
      if (answer.ok && this.coming.value === reel) {
        reel.frames[index] = await createImageBitmap(await answer.blob());
        while (reel.frames[reel.loaded]) reel.loaded += 1;
        this.consider(reel);
      }
    } catch {
      if (this.coming.value === reel) window.setTimeout(() => void this.fetchOne(reel, index), kPatience);
    } finally {
      this.asking -= 1;
      this.fetchMore();
    }
  }

  /** Where a frame of the film lies in a reel. */
  private place(reel: Reel, frame = this.frame.value): number {
    const { total, first } = reel.news;
    return (((frame - first) % total) + total) % total;
  }

  private frameAt(reel: Reel, place: number): number {
    return (reel.news.first + place) % reel.news.total;
  }

  /**
   * A first look begins at once, layers in step with those that play, what is better when it is whole.
   * steps   whether the next frame is due.
   */
  private consider(reel: Reel, steps = false): void {
    const shown = this.reel.value;
    if (reel === shown) this.loaded.value = reel.loaded;
    if (this.coming.value !== reel) return;
    const { stage, total } = reel.news;
    const whole = reel.loaded === total;
    if (reel !== shown) {
      const enough = Math.min(stage === "layers" ? kEnoughLayers : kEnough, total);
      if (!whole && (reel.loaded < enough || (stage === "full" && shown))) return;
      reel.enough ||= performance.now();
      if (stage === "layers" && shown && this.playing.value && !(steps && this.follows(reel, shown))) return;
      this.take(reel);
    }
    if (whole) this.coming.value = null;
  }

  /** Whether the frame that is due is the reel's, or the last reel has none. */
  private follows(reel: Reel, shown: Reel): boolean {
    const { total } = reel.news;
    const next = this.place(reel, this.frame.value + 1);
    if (next < reel.loaded) return true;
    const dry = this.place(shown) >= shown.loaded - 1 && shown.loaded < shown.news.total;
    return total - next <= kFurthestLead ? dry : reel.loaded >= kLate;
  }

  private take(reel: Reel): void {
    this.free(this.reel.value);
    batch(() => {
      this.reel.value = reel;
      this.loaded.value = reel.loaded;
      // Layers begin with their first frame: the one before it was the last ones'.
      if (this.place(reel) >= reel.loaded) this.frame.value = this.frameAt(reel, reel.news.stage === "layers" ? 0 : reel.loaded - 1);
    });
  }

  private free(reel: Reel | null): void {
    for (const frame of reel?.frames ?? []) frame?.close();
    if (reel) reel.frames = [];
  }

  bitmap(): ImageBitmap | null {
    const reel = this.reel.value;
    return reel?.frames[Math.min(this.place(reel), reel.loaded - 1)] ?? null;
  }

  private advance(now: number): void {
    const reel = this.reel.value;
    if (!reel || !this.playing.value) {
      this.time = now;
      return;
    }
    const step = 1000 / (reel.news.fps * this.rate.value);
    if (now - this.time < step) return;
    this.time = now - this.time > 4 * step ? now : this.time + step;
    const frame = this.frame.value;
    const coming = this.coming.value;
    if (coming && coming !== reel) this.consider(coming, true);
    if (this.frame.value !== frame) return; // others have taken over
    const shown = this.reel.value ?? reel;
    const place = this.place(shown);
    if (place < shown.loaded - 1) this.frame.value = this.frameAt(shown, place + 1);
    else if (shown.loaded < shown.news.total) return; // it is still being made
    else if (this.loop.value) this.frame.value = this.frameAt(shown, 0);
    else this.playing.value = false;
  }

  seek(frame: number): void {
    const reel = this.reel.value;
    if (reel) this.frame.value = this.frameAt(reel, Math.min(this.place(reel, Math.max(0, Math.min(frame, reel.news.total - 1))), reel.loaded - 1));
  }

  toggle(): void {
    const reel = this.reel.value;
    if (reel && !this.playing.value && this.place(reel) >= reel.loaded - 1) this.frame.value = this.frameAt(reel, 0);
    this.playing.value = !this.playing.value;
  }
}
