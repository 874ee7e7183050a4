// A picture of many megapixels, as it is opened: offered smaller.
import type { JSX } from "preact";
import { useState } from "preact/hooks";
import * as api from "./api";
import { go } from "./navigation";
import { Dialog } from "./parts";
import * as state from "./state";
import type { Project } from "./types";

const kLarge = 20e6; // px
const kOffered = 3840; // px, of the longer side

export function LargePicture({ open }: { open: Project }): JSX.Element | null {
  const [answered, setAnswered] = useState(false);
  const [busy, setBusy] = useState(false);
  const document = state.doc.value;
  const { width, height } = open;
  if (answered || !document || width * height < kLarge) return null;
  if (document.scribbles.length + document.paint.length + document.strokes.length > 0) return null; // it is worked on
  const factor = Math.max(width, height) / kOffered;
  const reduce = async (): Promise<void> => {
    setBusy(true);
    try {
      go(await api.copyProject(open.id, kOffered)); // the large one stays among the projects
    } catch (fault) {
      state.toast.value = (fault as Error).message;
    }
    setBusy(false);
  };
  return (
    <Dialog title={`${((width * height) / 1e6).toFixed(0)} megapixels`} open={true} onClose={() => setAnswered(true)}>
      <p>
        {open.id} has {width} × {height} px. A film for the web needs no more than {Math.round(width / factor)} × {Math.round(height / factor)}, and is made {(factor * factor).toFixed(1)} times as fast.
      </p>
      <footer class="row">
        <button type="button" disabled={busy} onClick={() => setAnswered(true)}>
          Keep all pixels
        </button>
        <span class="spread" />
        <button type="button" class="primary" disabled={busy} onClick={() => void reduce()}>
          {busy ? "Reducing" : `Work at ${kOffered} px`}
        </button>
      </footer>
    </Dialog>
  );
}
