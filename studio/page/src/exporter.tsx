// Out: a file, and the command line that makes the same one.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { Check, Copy } from "lucide-preact";
import * as api from "./api";
import { stageWords } from "./app";
import { Dialog } from "./parts";
import * as state from "./state";

interface Format {
  ending: string;
  name: string;
  text: string;
  layer?: string;
}

const kFormats: readonly Format[] = [
  { ending: ".mp4", name: "MP4", text: "H.264, plays anywhere" },
  { ending: ".webp", name: "WebP", text: "Animated picture, for sharing" },
  { ending: ".gif", name: "GIF", text: "For where nothing else goes" },
  { ending: ".mov", name: "ProRes", text: "10 bits, for editing" },
  { ending: ".mov", name: "ProRes, fluid alone", text: "With alpha, to lay over the picture", layer: "fluid" },
  { ending: ".mkv", name: "FFV1", text: "Lossless" },
];

const size = (bytes: number): string => (bytes > 1 << 20 ? `${(bytes / (1 << 20)).toFixed(1)} MB` : `${Math.round(bytes / 1024)} KB`);

export function Exporter(props: { open: boolean; onClose: () => void }): JSX.Element {
  const project = state.project.value;
  const [format, setFormat] = useState(0);
  const [title, setTitle] = useState("");
  const [made, setMade] = useState<{ job: number; folder: string; command: string } | null>(null);
  const [files, setFiles] = useState<{ name: string; bytes: number }[]>([]);
  const [copied, setCopied] = useState(false);
  const [fault, setFault] = useState("");
  const chosen = kFormats[format] as Format;
  const stem = (title || project?.id || "animation").replace(/[^A-Za-z0-9._-]+/g, "-").replace(/^[.-]+/, "") || "animation";
  const name = stem + chosen.ending;
  const job = made ? state.jobs.value[`command ${made.job}`] : undefined;
  const done = job?.state === "done";
  const running = job?.state === "running" || job?.state === "waiting";
  const id = project?.id;
  const events = state.exported.value;
  useEffect(() => {
    if (props.open && id) void api.exports(id).then((found) => setFiles(found.files));
  }, [props.open, id, events, done]);
  const start = async (): Promise<void> => {
    if (!id) return;
    setFault("");
    try {
      setMade(await api.startExport(id, { name, ...(chosen.layer && { layer: chosen.layer }) }));
    } catch (error) {
      setFault((error as Error).message);
    }
  };
  const line = made ? `cd '${made.folder}' && ${made.command}` : "";
  return (
    <Dialog title="Export" open={props.open} onClose={props.onClose}>
      <fieldset class="formats">
        <legend class="unseen">Format</legend>
        {kFormats.map((each, i) => (
          <label key={each.name} class="format">
            <input type="radio" name="format" class="unseen" checked={i === format} onChange={() => setFormat(i)} />
            <strong>{each.name}</strong>
            <span>{each.text}</span>
          </label>
        ))}
      </fieldset>
      <label class="field">
        <span>Name</span>
        <input value={title} placeholder={project?.id} onInput={(event) => setTitle(event.currentTarget.value)} />
      </label>
      <div class="row">
        <span class="hint">{name}</span>
        <span class="spread" />
        {running && made ? (
          <button type="button" onClick={() => void api.stopJob("command", made.job)}>
            Stop
          </button>
        ) : (
          <button type="button" class="primary" disabled={!state.matte.value || !state.store.value} onClick={() => void start()}>
            Make it
          </button>
        )}
      </div>
      {!state.matte.value && <p class="hint">Say what flows first.</p>}
      {!state.store.value && <p class="hint">Choose a store first, under Look.</p>}
      {job && running && (
        <div class="running">
          <progress aria-label="Export" max={job.of || 1} value={job.of ? job.done : undefined} />
          <span class="hint">{stageWords(job.stage) || "Starting"}</span>
        </div>
      )}
      {(fault || job?.state === "failed") && <p class="problem">{fault || job?.fault}</p>}
      {line && (
        <div class="command">
          <code>{line}</code>
          <button
            type="button"
            class="quiet small"
            aria-label="Copy the command line"
            onClick={() =>
              void navigator.clipboard.writeText(line).then(() => {
                setCopied(true);
                window.setTimeout(() => setCopied(false), 1500);
              })
            }
          >
            {copied ? <Check size={16} aria-hidden /> : <Copy size={16} aria-hidden />}
          </button>
        </div>
      )}
      {files.length > 0 && (
        <ul class="files" aria-label="Files that were made">
          {files.map((file) => (
            <li key={file.name} class={done && file.name === name ? "new" : ""}>
              <span>{file.name}</span>
              <span class="hint">{size(file.bytes)}</span>
              <a class="button small" href={api.address.exported(id ?? "", file.name)} download={file.name}>
                Save
              </a>
            </li>
          ))}
        </ul>
      )}
    </Dialog>
  );
}
