// Going back and forth in a document, step by step, over reloads too.
import type { Document } from "./types";

type Field = keyof Document;

/** What a step changed of a field: `out` went and `came` came, at a place of a list; what is no list is a list of one. */
interface Change {
  field: Field;
  list: boolean;
  at: number;
  out: unknown[];
  came: unknown[];
}
type Step = Change[];

/** As it is kept. of   the document's fingerprint: with another one the steps lead nowhere. */
export interface Kept {
  of: string;
  steps: Step[];
  at: number;
}

const kMostSteps = 500;
const kMostText = 2_000_000; // characters that are kept

/** The same text for the same document, whoever wrote it: the server keeps single floats, and sorts names. */
export function canonical(value: unknown): string {
  if (typeof value === "number") return String(Math.fround(value));
  if (Array.isArray(value)) return `[${value.map(canonical).join()}]`;
  if (value === null || typeof value !== "object") return JSON.stringify(value);
  const entries = Object.entries(value).sort(([a], [b]) => (a < b ? -1 : 1));
  return `{${entries.map(([name, each]) => `${name}:${canonical(each)}`).join()}}`;
}

/** FNV-1a, twice: told apart by 64 bits. */
function fingerprint(document: Document): string {
  let [a, b] = [0x811c9dc5, 0x1234567];
  for (const letter of canonical(document)) {
    const code = letter.codePointAt(0) ?? 0;
    a = Math.imul(a ^ code, 0x01000193);
    b = Math.imul(b ^ code, 0x5bd1e995) ^ (b >>> 13);
  }
  return `${(a >>> 0).toString(16)}${(b >>> 0).toString(16)}`;
}

const same = (a: unknown, b: unknown): boolean => a === b || canonical(a) === canonical(b);

function changeOf(field: Field, before: unknown, after: unknown): Change | null {
  if (before === after) return null; // an edit shares what it leaves as it was
  const list = Array.isArray(before) && Array.isArray(after);
  const [a, b]: [unknown[], unknown[]] = list ? [before, after] : [[before], [after]];
  const shorter = Math.min(a.length, b.length);
  let at = 0;
  while (at < shorter && same(a[at], b[at])) ++at;
  let end = 0;
  while (end < shorter - at && same(a[a.length - 1 - end], b[b.length - 1 - end])) ++end;
  const change = { field, list, at, out: a.slice(at, a.length - end), came: b.slice(at, b.length - end) };
  return change.out.length + change.came.length > 0 ? change : null;
}

function stepOf(before: Document, after: Document): Step {
  const fields = Object.keys(after) as Field[];
  return fields.map((field) => changeOf(field, before[field], after[field])).filter((change) => change !== null);
}

function walk(document: Document, step: Step, back: boolean): Document {
  const walked: Record<string, unknown> = { ...document };
  for (const { field, list, at, out, came } of step) {
    const [leaves, comes] = back ? [came, out] : [out, came];
    const before = list ? (document[field] as unknown[]) : [];
    walked[field] = list ? [...before.slice(0, at), ...comes, ...before.slice(at + leaves.length)] : comes[0];
  }
  return walked as unknown as Document;
}

export class History {
  private steps: Step[] = [];
  private at = 0; // steps that have been made and not been undone

  get canUndo(): boolean {
    return this.at > 0;
  }
  get canRedo(): boolean {
    return this.at < this.steps.length;
  }

  clear(): void {
    this.steps = [];
    this.at = 0;
  }

  /** joins   this change goes on with the last one, and is one step with it. */
  add(before: Document, after: Document, joins: boolean): void {
    this.steps.length = this.at;
    const last = joins ? this.steps.pop() : undefined;
    const step = stepOf(last ? walk(before, last, true) : before, after);
    if (step.length > 0) this.steps.push(step);
    if (this.steps.length > kMostSteps) this.steps.shift();
    this.at = this.steps.length;
  }

  undo(document: Document): Document {
    const step = this.steps[this.at - 1];
    if (!step) return document;
    this.at -= 1;
    return walk(document, step, true);
  }

  redo(document: Document): Document {
    const step = this.steps[this.at];
    if (!step) return document;
    this.at += 1;
    return walk(document, step, false);
  }

  /** JSON of what is to be kept; the oldest steps are left out where it would be too much. */
  keep(document: Document): string {
    const text = (): string => JSON.stringify({ of: fingerprint(document), steps: this.steps, at: this.at } satisfies Kept);
    let kept = text();
    while (kept.length > kMostText && this.at > 0) {
      const gone = Math.ceil(this.at / 2);
      this.steps.splice(0, gone);
      this.at -= gone;
      kept = text();
    }
    return kept.length > kMostText ? "null" : kept;
  }

  take(kept: Kept | null, document: Document): void {
    this.clear();
    if (!kept || kept.of !== fingerprint(document)) return;
    this.steps = kept.steps;
    this.at = kept.at;
  }
}
