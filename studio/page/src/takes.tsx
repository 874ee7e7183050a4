// Takes of the animation in a strip below the picture: a click takes one. Where the present one looks wrong is marked
// red.
import { signal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect } from "preact/hooks";
import * as api from "./api";
import { Strip, Switch } from "./parts";
import * as state from "./state";
import type { Document, TakeChange } from "./types";
import * as view from "./view";

export const takesShown = signal(false);
const kFewest = 8; // frames that can be judged

/** What the document says when this take is taken. */
function changed(document: Document, { pace, own_speeds, ...fields }: TakeChange): Partial<Document> {
  if (pace === undefined && !own_speeds) return fields;
  const strokes = document.strokes.map((stroke) => ({ ...stroke, speed: own_speeds || stroke.speed === null ? null : stroke.speed * (pace ?? 1) }));
  return { ...fields, strokes };
}

export function TakesStrip(): JSX.Element {
  const open = state.project.value;
  const document = state.doc.value;
  const reel = state.player.reel.value;
  const whole = reel?.news.stage === "full" && !state.player.coming.value && !state.previewJob.value && state.saving.value === "saved";
  const number = whole ? reel.news.number : 0;
  const found = state.takes.value;
  const short = (document?.frames ?? 0) < kFewest;
  useEffect(() => {
    state.takes.value = null; // of the animation before
    if (!open || number === 0 || short) return;
    api.findTakes(open.id).catch((fault: Error) => (state.toast.value = fault.message));
  }, [open?.id, number, short]);
  useEffect(() => {
    view.worst.value = open && found?.marked && view.marksWorst.value ? api.address.take(open.id, found.number, "worst") : null;
    return () => {
      view.worst.value = null;
    };
  }, [open?.id, found, view.marksWorst.value]);
  if (!open || !document || !found)
    return (
      <div class="takes" aria-busy={!short}>
        <p class="hint">{short ? `Takes need ${kFewest} frames or more.` : "Other takes are made when the preview is whole…"}</p>
      </div>
    );
  const [present] = found.takes;
  return (
    <div class="takes">
      <ul aria-label="Takes">
        {found.takes.map((take, i) => (
          <li key={take.name}>
            <button
              type="button"
              class="take"
              aria-pressed={i === 0}
              disabled={take.faults === null}
              title={take.says || "Nothing is beyond what footage of the kind shows"}
              aria-label={i === 0 ? "Now: the present take" : `Take it ${take.name}${i === found.best ? " fewest faults" : ""}`}
              onClick={() => i > 0 && state.edit(changed(document, take.change))}
            >
              {take.faults !== null && <Strip source={api.address.take(open.id, found.number, i)} aspect={open.width / open.height} label={`${take.name}, playing`} />}
              <span>
                {i === 0 ? "Now" : take.name}
                {i === found.best && i > 0 && <em> fewest faults</em>}
              </span>
            </button>
          </li>
        ))}
      </ul>
      <div class="row">
        <p class="hint">{present?.says ? `What looks worst: ${present.says}.` : "Nothing looks worse than footage of the kind."}</p>
        <span class="spread" />
        {found.marked && <Switch label="Mark where" checked={view.marksWorst.value} onChange={(yes) => (view.marksWorst.value = yes)} />}
      </div>
    </div>
  );
}
