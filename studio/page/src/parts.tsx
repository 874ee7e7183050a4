// Small parts that the panels are made of.
import type { ComponentChildren, JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { Check, Copy } from "lucide-preact";
import type { Job } from "./types";

type Icon = (props: { size?: number; strokeWidth?: number; "aria-hidden"?: boolean }) => JSX.Element;

export function IconButton(props: {
  icon: unknown;
  label: string;
  shortcut?: string;
  onClick: () => void;
  pressed?: boolean;
  disabled?: boolean;
  class?: string;
}): JSX.Element {
  const Drawn = props.icon as Icon;
  return (
    <button
      type="button"
      class={`icon-button ${props.class ?? ""}`}
      aria-label={props.label}
      title={props.shortcut ? `${props.label}  (${props.shortcut})` : props.label}
      aria-pressed={props.pressed}
      disabled={props.disabled}
      onClick={props.onClick}
    >
      <Drawn size={18} strokeWidth={1.75} aria-hidden />
    </button>
  );
}

export function Choice<T extends string>(props: {
  label: string;
  value: T;
  options: readonly (readonly [T, string])[];
  onChange: (value: T) => void;
}): JSX.Element {
  return (
    <div class="choice" role="radiogroup" aria-label={props.label}>
      {props.options.map(([value, text]) => (
        <button
          key={value}
          type="button"
          role="radio"
          aria-checked={value === props.value}
          tabIndex={value === props.value ? 0 : -1}
          onClick={() => props.onChange(value)}
          onKeyDown={(event) => {
            const step = event.key === "ArrowRight" || event.key === "ArrowDown" ? 1 : event.key === "ArrowLeft" || event.key === "ArrowUp" ? -1 : 0;
            if (step === 0) return;
            event.preventDefault();
            event.stopPropagation();
            const index = props.options.findIndex(([each]) => each === props.value);
            const next = props.options[(index + step + props.options.length) % props.options.length];
            if (next) props.onChange(next[0]);
            const buttons = (event.currentTarget as HTMLElement).parentElement?.querySelectorAll("button");
            buttons?.[(index + step + props.options.length) % props.options.length]?.focus();
          }}
        >
          {text}
        </button>
      ))}
    </div>
  );
}

/** One of many, by name. options   values and their words. */
export function Select<T extends string>(props: {
  label: string;
  value: T;
  options: readonly (readonly [T, string])[];
  onChange: (value: T) => void;
}): JSX.Element {
  return (
    <label class="field">
      <span>{props.label}</span>
      <select value={props.value} onChange={(event) => props.onChange(event.currentTarget.value as T)}>
        {props.options.map(([value, text]) => (
          <option key={value} value={value}>
            {text}
          </option>
        ))}
      </select>
    </label>
  );
}

/** A name is its own word. */
export const named = (names: readonly string[]): (readonly [string, string])[] => names.map((name) => [name, name]);

export function Slider(props: {
  label: string;
  value: number;
  min: number;
  max: number;
  step?: number;
  shown?: string;
  logarithmic?: boolean;
  onInput: (value: number) => void;
}): JSX.Element {
  const curve = props.logarithmic ? Math.log : (x: number): number => x;
  const back = props.logarithmic ? Math.exp : (x: number): number => x;
  const step = props.logarithmic ? (curve(props.max) - curve(props.min)) / 200 : (props.step ?? 1);
  const fill = ((curve(props.value) - curve(props.min)) / (curve(props.max) - curve(props.min))) * 100;
  return (
    <label class="slider">
      <span class="row">
        <span>{props.label}</span>
        <span class="value">{props.shown ?? props.value}</span>
      </span>
      <input
        type="range"
        aria-label={props.label}
        min={curve(props.min)}
        max={curve(props.max)}
        step={step}
        value={curve(props.value)}
        style={{ "--fill": `${Math.max(0, Math.min(100, fill))}%` }}
        aria-valuetext={props.shown}
        onInput={(event) => props.onInput(back(event.currentTarget.valueAsNumber))}
      />
    </label>
  );
}

export function Switch(props: { label: string; hint?: string; checked: boolean; onChange: (value: boolean) => void }): JSX.Element {
  return (
    <label class="switch">
      <span>
        {props.label}
        {props.hint && <small>{props.hint}</small>}
      </span>
      <input type="checkbox" role="switch" checked={props.checked} onChange={(event) => props.onChange(event.currentTarget.checked)} />
    </label>
  );
}

export function CopyButton({ text, label }: { text: string; label: string }): JSX.Element {
  const [copied, setCopied] = useState(false);
  const copy = async (): Promise<void> => {
    await navigator.clipboard.writeText(text);
    setCopied(true);
    window.setTimeout(() => setCopied(false), 1500);
  };
  return (
    <button type="button" class="quiet small" aria-label={label} title={label} onClick={() => void copy()}>
      {copied ? <Check size={16} aria-hidden /> : <Copy size={16} aria-hidden />}
    </button>
  );
}

/** A command line, to be copied. */
export function CommandLine({ text }: { text: string }): JSX.Element {
  return (
    <details class="command">
      <summary>Command line</summary>
      <div>
        <code>{text}</code>
        <CopyButton text={text} label="Copy the command line" />
      </div>
    </details>
  );
}

/** A job of the command queue that runs: how far it is. */
export function Running({ job, label, words }: { job: Job; label: string; words: string }): JSX.Element {
  return (
    <div class="running">
      <progress aria-label={label} max={job.of || 1} value={job.of ? job.done : undefined} />
      <span class="hint">{words || "Starting"}</span>
    </div>
  );
}

export function Section(props: { title: string; aside?: ComponentChildren; children: ComponentChildren }): JSX.Element {
  return (
    <section class="section">
      <header>
        <h3>{props.title}</h3>
        {props.aside}
      </header>
      {props.children}
    </section>
  );
}

/** A strip of frames side by side, played. aspect   width by height of one frame. */
export function Strip(props: { source: string; aspect: number; label: string; plays?: boolean; class?: string }): JSX.Element {
  const [count, setCount] = useState(0);
  useEffect(() => {
    let alive = true;
    const image = new Image();
    image.onload = () => {
      if (alive) setCount(Math.max(1, Math.round(image.naturalWidth / (image.naturalHeight * props.aspect))));
    };
    image.src = props.source;
    return () => {
      alive = false;
    };
  }, [props.source, props.aspect]);
  return (
    <span
      class={`strip ${props.plays === false ? "waits" : ""} ${props.class ?? ""}`}
      role="img"
      aria-label={props.label}
      style={{
        aspectRatio: String(props.aspect),
        ...(count > 0 && {
          backgroundImage: `url("${props.source}")`,
          backgroundSize: `${count * 100}% 100%`,
          animation: count > 1 ? `strip ${count / 12}s steps(${count}, jump-none) infinite` : undefined,
        }),
      }}
    />
  );
}

export function Dialog(props: { title: string; open: boolean; onClose: () => void; children: ComponentChildren; wide?: boolean }): JSX.Element {
  const ref = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    const dialog = ref.current;
    if (!dialog) return;
    if (props.open && !dialog.open) dialog.showModal();
    if (!props.open && dialog.open) dialog.close();
  }, [props.open]);
  return (
    <dialog ref={ref} class={props.wide ? "wide" : ""} aria-label={props.title} onClose={props.onClose} onClick={(event) => event.target === ref.current && props.onClose()}>
      {props.open && (
        <div class="dialog-body">
          <header>
            <h2>{props.title}</h2>
            <button type="button" class="quiet" onClick={props.onClose}>
              Close
            </button>
          </header>
          {props.children}
        </div>
      )}
    </dialog>
  );
}
