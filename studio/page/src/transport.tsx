// What plays, in every mode: the film of a way where there is one, else the animation; with its takes below.
import type { JSX } from "preact";
import { CircleDashed, Layers2, Pause, Play, Repeat, SplitSquareHorizontal } from "lucide-preact";
import { filmPlayer } from "./filmplayer";
import { kModes } from "./modes";
import { IconButton } from "./parts";
import * as state from "./state";
import { TakesStrip, takesShown } from "./takes";
import * as view from "./view";
import { stageWords } from "./words";

const showsFilm = (): boolean => view.film.value !== null;
const shownPlayer = (): typeof filmPlayer | typeof state.player => (showsFilm() ? filmPlayer : state.shownPlayer.value);

export const togglePlaying = (): void => shownPlayer().toggle();

/** A frame back or on. */
export function stepFrame(by: -1 | 1): void {
  if (showsFilm()) return filmPlayer.step(by);
  const player = state.shownPlayer.value;
  player.playing.value = false;
  player.seek(player.frame.value + by);
}

function statusWords(): string {
  if (state.problem.value) return state.problem.value;
  const job = state.previewJob.value;
  if (view.arriving.value) return "Opening the picture…";
  if (kModes[state.mode.value].way) return "";
  if (!state.doc.value?.store) return "Choose a store under Look, and it moves.";
  if (!state.matte.value && !job) return "Scribble on what flows.";
  if (job && job.state === "running" && job.stage)
    return job.of > 0 ? `${stageWords(job.stage)} ${Math.round((100 * job.done) / job.of)} %` : `${stageWords(job.stage)}…`;
  return "";
}

export function Transport(): JSX.Element {
  const film = showsFilm();
  const shown = shownPlayer();
  const player = state.shownPlayer.value;
  const reel = player.reel.value;
  const coming = player.coming.value;
  const total = reel?.news.total ?? 0;
  const busy = !!state.previewJob.value;
  const made = coming ? coming.loaded / Math.max(1, coming.news.total) : 0;
  const ready = film ? filmPlayer.length.value > 0 : !!reel;
  const at = film ? filmPlayer.time.value : reel ? player.told.value / reel.news.fps : 0;
  const share = film ? at / Math.max(0.01, filmPlayer.length.value) : player.told.value / Math.max(1, total - 1);
  const seek = (to: number): void => {
    if (film) return filmPlayer.seek(to * filmPlayer.length.value);
    player.playing.value = false;
    player.seek(Math.round(to * (total - 1)));
  };
  const size = film ? "Film" : reel && (reel.news.stage === "small" ? "First look" : `${reel.news.width} × ${reel.news.height}`);
  return (
    <footer class="transport" data-state={busy || coming || state.saving.value !== "saved" ? "busy" : (reel?.news.stage ?? "none")} data-reel={reel?.news.number ?? 0}>
      {takesShown.value && !film && !state.showsLayers.value && <TakesStrip />}
      <div class="row">
        <IconButton icon={shown.playing.value ? Pause : Play} label={shown.playing.value ? "Pause" : "Play"} shortcut="Space" disabled={!ready} onClick={togglePlaying} class="play" />
        <input
          type="range"
          class="scrub"
          aria-label="Frame"
          min={0}
          max={1}
          step={film ? "any" : 1 / Math.max(1, total - 1)}
          value={share}
          disabled={!ready}
          aria-valuetext={`${at.toFixed(2)} s`}
          style={{ "--fill": `${100 * share}%` }}
          onInput={(event) => seek(event.currentTarget.valueAsNumber)}
        />
        <output class="time">{ready ? `${at.toFixed(2)} s` : "–"}</output>
        <select class="rate" aria-label="Speed of playing" value={String(shown.rate.value)} onChange={(event) => (shown.rate.value = Number(event.currentTarget.value))}>
          {[0.25, 0.5, 1, 2].map((rate) => (
            <option key={rate} value={String(rate)}>
              {rate} ×
            </option>
          ))}
        </select>
        <IconButton icon={Repeat} label="Play again and again" pressed={shown.loop.value} onClick={() => (shown.loop.value = !shown.loop.value)} />
        {state.doc.value?.moving_outline && (
          <IconButton icon={CircleDashed} label="Outlines before (blue) and after (orange)" shortcut="O" pressed={view.onion.value} onClick={() => (view.onion.value = !view.onion.value)} />
        )}
        <IconButton icon={SplitSquareHorizontal} label="Compare with the picture" shortcut="C" pressed={view.compare.value !== null} onClick={() => (view.compare.value = view.compare.value === null ? 0.5 : null)} />
        {!film && !state.showsLayers.value && (
          <button type="button" class="quiet small" aria-pressed={takesShown.value} title="Other takes, and what looks wrong  (T)" disabled={!reel} onClick={() => (takesShown.value = !takesShown.value)}>
            <Layers2 size={16} aria-hidden /> Takes
          </button>
        )}
      </div>
      {view.compare.value !== null && (
        <input type="range" class="split" aria-label="How much of the picture as it was" min={0} max={1000} value={view.compare.value * 1000} style={{ "--fill": `${view.compare.value * 100}%` }} onInput={(event) => (view.compare.value = event.currentTarget.valueAsNumber / 1000)} />
      )}
      <div class={`progress ${busy ? "busy" : ""}`} aria-hidden>
        <span style={{ width: `${100 * made}%` }} />
      </div>
      <p class={`status ${state.problem.value ? "problem" : ""}`} role="status">
        {statusWords()}
        {!state.problem.value && !busy && <span class="stage-words">{size}</span>}
      </p>
    </footer>
  );
}
