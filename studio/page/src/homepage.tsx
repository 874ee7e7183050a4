// The way in: pictures, projects, stores.
import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { Copy, ImagePlus, Infinity as InfinityIcon, Pencil, Plus, Trash2 } from "lucide-preact";
import * as api from "./api";
import { chosen, type Dropped, dropped, isStore, openProject, projectAmong } from "./dropped";
import { exampleClip, openEndless, openExample, openStored } from "./examples";
import { NameDialog } from "./namedialog";
import { go } from "./navigation";
import { Dialog, IconButton, Strip } from "./parts";
import * as state from "./state";
import { sendStills } from "./stillspanel";
import { ThemeButton } from "./themebutton";
import type { Job, Store } from "./types";

function ago(seconds: number): string {
  if (seconds < 90) return "just now";
  if (seconds < 5400) return `${Math.round(seconds / 60)} minutes ago`;
  if (seconds < 129600) return `${Math.round(seconds / 3600)} hours ago`;
  return `${Math.round(seconds / 86400)} days ago`;
}

const isVideo = (file: File): boolean => state.filmEndings.value.some((ending) => file.name.toLowerCase().endsWith(ending));

const kManyProjects = 6; // from which on one looks for them by name

export function HomePage(): JSX.Element {
  const [over, setOver] = useState(false);
  const [busy, setBusy] = useState("");
  const [clips, setClips] = useState<File[] | null>(null);
  const [sought, setSought] = useState("");
  const home = state.home.value;
  const take = async (coming: Dropped[] | Promise<Dropped[]>, wantsProject = false): Promise<void> => {
    try {
      const all = await coming;
      const project = projectAmong(all);
      if (wantsProject && !project) throw new Error("This folder holds no project: a project has a document.json and a picture.");
      const stores = all.filter(isStore);
      const files = all.filter((each) => !isStore(each)).map(({ file }) => file);
      const videos = files.filter(isVideo);
      const pictures = files.filter((file) => !isVideo(file));
      const picture = pictures[0];
      if (project) {
        setBusy(project.name);
        go(await openProject(project.name, project.files));
      } else if (stores.length > 0) {
        for (const { file } of stores) {
          setBusy(file.name);
          await api.openStore(file);
        }
        await state.showHome();
      } else if (videos.length > 0) {
        setClips(videos);
      } else if (picture) {
        setBusy(picture.name);
        const id = await api.openPicture(picture);
        if (pictures.length > 1) {
          await sendStills(id, pictures, (count) => setBusy(`${count} of ${pictures.length} stills`));
          state.beginWith("stills");
        }
        go(id);
      }
    } catch (fault) {
      state.toast.value = (fault as Error).message;
    }
    setBusy("");
  };
  const begin = async (name: string, opened: () => Promise<void>): Promise<void> => {
    setBusy(name);
    try {
      await opened();
    } catch (fault) {
      state.toast.value = (fault as Error).message;
    }
    setBusy("");
  };
  const example = exampleClip(home?.stores ?? []);
  const shown = home?.projects.filter(({ id }) => id.includes(sought.toLowerCase().replaceAll(" ", "-"))) ?? [];
  return (
    <main
      class={`home ${over ? "over" : ""}`}
      onDragOver={(event) => {
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={(event) => event.currentTarget === event.target && setOver(false)}
      onDrop={(event) => {
        event.preventDefault();
        setOver(false);
        void take(dropped(event.dataTransfer));
      }}
    >
      <header class="home-bar">
        <img src="icon.svg" alt="" width={28} height={28} />
        <h1>Freshet</h1>
        <span class="spread" />
        <ThemeButton />
      </header>
      <div class="doors">
        <article class="door">
          <picture class="door-view">
            <source media="(prefers-reduced-motion: reduce)" srcset="example.jpg" />
            <img src="example.webp" alt="A bay in the evening: its clouds and its water move" width={400} height={225} />
          </picture>
          <h2>Animate a picture</h2>
          <p class="hint">Scribble on the water, fire, smoke or clouds in it. PNG, JPEG, TIFF, WebP, EXR.</p>
          <div class="row">
            <label class="button primary">
              Choose a picture
              <input type="file" multiple class="unseen" aria-label="Choose a picture" accept="image/*,.exr,.tif,.tiff,.freshet" onChange={(event) => void take(chosen(event.currentTarget.files))} />
            </label>
            <button type="button" class="quiet" disabled={busy !== ""} onClick={() => void begin("the bay", openExample)}>
              Try this one
            </button>
          </div>
        </article>
        <article class="door">
          <span class="door-view">{example && <Strip source={api.address.clip(example.store, example.index)} aspect={example.aspect} label="A clip, playing" />}</span>
          <h2>Loop a clip</h2>
          <p class="hint">A short video of a fluid goes on without an end, along other lines if you like.</p>
          <div class="row">
            <label class="button primary">
              Choose a clip
              <input type="file" class="unseen" aria-label="Choose a clip to loop" accept={state.filmsAccepted.value} onChange={(event) => { const file = event.currentTarget.files?.[0]; if (file) void begin(file.name, () => openEndless(file)); }} />
            </label>
            {example && (
              <button type="button" class="quiet" disabled={busy !== ""} onClick={() => void begin(example.name, () => openStored(example, "clip"))}>
                Try this clip
              </button>
            )}
          </div>
        </article>
        <article class="door">
          <span class="door-view">{example && <StillsOf store={example.store} index={example.index} aspect={example.aspect} />}</span>
          <h2>Film from stills</h2>
          <p class="hint">Ten to twenty photographs of one scene, in any order, become a film of it.</p>
          <div class="row">
            <label class="button primary">
              Choose stills
              <input type="file" multiple class="unseen" aria-label="Choose stills" accept="image/*,.tif,.tiff" onChange={(event) => void take(chosen(event.currentTarget.files))} />
            </label>
            {example && (
              <button type="button" class="quiet" disabled={busy !== ""} onClick={() => void begin(example.name, () => openStored(example, "stills"))}>
                Try these stills
              </button>
            )}
          </div>
        </article>
      </div>
      <p class="drop-line" role="status">
        <ImagePlus size={18} strokeWidth={1.5} aria-hidden />
        {busy ? `Opening ${busy}` : "Drop a picture, stills, clips, a project's folder or a store anywhere on this page."}
      </p>
      <section>
        <header class="row">
          <h2>Projects</h2>
          <label class="button quiet">
            Open a folder
            <input type="file" class="unseen" aria-label="Open a project's folder" {...{ webkitdirectory: true }} onChange={(event) => void take(chosen(event.currentTarget.files), true)} />
          </label>
          <span class="spread" />
          {home && home.projects.length >= kManyProjects && <input type="text" class="find" placeholder="Find by name" aria-label="Find a project by name" value={sought} onInput={(event) => setSought(event.currentTarget.value)} />}
        </header>
        {home && home.projects.length > 0 && (
          <ul class="cards">
            {shown.map((each) => (
              <ProjectCard key={each.id} id={each.id} ago={ago(each.seconds_ago)} />
            ))}
          </ul>
        )}
        {home && home.projects.length > 0 && shown.length === 0 && <p class="hint">No project has this name.</p>}
      </section>
      <section>
        <header class="row">
          <h2>Stores of clips</h2>
          <button type="button" class="quiet" onClick={() => setClips([])}>
            <Plus size={16} aria-hidden /> Add clips
          </button>
        </header>
        {home?.stores.length === 0 && <p class="hint">There is no store yet. Add clips of water, fire, smoke or clouds, filmed with a camera that stands still.</p>}
        {home?.stores.map((store) => <StoreSection key={store.id} store={store} />)}
      </section>
      <Jobs />
      <OutcomeDialog />
      <ClipsDialog files={clips} onClose={() => setClips(null)} />
    </main>
  );
}

/** Some frames of a clip side by side, as stills lie on a table. */
function StillsOf(props: { store: string; index: number; aspect: number }): JSX.Element {
  const frames = [0, 8, 16, 23];
  return (
    <span class="stills-of" role="img" aria-label="Four stills of one scene">
      {frames.map((frame) => (
        <span key={frame} style={{ aspectRatio: String(props.aspect), backgroundImage: `url("${api.address.clip(props.store, props.index)}")`, backgroundSize: "2400% 100%", backgroundPosition: `${(100 * frame) / 23}% 0` }} />
      ))}
    </span>
  );
}

function ProjectCard({ id, ago: when }: { id: string; ago: string }): JSX.Element {
  const [naming, setNaming] = useState(false);
  const reload = async (): Promise<void> => void (state.home.value = await api.home());
  const copy = (): void => void api.copyProject(id).then(reload, (fault: Error) => (state.toast.value = fault.message));
  return (
    <li class="card">
      <a href={`#/${encodeURIComponent(id)}`}>
        <img src={api.address.thumbnail(id)} alt="" loading="lazy" />
        <span class="name">
          {id}
          <small>{when}</small>
        </span>
      </a>
      <span class="card-actions">
        <IconButton icon={Pencil} label={`Rename ${id}`} onClick={() => setNaming(true)} />
        <IconButton icon={Copy} label={`Duplicate ${id}`} onClick={copy} />
        <Remove id={id} />
      </span>
      <NameDialog id={id} open={naming} onClose={() => setNaming(false)} named={() => void reload()} />
    </li>
  );
}

function Remove({ id }: { id: string }): JSX.Element {
  const [sure, setSure] = useState(false);
  return sure ? (
    <button
      type="button"
      class="danger small"
      onBlur={() => setSure(false)}
      onClick={() => void api.removeProject(id).then(async () => (state.home.value = await api.home()))}
    >
      Remove {id}?
    </button>
  ) : (
    <IconButton icon={Trash2} label={`Remove ${id}`} onClick={() => setSure(true)} />
  );
}

function StoreSection({ store }: { store: Store }): JSX.Element {
  const kinds = state.classesOf(store);
  const [kind, setKind] = useState("");
  const shown = store.clips.map((clip, index) => ({ clip, index })).filter(({ clip }) => !kind || clip.class === kind);
  const licences = new Set(store.clips.map(({ licence }) => licence || "no licence"));
  const common = licences.size === 1 ? [...licences][0] : null; // said once
  return (
    <article class="store">
      <header class="row">
        <h3 title={store.path}>{store.name}</h3>
        <span class="hint">
          {store.clips.length} clips · {store.patches.toLocaleString("en")} patches{common && ` · ${common}`}
        </span>
        <span class="spread" />
        <div class="chips" role="group" aria-label="Kinds">
          {kinds.length > 1 &&
            ["", ...kinds].map((each) => (
              <button key={each} type="button" aria-pressed={kind === each} onClick={() => setKind(each)}>
                {each || "all"}
              </button>
            ))}
        </div>
      </header>
      {store.fault && <p class="problem">{store.fault}</p>}
      <ul class="cards clips">
        {shown.slice(0, 60).map(({ clip, index }) => (
          <li key={clip.name} class="card">
            <span class="frame">
              <span style={{ width: `${100 * Math.min(1, (clip.width / clip.height) * 0.75)}%` }}>
                <Strip source={api.address.clip(store.id, index)} aspect={clip.width / clip.height} label={`${clip.name}, playing`} plays={false} />
              </span>
            </span>
            <span class="name" title={clip.name}>
              {clip.name.replace(/^.*\//, "").replace(/\.[a-z0-9]+$/i, "")}
              <small>
                {(clip.frames / clip.fps).toFixed(1)} s{!common && ` · ${clip.licence || "no licence"}`}
              </small>
            </span>
            <span class="card-actions">
              <IconButton icon={InfinityIcon} label={`Make ${clip.name} endless`} onClick={() => void openStored({ store: store.id, index, name: clip.name }, "clip").catch((fault: Error) => (state.toast.value = fault.message))} />
            </span>
          </li>
        ))}
      </ul>
      {shown.length > 60 && <p class="hint">and {shown.length - 60} more</p>}
    </article>
  );
}

export function Jobs(): JSX.Element {
  const running = Object.values(state.jobs.value).filter((job) => job.lane === "command" && (job.state === "running" || job.state === "waiting" || job.state === "failed"));
  return (
    <ul class="jobs" aria-label="What is running">
      {running.map((job) => (
        <li key={job.id}>
          <span class="name">
            {job.title}
            <small>{job.state === "failed" ? job.fault : job.stage || job.state}</small>
          </span>
          {job.state === "failed" ? (
            <button type="button" class="quiet small" onClick={() => forget(job)}>
              Dismiss
            </button>
          ) : (
            <>
              <progress aria-label={job.title} max={job.of || 1} value={job.of ? job.done : undefined} />
              <button type="button" class="quiet small" onClick={() => void api.stopJob(job.lane, job.id)}>
                Stop
              </button>
            </>
          )}
        </li>
      ))}
    </ul>
  );
}

/** What became of the clips that were added, with the reasons against those that were not. */
function OutcomeDialog(): JSX.Element {
  const report = state.ingested.value;
  const clips = report?.clips ?? [];
  const added = clips.filter((clip) => clip.outcome === "added").length;
  return (
    <Dialog title={`${added} of ${clips.length} clips added`} open={report !== null} onClose={() => (state.ingested.value = null)}>
      <ul class="outcome">
        {clips.map((clip) => (
          <li key={clip.name}>
            {clip.strip ? <Strip source={api.address.screened(clip.strip)} aspect={clip.width / clip.height} label={`${clip.name}, playing`} /> : <span />}
            <span class={clip.outcome === "added" ? "" : "refused"}>
              {clip.name}: {clip.outcome}
              {[...clip.reasons, ...clip.notes].map((reason) => (
                <small key={reason}>{reason}</small>
              ))}
            </span>
          </li>
        ))}
      </ul>
    </Dialog>
  );
}

function forget(job: Job): void {
  state.jobs.value = Object.fromEntries(Object.entries(state.jobs.value).filter(([, each]) => each !== job));
}

function ClipsDialog(props: { files: File[] | null; onClose: () => void }): JSX.Element {
  const stores = state.home.value?.stores ?? [];
  const [more, setMore] = useState<File[]>([]);
  const [target, setTarget] = useState("");
  const [title, setTitle] = useState("my clips");
  const [kind, setKind] = useState("water");
  const [licence, setLicence] = useState("");
  const [sent, setSent] = useState(-1);
  const files = [...(props.files ?? []), ...more];
  const start = async (): Promise<void> => {
    try {
      const store = target || (await api.newStore(title)).id;
      for (const [i, file] of files.entries()) {
        setSent(i);
        await api.sendClip(store, kind, file);
      }
      await api.ingest(store, licence);
      setMore([]);
      props.onClose();
    } catch (fault) {
      state.toast.value = (fault as Error).message;
    }
    setSent(-1);
  };
  /** No store: a project of its own, in which it goes on without an end. */
  const goOn = async (): Promise<void> => {
    setSent(0);
    try {
      await openEndless(files[0] as File);
      props.onClose();
    } catch (fault) {
      state.toast.value = (fault as Error).message;
    }
    setMore([]);
    setSent(-1);
  };
  /** The first frame is animated as a picture. */
  const still = async (): Promise<void> => {
    setSent(0);
    try {
      const id = await api.openClip(files[0] as File, "picture");
      props.onClose();
      go(id);
    } catch (fault) {
      state.toast.value = (fault as Error).message;
    }
    setMore([]);
    setSent(-1);
  };
  return (
    <Dialog title="Add clips to a store" open={props.files !== null} onClose={props.onClose}>
      <p class="hint">A clip wants a camera that stands still, one take, and nothing moving but the fluid; four seconds or more.</p>
      <label class="drop small">
        <strong>{files.length === 0 ? "Choose clips" : `${files.length} clip${files.length === 1 ? "" : "s"}`}</strong>
        <span>{files.slice(0, 4).map((file) => file.name).join(", ")}</span>
        <input type="file" multiple class="unseen" aria-label="Choose clips" accept={state.filmsAccepted.value} onChange={(event) => setMore([...(event.currentTarget.files ?? [])])} />
      </label>
      <label class="field">
        <span>Store</span>
        <select value={target} onChange={(event) => setTarget(event.currentTarget.value)}>
          <option value="">A new one</option>
          {stores.map((store) => (
            <option key={store.id} value={store.id}>
              {store.name}
            </option>
          ))}
        </select>
      </label>
      {!target && (
        <label class="field">
          <span>Its name</span>
          <input value={title} onInput={(event) => setTitle(event.currentTarget.value)} />
        </label>
      )}
      <label class="field">
        <span>Kind of fluid</span>
        <input value={kind} list="kinds" onInput={(event) => setKind(event.currentTarget.value)} />
        <datalist id="kinds">
          {["water", "waterfall", "river", "sea", "fire", "smoke", "clouds"].map((each) => (
            <option key={each} value={each} />
          ))}
        </datalist>
      </label>
      <label class="field">
        <span>Licence</span>
        <input value={licence} placeholder="kept with every use" onInput={(event) => setLicence(event.currentTarget.value)} />
      </label>
      <footer class="row">
        <span class="hint">{sent >= 0 ? `Sending ${sent + 1} of ${files.length}` : ""}</span>
        <span class="spread" />
        {files.length === 1 && (
          <>
            <button type="button" disabled={sent >= 0} onClick={() => void still()}>
              Animate its first frame
            </button>
            <button type="button" disabled={sent >= 0} onClick={() => void goOn()}>
              Make it endless
            </button>
          </>
        )}
        <button type="button" class="primary" disabled={files.length === 0 || sent >= 0 || !kind} onClick={() => void start()}>
          Add {files.length || ""}
        </button>
      </footer>
    </Dialog>
  );
}
