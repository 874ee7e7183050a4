// The film that another way has made: one video over the picture, with what the transport does to it.
import { effect, signal } from "@preact/signals";
import * as view from "./view";

const kStep = 1 / 25; // s that an arrow key goes

class FilmPlayer {
  readonly video = document.createElement("video");
  readonly playing = signal(true);
  readonly loop = signal(true);
  readonly rate = signal(1);
  readonly time = signal(0); // s
  readonly length = signal(0); // s; 0: not known yet

  constructor() {
    const { video } = this;
    Object.assign(video, { className: "film", muted: true, autoplay: true, playsInline: true, hidden: true });
    const tell = (): void => {
      this.time.value = video.currentTime;
      this.length.value = Number.isFinite(video.duration) ? video.duration : 0;
    };
    for (const event of ["timeupdate", "seeked", "loadedmetadata", "durationchange"]) video.addEventListener(event, tell);
    for (const event of ["play", "pause"]) video.addEventListener(event, () => (this.playing.value = !video.paused));
    video.addEventListener("loadeddata", () => (video.playbackRate = this.rate.value));
    effect(() => void (video.loop = this.loop.value));
    effect(() => void (video.playbackRate = this.rate.value));
    effect(() => {
      const source = view.film.value;
      video.hidden = !source;
      if (source) video.src = source;
      else video.removeAttribute("src");
    });
  }

  toggle(): void {
    if (this.video.paused) void this.video.play();
    else this.video.pause();
  }

  /** And stays there. */
  seek(time: number): void {
    this.video.pause();
    this.video.currentTime = Math.max(0, Math.min(time, this.length.value));
  }

  step(by: -1 | 1): void {
    this.seek(this.video.currentTime + by * kStep);
  }
}

export const filmPlayer = new FilmPlayer();
