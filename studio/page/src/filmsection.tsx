// What another way of synthesis makes: its film over the picture, made, stopped and saved, and its command lines.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import * as api from "./api";
import { CommandLine, Running, Section, Switch } from "./parts";
import { layOver } from "./layers";
import * as state from "./state";
import type { Blend, Ground, Job, LayerFilm, Way } from "./types";
import * as view from "./view";
import { stageWords } from "./words";

/** What the server has of a way; asked anew when what was drawn for it is saved, and when a film is there. */
export function useWay(name: string, drawn: unknown): Way | null {
  const id = state.project.value?.id ?? "";
  const [way, setWay] = useState<Way | null>(null);
  const saved = state.saving.value === "saved";
  const films = state.filmed.value;
  useEffect(() => {
    if (!saved) return;
    api.way(id, name).then(setWay, () => setWay(null));
  }, [id, saved, films, drawn]);
  return way;
}

/** The last run of a way for a project, if there was one. */
export function wayJob(id: string, name: string): Job | undefined {
  return Object.values(state.jobs.value).filter((each) => each.key === `way ${id}/${name}`).at(-1);
}

/** Runs a way when what was changed is kept: its commands read it from there. */
export async function runKept(id: string, name: string): Promise<void> {
  await state.kept();
  await api.runWay(id, name);
}

/** live   it moves without a film. stale   and is newer than the film: it is shown in its place. said   a fault that stands above. */
export function FilmSection({ name, way, ready, live = false, stale = false, said = "" }: { name: string; way: Way | null; ready: boolean; live?: boolean; stale?: boolean; said?: string }): JSX.Element {
  const id = state.project.value?.id ?? "";
  const [fault, setFault] = useState("");
  const [past, setPast] = useState(0); // the job that was the last when the document changed
  const saved = state.saving.value === "saved";
  const job = wayJob(id, name);
  const runs = job?.state === "running" || job?.state === "waiting";
  const lacks = way?.lacks.replace(/^[^:]*: /, "") ?? "";
  const problem = fault || (job?.state === "failed" && job.id !== past ? job.fault : "");
  const source = way?.film ? api.address.film(id, name, way.film) : null;
  useEffect(() => {
    view.film.value = stale ? null : source;
    return () => {
      view.film.value = null;
    };
  }, [source, stale]);
  // A fault goes when what it was of is changed.
  useEffect(() => {
    setFault("");
    setPast(job?.id ?? 0);
  }, [way]);
  const start = (): void => {
    setFault("");
    api.runWay(id, name).catch((error: Error) => setFault(error.message));
  };
  return (
    <Section title="Film">
      <div class="row">
        {source && (
          <a class="button small" href={source} download={`${id}-${name}.mp4`}>
            Save
          </a>
        )}
        <span class="spread" />
        {runs && job ? (
          <button type="button" onClick={() => void api.stopJob("command", job.id)}>
            Stop
          </button>
        ) : (
          <button type="button" class="primary" disabled={!ready || !way || lacks !== "" || !saved} onClick={start}>
            Make it
          </button>
        )}
      </div>
      {(source || live) && <Switch label="Show what is drawn" checked={view.drawn.value} onChange={(yes) => (view.drawn.value = yes)} />}
      {runs && job && <Running job={job} label="Film" words={stageWords(job.stage)} />}
      {lacks && <p class="hint">{lacks}</p>}
      {problem && problem !== said && <p class="problem">{problem}</p>}
      {way?.commands.map((line) => <CommandLine key={line} text={line} />)}
    </Section>
  );
}

/** What a mode has made becomes a layer over the picture. */
export function LayOver({ film, blend, ground = "none" }: { film: LayerFilm; blend: Blend; ground?: Ground }): JSX.Element {
  return (
    <div class="row section">
      <button type="button" class="quiet" onClick={() => layOver({ name: film, film, blend, ground })}>
        Lay it over the picture
      </button>
    </div>
  );
}
