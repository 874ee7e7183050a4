// What kind of fluid it is, and how fast: beside the matte, where one looks first.
import type { JSX } from "preact";
import { Section } from "./parts";
import * as state from "./state";
import type { Document, Pace } from "./types";

const kSure = 0.7; // share of the pieces
const kSeen = 0.2;
const kPaces: readonly Pace[] = ["slow", "natural", "fast"];

/** Kinds by how many pieces look most like them, from the last labelling among all kinds. */
function likelyKinds(): { kind: string; share: number }[] {
  const found = state.pieces.value;
  if (!found) return [];
  const pieces = new Map<string, number>();
  for (const clip of found.clips) pieces.set(clip.class, (pieces.get(clip.class) ?? 0) + clip.pieces);
  const total = Math.max(1, found.pieces.length);
  return [...pieces].map(([kind, count]) => ({ kind, share: count / total })).sort((a, b) => b.share - a.share);
}

export function KindSection({ document }: { document: Document }): JSX.Element | null {
  const classes = state.classesOf(state.store.value);
  if (classes.length === 0) return null;
  const likely = document.class ? [] : likelyKinds();
  const seen = likely.filter(({ share }) => share >= kSeen);
  const [best] = likely;
  const sure = !!best && best.share >= kSure;
  const paces = state.pieces.value?.paces;
  const said = document.class ? "as you said" : sure ? "guessed" : "";
  return (
    <Section title="Moves like" aside={<span class="figure">{said}</span>}>
      <div class="chips" role="group" aria-label="Kind of fluid">
        {classes.map((kind) => (
          <button key={kind} type="button" aria-pressed={document.class ? document.class === kind : seen.some((each) => each.kind === kind)} onClick={() => state.edit({ class: document.class === kind ? "" : kind })}>
            {kind}
          </button>
        ))}
      </div>
      {best && !sure && (
        <p class="hint">
          It looks like {seen.map(({ kind, share }) => `${kind} (${Math.round(100 * share)} %)`).join(" and ") || "several kinds"}. If it is one of them, say which.
        </p>
      )}
      {paces && (
        <div class="choice" role="group" aria-label="Speed of the fluid">
          {kPaces.map((pace) => (
            <button key={pace} type="button" aria-pressed={Math.abs(Math.log(document.speed / paces[pace])) < 0.02} onClick={() => state.edit({ speed: Number(paces[pace].toFixed(3)) })}>
              {pace}
            </button>
          ))}
        </div>
      )}
    </Section>
  );
}
