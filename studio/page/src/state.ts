// What the page knows: the project that is open, its document with all earlier ones, and what the server has made of
// it.
import { batch, computed, signal } from "@preact/signals";
import * as api from "./api";
import { canonical, History } from "./history";
import { clearLayers, heardOfLayers, type LayersNews, liveLayers, renewLostLayers } from "./livelayers";
import { Player } from "./player";
import type { Document, Drawn, DrawnScene, Field, Home, Job, MatteNews, Mode, Pieces, Point, Project, ReelNews, Store, Takes } from "./types";

export interface IngestReport {
  clips: { name: string; outcome: string; reasons: string[]; notes: string[]; width: number; height: number; strip?: number }[];
}

export const pageId = Math.random().toString(36).slice(2, 12);
export const home = signal<Home | null>(null);
export const filmEndings = computed(() => home.value?.films ?? []);
/** As a file's input takes it. */
export const filmsAccepted = computed(() => ["video/*", ...filmEndings.value].join(","));
export const project = signal<Project | null>(null);
export const doc = signal<Document | null>(null);
export const mode = signal<Mode>("fluid");
export const jobs = signal<Record<string, Job>>({});
export const matte = signal<MatteNews | null>(null);
export const field = signal<Field | null>(null);
export const pieces = signal<Pieces | null>(null);
export const takes = signal<Takes | null>(null);
export const offered = signal<Point[][]>([]); // outlines of what may be held still

/** A click that took what lies there, so that it may take more of it or less. */
export interface Click {
  at: Point;
  size: number; // times what a click takes by itself
  before: Drawn[]; // what was held
  after: Drawn[];
}
export const clicked = signal<Click | null>(null);
export const labelsNumber = signal(0);
export const problem = signal("");
export const toast = signal("");
export const connected = signal(true);
export const saving = signal<"saved" | "saving" | "offline">("saved");
export const ingested = signal<IngestReport | null>(null);
export const exported = signal(0);
export const filmed = signal(0); // films that other ways have made
export const player = new Player();
export const keptScene = signal<DrawnScene | null>(null); // the server's
export const showsLayers = computed(() => mode.value === "scene" && !!liveLayers.reel.value);
/** What moves over the picture, where no film does. */
export const shownPlayer = computed(() => (showsLayers.value ? liveLayers : player));
let firstMode: Mode | null = null; // that the next project opens with

/** The next project that is opened begins with this. */
export function beginWith(wanted: Mode): void {
  firstMode = wanted;
}

/** Ends of the slider for a number of the scene, by table and key. */
export function range(key: string): { min: number; max: number } {
  const [min, max] = home.value?.ranges[key] ?? [0, 1];
  return { min, max };
}
export const store = computed(() => home.value?.stores.find((each) => each.path === doc.value?.store) ?? null);
/** The kinds of fluid that a store has. */
export const classesOf = (of: Store | null): string[] => [...new Set(of?.clips.map((clip) => clip.class) ?? [])].sort();
export const previewJob = computed(() =>
  Object.values(jobs.value).find(
    (job) => job.lane === "preview" && job.key === project.value?.id && isBusy(job),
  ),
);

// ---- the document, and going back and forth in it

const history = new History();
let lastKey = "";
let lastTime = 0;
export const canUndo = signal(false);
export const canRedo = signal(false);

function told(): void {
  canUndo.value = history.canUndo;
  canRedo.value = history.canRedo;
}

/** Changes the document. Changes of one key that follow each other closely, as of a slider, are one step back. */
export function edit(change: Partial<Document>, key = ""): void {
  const before = doc.value;
  if (!before) return;
  const now = performance.now();
  const after = { ...before, ...change };
  history.add(before, after, key !== "" && key === lastKey && now - lastTime < 1000);
  lastKey = key;
  lastTime = now;
  show(after);
}

export function undo(): void {
  lastKey = "";
  if (doc.value && history.canUndo) show(history.undo(doc.value));
}

export function redo(): void {
  lastKey = "";
  if (doc.value && history.canRedo) show(history.redo(doc.value));
}

function show(document: Document): void {
  doc.value = document;
  told();
  keep();
}

// ---- keeping it: one request at a time, the newest document always last

let version = 0;
let keptText = ""; // of the document that the server has from us, or gave us
let dirty = false;
let busy = false;
let timer = 0;

const kRest = 40; // ms without a change, after which it is kept
const kFollowed = 100; // ms after which layers follow a slider that does not rest
let since = 0; // of the oldest change that is not kept

function keep(): void {
  const now = performance.now();
  if (!dirty) since = now;
  dirty = true;
  saving.value = "saving";
  if (mode.value !== "scene" || now - since < kFollowed) {
    window.clearTimeout(timer);
    timer = window.setTimeout(() => void send(), kRest);
  }
  window.clearTimeout(historyTimer);
  historyTimer = window.setTimeout(() => keepHistory(), 300);
}

let historyTimer = 0;

function keepHistory(leaving = false): void {
  window.clearTimeout(historyTimer);
  historyTimer = 0;
  const id = project.value?.id;
  // Where it cannot be kept, nothing is lost but steps back.
  if (id && doc.value) api.keepHistory(id, history.keep(doc.value), leaving).catch(() => undefined);
}

// Who closes the page at once after a stroke has that stroke kept, and can undo it.
window.addEventListener("pagehide", () => {
  const [id, document] = [project.value?.id, doc.value];
  if (id && document && (dirty || busy)) {
    // What is on its way may have been taken by then, or never come: one of the two follows on what the server has.
    const bases = busy ? [version, version + 1] : [version];
    for (const base of bases) void api.save(id, document, base, pageId, true).catch(() => undefined);
  }
  if (historyTimer) keepHistory(true);
});

async function send(): Promise<void> {
  const id = project.value?.id;
  const document = doc.value;
  if (busy || !dirty || !id || !document) return;
  busy = true;
  dirty = false;
  try {
    const saved = await api.save(id, document, version, pageId);
    if (project.value?.id !== id) return;
    version = saved.version;
    if (saved.taken) {
      keptText = canonical(document);
      keptScene.value = document.scene;
      expectPreview(id, saved.job);
    } else if (canonical(saved.document) === keptText) {
      dirty = true; // a server that was started again counts anew, and nobody else has changed anything
    } else {
      keptText = canonical(saved.document);
      adopt(saved.document, "Changed in another window: what it has is shown here.");
    }
    saving.value = dirty ? "saving" : "saved";
  } catch (fault) {
    if (fault instanceof api.Fault && fault.status < 500) {
      toast.value = fault.message;
      saving.value = "saved";
    } else {
      dirty = true;
      saving.value = "offline";
      window.clearTimeout(timer);
      timer = window.setTimeout(() => void send(), 1000);
    }
  } finally {
    busy = false;
  }
  if (dirty && saving.value !== "offline") void send();
}

/** Until the server has all that was changed. */
export async function kept(): Promise<void> {
  while (saving.value !== "saved") await new Promise((resolve) => window.setTimeout(resolve, 20));
}

function adopt(document: Document, word = ""): void {
  history.clear();
  doc.value = document;
  keptScene.value = document.scene;
  told();
  if (word) toast.value = word;
}

// ---- opening

let endListening: (() => void) | null = null;

export async function showHome(): Promise<void> {
  leave();
  home.value = await api.home();
  hear(0);
}

function leave(): void {
  if (dirty) void send();
  if (historyTimer) keepHistory();
  endListening?.();
  endListening = null;
  player.clear();
  clearLayers();
  batch(() => {
    project.value = null;
    doc.value = null;
    matte.value = null;
    field.value = null;
    pieces.value = null;
    takes.value = null;
    problem.value = "";
    offered.value = [];
    clicked.value = null;
  });
}

export async function openProject(id: string): Promise<void> {
  leave();
  const [opened, house, steps] = await Promise.all([api.project(id), api.home(), api.history(id)]);
  home.value = house;
  take(opened);
  history.take(steps, opened.document);
  told();
  await askJobs();
  if (project.value === opened) hear(opened.event);
}

function take(opened: Project): void {
  version = opened.version;
  keptText = canonical(opened.document);
  dirty = false;
  batch(() => {
    project.value = opened;
    adopt(opened.document);
    saving.value = "saved";
    if (opened.notice) toast.value = opened.notice;
    const document = opened.document;
    const drawn = document.scribbles.length + document.paint.length > 0 || document.matte_base !== "scribbles";
    mode.value = firstMode ?? (drawn ? "flow" : "fluid");
    firstMode = null;
  });
  showMade(opened);
}

/** What the server has made so far. */
function showMade(opened: Project): void {
  matte.value = opened.made.matte;
  problem.value = opened.made.problem;
  const reel = opened.made.full ?? opened.made.small;
  if (reel) player.follow(opened.id, reel);
  if (opened.made.field) loadField(opened.id).catch(() => undefined);
  if (opened.made.labels) loadPieces(opened.id).catch(() => undefined);
}

const jobKey = (job: Job): string => `${job.lane} ${job.id}`;
const isBusy = (job: Job): boolean => job.state === "waiting" || job.state === "running";

/** What runs, where its news were missed. News that come while the answer is on its way are later than it. */
async function askJobs(): Promise<void> {
  const listed = await api.jobs();
  const newest = Math.max(0, ...listed.map((job) => job.id));
  const later = Object.values(jobs.value).filter((job) => job.id > newest);
  const now = listed.map((job) => {
    const known = jobs.value[jobKey(job)];
    return known && !isBusy(known) ? known : job;
  });
  jobs.value = Object.fromEntries([...now, ...later].map((job) => [jobKey(job), job]));
}

async function loadField(id: string): Promise<void> {
  const found = await api.field(id);
  if (project.value?.id === id) field.value = found;
}

async function loadPieces(id: string): Promise<void> {
  const found = await api.pieces(id);
  if (project.value?.id === id)
    batch(() => {
      pieces.value = found;
      labelsNumber.value += 1;
    });
}

function hear(after: number): void {
  endListening = api.listen(after, (type, data) => void heard(type, data).catch(() => undefined), (yes) => {
    // A server that was started again knows nothing of what it had made: ask for all.
    if (yes && !connected.value && project.value) void reload();
    connected.value = yes;
  });
}

async function reload(): Promise<void> {
  const id = project.value?.id;
  if (!id) return;
  try {
    const opened = await api.project(id);
    if (dirty) {
      void send();
    } else {
      version = opened.version;
      if (canonical(opened.document) !== canonical(doc.value)) adopt(opened.document);
      keptText = canonical(opened.document);
    }
    showMade(opened);
    if (showsLayers.value) renewLostLayers(id);
    await askJobs();
  } catch {
    connected.value = false;
  }
}

const kJobsKept = 64;

function noteJob(job: Job): void {
  const kept = Object.values(jobs.value).slice(-kJobsKept).filter((each) => jobKey(each) !== jobKey(job));
  jobs.value = Object.fromEntries([...kept, job].map((each) => [jobKey(each), each]));
}

/** A change is being worked on from the moment when it is taken, though the news of its job may come a little later. */
function expectPreview(key: string, id: number): void {
  if (jobs.value[`preview ${id}`]) return;
  noteJob({ lane: "preview", id, key, title: "", state: "waiting", stage: "", done: 0, of: 0, fault: "" });
}

async function heard(type: string, data: unknown): Promise<void> {
  const news = data as { project?: string };
  const id = project.value?.id;
  if (type === "job") return noteJob(data as Job);
  if (type === "gap") return reload();
  if (type === "ingested") {
    home.value = await api.home();
    ingested.value = (data as { report: IngestReport | null }).report;
    return;
  }
  if (!id || news.project !== id) return;
  switch (type) {
    case "document": {
      const change = data as { version: number; page: string };
      if (change.page === pageId || change.version <= version) return;
      const opened = await api.project(id);
      if (dirty || busy) return; // our own change will be told what is there
      version = opened.version;
      keptText = canonical(opened.document);
      adopt(opened.document);
      return;
    }
    case "matte":
      matte.value = (data as { matte: MatteNews | null }).matte;
      return;
    case "field":
      return loadField(id);
    case "labels":
      return loadPieces(id);
    case "takes":
      takes.value = await api.takes(id);
      return;
    case "reel":
      player.follow(id, (data as { reel: ReelNews }).reel);
      return;
    case "layers":
      heardOfLayers(id, data as LayersNews);
      return;
    case "settled":
      player.settle(id, (data as { reel: ReelNews | null }).reel);
      return;
    case "problem":
      problem.value = (data as { text: string }).text;
      return;
    case "way":
      filmed.value += 1;
      return;
    case "export":
      exported.value += 1;
      return;
  }
}
