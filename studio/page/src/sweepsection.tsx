// Settings that are tried beside each other: what varies, and the films in step, of which one can be taken.
import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { Pause, Play } from "lucide-preact";
import * as api from "./api";
import { runKept, useWay, wayJob } from "./filmsection";
import { CommandLine, Dialog, IconButton, Running, Section, Select, Switch } from "./parts";
import * as state from "./state";
import type { Document, FoundSweep, Sweep, SweepAxis, SweepSetting, SweptAnimation } from "./types";
import { stageWords } from "./words";

const kWay = "sweep";
const kSettings: readonly (readonly [SweepSetting, string])[] = [
  ["speed", "Speed"],
  ["class", "Kind"],
  ["outline", "Outline"],
  ["lines", "Lines"],
];
const kMost = 16; // animations
const kShort = 48; // frames, unless all are asked for
const kApart = 0.05; // s that two films may be apart while they play

export function SweepSection({ document }: { document: Document }): JSX.Element {
  const { sweep } = document;
  const way = useWay(kWay, sweep);
  const [shown, setShown] = useState(false);
  const [fault, setFault] = useState("");
  const id = state.project.value?.id ?? "";
  const job = wayJob(id, kWay);
  const runs = job?.state === "running" || job?.state === "waiting";
  const count = sweep.axes.reduce((product, { values }) => product * values.length, sweep.axes.length === 0 ? 0 : 1);
  // Of an earlier try with more films, those that are no longer looked after are left out.
  const found = (way?.found as FoundSweep | null | undefined)?.animations.filter(({ video }) => way?.shown.includes(video)) ?? [];
  const start = async (): Promise<void> => {
    setFault("");
    try {
      await runKept(id, kWay);
    } catch (error) {
      setFault((error as Error).message);
    }
  };
  return (
    <Section title="Try settings" aside={<span class="figure">{count > 1 ? `${count} films` : ""}</span>}>
      {[0, 1].map((place) => (sweep.axes.length < place ? null : <Axis key={place} sweep={sweep} place={place} />))}
      {count > 1 && document.frames > kShort && (
        <Switch label="In full length" hint="Without it two seconds" checked={sweep.full} onChange={(full) => state.edit({ sweep: { ...sweep, full } })} />
      )}
      {count === 1 && <p class="hint">Two values or more are compared, such as 0.5, 2.</p>}
      {count === 0 && sweep.axes.length > 0 && <p class="hint">Say what is tried: speeds are numbers from 0.05 to 20.</p>}
      {count > kMost && <p class="problem">At most {kMost} films.</p>}
      {sweep.axes.length > 0 && (
        <div class="row">
          {found.length > 0 && (
            <button type="button" class="quiet" onClick={() => setShown(true)}>
              Look at {found.length}
            </button>
          )}
          <span class="spread" />
          {runs && job ? (
            <button type="button" onClick={() => void api.stopJob("command", job.id)}>
              Stop trying
            </button>
          ) : (
            <button type="button" disabled={count < 2 || count > kMost || !state.matte.value} onClick={() => void start()}>
              Try them
            </button>
          )}
        </div>
      )}
      {runs && job && <Running job={job} label="Trying settings" words={stageWords(job.stage)} />}
      {(fault || job?.state === "failed") && <p class="problem">{fault || job?.fault}</p>}
      {sweep.axes.length > 0 && way?.commands.map((line) => <CommandLine key={line} text={line} />)}
      <Dialog title="Side by side" open={shown && found.length > 0} onClose={() => setShown(false)} wide>
        {way?.made && <Grid id={id} swept={found} number={way.made} done={() => setShown(false)} />}
      </Dialog>
    </Section>
  );
}

function usual(setting: SweepSetting): string[] {
  switch (setting) {
    case "speed":
      return ["0.5", "1", "2"];
    case "class":
      return state.classesOf(state.store.value).slice(0, 4);
    case "outline":
      return ["still", "moving"];
    case "lines":
      return ["with", "without"];
  }
}

function Axis({ sweep, place }: { sweep: Sweep; place: number }): JSX.Element {
  const axis = sweep.axes[place];
  const others = sweep.axes.filter((_, i) => i !== place);
  const set = (changed: SweepAxis | undefined): void => {
    const axes = [...others];
    if (changed) axes.splice(place, 0, changed);
    state.edit({ sweep: { ...sweep, axes } });
  };
  return (
    <>
      <Select
        label={place === 0 ? "What varies" : "And"}
        value={axis?.setting ?? ""}
        options={[["", "Nothing"], ...kSettings.filter(([setting]) => others.every((each) => each.setting !== setting))]}
        onChange={(setting) => set(setting ? { setting, values: usual(setting) } : undefined)}
      />
      {axis?.setting === "speed" && <Speeds axis={axis} set={set} />}
      {axis?.setting === "class" && <Classes axis={axis} set={set} />}
    </>
  );
}

type Set = (axis: SweepAxis) => void;

function Speeds({ axis, set }: { axis: SweepAxis; set: Set }): JSX.Element {
  const take = (text: string): void => {
    const values = [...new Set(text.split(/[\s,;]+/).map(Number).filter((speed) => speed >= 0.05 && speed <= 20))].slice(0, kMost);
    set({ ...axis, values: values.map(String) });
  };
  return (
    <label class="field">
      <span>Times as fast</span>
      <input key={axis.values.join()} defaultValue={axis.values.join(", ")} onChange={(event) => take(event.currentTarget.value)} />
    </label>
  );
}

function Classes({ axis, set }: { axis: SweepAxis; set: Set }): JSX.Element {
  const classes = ["", ...state.classesOf(state.store.value)];
  const toggle = (each: string): void =>
    set({ ...axis, values: axis.values.includes(each) ? axis.values.filter((value) => value !== each) : [...axis.values, each].slice(0, kMost) });
  return (
    <div class="chips" role="group" aria-label="Kinds that are tried">
      {classes.map((each) => (
        <button key={each} type="button" aria-pressed={axis.values.includes(each)} onClick={() => toggle(each)}>
          {each || "Any"}
        </button>
      ))}
    </div>
  );
}

/** What a film was made with, in words. */
function words(settings: Record<string, string>): string {
  const named: Record<string, (value: string) => string> = {
    speed: (value) => `${value} × as fast`,
    class: (value) => (value === "-" ? "as it looks" : value),
    boundary: (value) => (value === "moving" ? "outline moves" : "outline stands"),
    strokes: (value) => (value === "-" ? "without lines" : "with lines"),
  };
  return Object.entries(named)
    .flatMap(([name, say]) => (settings[name] === undefined ? [] : [say(settings[name])]))
    .join(", ");
}

function take(settings: Record<string, string>): void {
  const { speed, class: kind, boundary, strokes } = settings;
  state.edit({
    ...(speed && { speed: Number(speed) }),
    ...(kind && { class: kind === "-" ? "" : kind.replace(/\\(.)/g, "$1") }),
    ...(boundary && { moving_outline: boundary === "moving" }),
    ...(strokes === "-" && { strokes: [], directions: [] }),
  });
}

function Grid(props: { id: string; swept: SweptAnimation[]; number: string; done: () => void }): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  const [plays, setPlays] = useState(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
  const [at, setAt] = useState(0); // 0..1
  const films = (): HTMLVideoElement[] => [...(box.current?.querySelectorAll("video") ?? [])];
  useEffect(() => {
    for (const film of films()) {
      if (plays) film.play().catch(() => undefined); // it plays when it has come
      else film.pause();
    }
    let timer = 0;
    const tick = (): void => {
      const [first, ...others] = films();
      if (first && first.duration > 0) {
        setAt(first.currentTime / first.duration);
        // The first one is the clock; one that has just begun again is not behind.
        for (const film of others) {
          if (film.seeking) continue;
          const off = Math.abs(film.currentTime - first.currentTime);
          if (Math.min(off, first.duration - off) > (plays ? kApart : 0.001)) film.currentTime = first.currentTime;
        }
      }
      timer = requestAnimationFrame(tick);
    };
    timer = requestAnimationFrame(tick);
    return () => cancelAnimationFrame(timer);
  }, [plays]);
  const seek = (to: number): void => {
    setPlays(false);
    for (const film of films()) if (film.duration > 0) film.currentTime = to * film.duration * 0.999;
    setAt(to);
  };
  return (
    <>
      <div class="row">
        <IconButton icon={plays ? Pause : Play} label={plays ? "Pause all" : "Play all"} onClick={() => setPlays(!plays)} />
        <input type="range" class="scrub" aria-label="Time of all" min={0} max={1} step="any" value={at} style={{ "--fill": `${100 * at}%` }} onInput={(event) => seek(event.currentTarget.valueAsNumber)} />
      </div>
      <div class="swept" ref={box}>
        {props.swept.map((animation) => (
          <Swept key={animation.assignment} animation={animation} source={api.address.wayFile(props.id, kWay, animation.video, props.number)} done={props.done} />
        ))}
      </div>
    </>
  );
}

function Swept({ animation, source, done }: { animation: SweptAnimation; source: string; done: () => void }): JSX.Element {
  const title = words(animation.settings);
  return (
    <figure>
      <video src={source} muted loop playsInline preload="auto" aria-label={title} />
      <figcaption>
        <span class="figure">{animation.assignment.replace(".json", "")}</span>
        <span class="name">
          {title}
          <small>{animation.result}</small>
        </span>
        <button type="button" class="small" aria-label={`Take ${title}`} onClick={() => { take(animation.settings); done(); }}>
          Take
        </button>
      </figcaption>
    </figure>
  );
}
