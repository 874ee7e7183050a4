// What kind of fluid it is, and how fast: beside the matte, where one looks first.
import type { JSX } from "preact";
import { Section } from "./parts";
import * as state from "./state";
import type { Document, Pace } from "./types";

const kAny = "any"; // as a class: all of them
const kPaces: readonly Pace[] = ["auto", "slow", "natural", "fast"];

export function KindSection({ document }: { document: Document }): JSX.Element | null {
  const classes = state.classesOf(state.store.value);
  if (classes.length === 0) return null;
  const seen = document.class ? undefined : state.pieces.value?.kind;
  const taken = document.class || seen?.only || (classes.length === 1 ? classes[0] : "");
  const paces = state.pieces.value?.paces;
  const said = document.class ? "as you said" : taken && seen ? "guessed" : "";
  const kinds = classes.length > 1 ? [...classes, kAny] : classes;
  return (
    <Section title="Moves like" aside={<span class="figure">{said}</span>}>
      <div class="chips" role="group" aria-label="Kind of fluid">
        {kinds.map((kind) => (
          <button key={kind} type="button" aria-pressed={taken === kind} onClick={() => state.edit({ class: document.class === kind ? "" : kind })}>
            {kind}
          </button>
        ))}
      </div>
      {seen && !seen.sure && classes.length > 1 && (
        <p class="hint">
          It may be {taken || seen.class}. Say which it is.
        </p>
      )}
      {paces && (
        <div class="choice" role="group" aria-label="Speed of the fluid">
          {kPaces.map((pace) => (
            <button
              key={pace}
              type="button"
              title={pace === "auto" ? "Half-way from as filmed to natural; as filmed where lines have speeds" : undefined}
              aria-pressed={pace === "auto" ? document.speed === 0 : document.speed > 0 && Math.abs(Math.log(document.speed / paces[pace])) < 0.02}
              onClick={() => state.edit({ speed: pace === "auto" ? 0 : Number(paces[pace].toFixed(3)) })}
            >
              {pace}
            </button>
          ))}
        </div>
      )}
    </Section>
  );
}
