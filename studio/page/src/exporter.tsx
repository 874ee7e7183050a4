// Out: a file, and the command line that makes the same one.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import * as api from "./api";
import { kModes } from "./modes";
import { CommandLine, CopyButton, Dialog, Running, Switch } from "./parts";
import * as state from "./state";
import type { Way } from "./types";
import { stageWords } from "./words";

const size = (bytes: number): string => (bytes > 1 << 20 ? `${(bytes / (1 << 20)).toFixed(1)} MB` : `${Math.round(bytes / 1024)} KB`);

export function Exporter(props: { open: boolean; onClose: () => void }): JSX.Element {
  const project = state.project.value;
  const [format, setFormat] = useState(0);
  const [title, setTitle] = useState("");
  const [made, setMade] = useState<{ job: number; folder: string; command: string } | null>(null);
  const [files, setFiles] = useState<api.Exported[]>([]);
  const [folder, setFolder] = useState("");
  const [depth, setDepth] = useState("");
  const [first, setFirst] = useState("");
  const [last, setLast] = useState("");
  const [number, setNumber] = useState("");
  const [width, setWidth] = useState("");
  const [fault, setFault] = useState("");
  const [alone, setAlone] = useState(false);
  const formats = state.home.value?.formats ?? [];
  const chosen = formats[format];
  const mode = state.mode.value;
  const way = kModes[mode].way ? mode : null; // what is on the screen is that way's film
  const parts = useAlone(props.open ? project?.id : undefined, way);
  const offered = parts === "layers" ? (chosen?.depths.includes("half") ?? false) : (chosen?.alpha ?? false) && (!way || parts === "fluid");
  const stem = (title || project?.id || "animation").replace(/[^A-Za-z0-9._-]+/g, "-").replace(/^[.-]+/, "") || "animation";
  const name = stem + (chosen?.ending ?? "");
  const job = made ? state.jobs.value[`command ${made.job}`] : undefined;
  const done = job?.state === "done";
  const running = job?.state === "running" || job?.state === "waiting";
  const id = project?.id;
  const events = state.exported.value;
  useEffect(() => {
    if (props.open && id) void api.exports(id).then((found) => {
        setFiles(found.files);
        setFolder(found.folder);
      });
  }, [props.open, id, events, done]);
  const isSequence = chosen?.sequence ?? false;
  const depths = chosen && chosen.depths.length > 1 ? chosen.depths : [];
  const begins = Number(number || 0);
  const ends = begins + (state.doc.value?.frames ?? 1) - 1;
  const range = first || last ? `${first || begins}-${last || ends}` : "";
  const start = async (): Promise<void> => {
    if (!id || !chosen) return;
    setFault("");
    try {
      await state.kept();
      setMade(way ? await api.exportWay(id, way, name, alone && offered) : await api.startExport(id, {
        name,
        ...(alone && offered && { layer: "fluid" }),
        ...(depths.includes(depth) && { depth }),
        ...(range && { range }),
        ...(width && width !== String(project?.width) && { width }),
        ...(number && { "start-number": number }),
      }));
    } catch (error) {
      setFault((error as Error).message);
    }
  };
  const line = made ? `cd '${made.folder}' && ${made.command}` : "";
  return (
    <Dialog title={way ? `Export: ${kModes[mode].label}` : "Export"} open={props.open} onClose={props.onClose}>
      <fieldset class="formats">
        <legend class="unseen">Format</legend>
        {formats.map((each, i) => (
          <label key={each.name} class="format">
            <input type="radio" name="format" class="unseen" checked={i === format} onChange={() => setFormat(i)} />
            <strong>{each.name}</strong>
            <span>{each.use}</span>
          </label>
        ))}
      </fieldset>
      {offered && <Switch {...(parts === "layers" ? { label: "Its layers", hint: "Beside the film, a part for each in every file" } : { label: "The fluid alone", hint: "With alpha, to lay over the picture" })} checked={alone} onChange={setAlone} />}
      <label class="field">
        <span>Name</span>
        <input value={title} placeholder={project?.id} onInput={(event) => setTitle(event.currentTarget.value)} />
      </label>
      {!way && <details class="more">
        <summary>Size, frames and depth</summary>
        <div class="quarters">
          <Whole label="Width" value={width} placeholder={String(project?.width ?? "")} onInput={setWidth} />
          <Whole label="From frame" value={first} placeholder={String(begins)} onInput={setFirst} />
          <Whole label="To frame" value={last} placeholder={String(ends)} onInput={setLast} />
          <Whole label="First number" value={number} placeholder="0" onInput={setNumber} />
          <label class="field">
            <span>Bits</span>
            <select value={depths.includes(depth) ? depth : ""} disabled={depths.length === 0} onChange={(event) => setDepth(event.currentTarget.value)}>
              <option value="">as fits</option>
              {depths.map((each) => (
                <option key={each} value={each}>
                  {each}
                </option>
              ))}
            </select>
          </label>
        </div>
      </details>}
      {!way && width && project && (
        <p class="hint">
          {width} × {Math.max(1, Math.round((Number(width) * project.height) / project.width))} px
        </p>
      )}
      <div class="row">
        <span class="hint">{isSequence ? `${stem}/${stem}.####${chosen?.ending}` : name}</span>
        <span class="spread" />
        {running && made ? (
          <button type="button" onClick={() => void api.stopJob("command", made.job)}>
            Stop
          </button>
        ) : (
          <button type="button" class="primary" disabled={!way && (!state.matte.value || !state.store.value)} onClick={() => void start()}>
            Make it
          </button>
        )}
      </div>
      {!way && !state.matte.value && <p class="hint">Say what flows first.</p>}
      {!way && !state.store.value && <p class="hint">Choose a store first, under Look.</p>}
      {job && running && <Running job={job} label="Export" words={stageWords(job.stage)} />}
      {(fault || job?.state === "failed") && <p class="problem">{fault || job?.fault}</p>}
      {line && <CommandLine text={line} />}
      {files.length > 0 && (
        <ul class="files" aria-label="Files that were made">
          {files.map((file) => (
            <li key={file.name} class={done && file.name === (isSequence ? stem : name) ? "new" : ""}>
              <span>{file.name}</span>
              <span class="hint">{file.pictures > 0 ? `${file.pictures} pictures, ${size(file.bytes)}` : size(file.bytes)}</span>
              {file.pictures > 0 ? (
                <CopyButton text={`${folder}/exports/${file.name}`} label={`Copy where ${file.name} lies`} />
              ) : (
                <a class="button small" href={api.address.exported(id ?? "", file.name)} download={file.name}>
                  Save
                </a>
              )}
            </li>
          ))}
        </ul>
      )}
    </Dialog>
  );
}

/** What a way can export in place of its film. */
function useAlone(id: string | undefined, way: string | null): Way["alone"] {
  const [alone, setAlone] = useState<Way["alone"]>("");
  useEffect(() => {
    setAlone("");
    if (id && way) api.way(id, way).then((found) => setAlone(found.alone), () => undefined);
  }, [id, way]);
  return alone;
}

function Whole(props: { label: string; value: string; placeholder: string; onInput: (value: string) => void }): JSX.Element {
  return (
    <label class="field">
      <span>{props.label}</span>
      <input type="text" inputMode="numeric" value={props.value} placeholder={props.placeholder} onInput={(event) => props.onInput(event.currentTarget.value.replace(/\D/g, ""))} />
    </label>
  );
}
