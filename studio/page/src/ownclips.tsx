// Clips that were given to the project alone.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { Film } from "lucide-preact";
import * as api from "./api";
import * as state from "./state";

/** Their names, asked anew when another one is chosen. */
export function useOwnClips(chosen: string): string[] {
  const id = state.project.value?.id ?? "";
  const [own, setOwn] = useState<string[]>([]);
  useEffect(() => {
    api.clips(id).then(setOwn, () => setOwn([]));
  }, [id, chosen]);
  return own;
}

/** A place to drop one more. taken   called with its name. */
export function DropClip({ taken, words = "Drop a clip, or choose a file", label = "Choose a clip's file" }: { taken: (name: string) => void; words?: string; label?: string }): JSX.Element {
  const [sent, setSent] = useState("");
  const take = async (file: File | undefined): Promise<void> => {
    const id = state.project.value?.id;
    if (!file || !id) return;
    setSent(`Sending ${file.name}`);
    try {
      const name = await api.sendOwnClip(id, file);
      if (state.project.value?.id === id) taken(name);
    } catch (fault) {
      state.toast.value = (fault as Error).message;
    }
    setSent("");
  };
  return (
    <label class="drop small" onDragOver={(event) => event.preventDefault()} onDrop={(event) => { event.preventDefault(); void take(event.dataTransfer?.files[0]); }}>
      <Film size={20} strokeWidth={1.5} aria-hidden />
      <strong>{sent || words}</strong>
      <input type="file" class="unseen" aria-label={label} accept={state.filmsAccepted.value} onChange={(event) => void take(event.currentTarget.files?.[0])} />
    </label>
  );
}
