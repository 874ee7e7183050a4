// The server, as functions. Addresses are relative: the token stands in the page's own.
import type { Kept } from "./history";
import type { Candidates, Document, Drawn, Field, Home, Job, Pieces, Point, Project, Takes, Way } from "./types";

export class Fault extends Error {
  constructor(readonly status: number, text: string) {
    super(text);
  }
}

const kGetAttempts = 3;
const kRetryDelayMs = 250;

/** A GET is sent again when its connection breaks. */
async function send(path: string, init?: RequestInit): Promise<Response> {
  for (let left = init?.method ? 0 : kGetAttempts - 1; ; --left) {
    try {
      return await fetch(path, init);
    } catch (fault) {
      if (left === 0) throw fault;
      await new Promise((resolve) => window.setTimeout(resolve, kRetryDelayMs));
    }
  }
}

async function ask(path: string, init?: RequestInit): Promise<Response> {
  const response = await send(path, init);
  if (response.ok || response.status === 409) return response;
  const text = await response.text();
  let fault = text;
  try {
    fault = (JSON.parse(text) as { fault: string }).fault;
  } catch {
    // plain text is a fault too
  }
  throw new Fault(response.status, fault || response.statusText);
}

async function get<T>(path: string): Promise<T> {
  return (await (await ask(path)).json()) as T;
}

async function post<T>(path: string, body: unknown): Promise<T> {
  return (await (await ask(path, { method: "POST", body: JSON.stringify(body) })).json()) as T;
}

const name = encodeURIComponent;
const at = (project: string): string => `api/projects/${name(project)}`;

export const address = {
  picture: (project: string, longest: number): string => `${at(project)}/picture?longest=${longest}`,
  part: (project: string, x: number, y: number, width: number, height: number, longest: number): string =>
    `${at(project)}/picture?x=${x}&y=${y}&width=${width}&height=${height}&longest=${longest}`,
  thumbnail: (project: string): string => `${at(project)}/thumbnail`,
  matte: (project: string, number: number, which: "alpha" | "held"): string =>
    `${at(project)}/mattes/${number}/${which}`,
  frame: (project: string, reel: number, frame: number): string => `${at(project)}/reels/${reel}/${frame}`,
  patch: (project: string, piece: number, candidate: number, version: number): string =>
    `${at(project)}/pieces/${piece}/${candidate}?v=${version}`,
  take: (project: string, number: number, take: number | "worst"): string => `${at(project)}/takes/${number}/${take}`,
  clip: (store: string, clip: number): string => `api/stores/${name(store)}/clips/${clip}`,
  screened: (number: number): string => `api/screened/${number}`,
  exported: (project: string, file: string): string => `${at(project)}/exports/${name(file)}`,
  film: (project: string, way: string, number: string): string => `${at(project)}/ways/${way}/film?n=${number}`,
  wayFile: (project: string, way: string, file: string, number: string): string => `${at(project)}/ways/${way}/files/${name(file)}?n=${number}`,
  clipFrame: (project: string, clip: string, own: boolean): string => `${at(project)}/clips/frame?clip=${name(clip)}&own=${own ? 1 : 0}`,
  still: (project: string, still: string): string => `${at(project)}/stills/${name(still)}`, // small
  wholeStill: (project: string, still: string): string => `${at(project)}/stills/${name(still)}?whole=1`,
  layerMatte: (project: string, layer: number, version: number): string => `${at(project)}/layers/${layer}/matte?v=${version}`,
  credits: (project: string): string => `${at(project)}/credits`,
};

export const home = (): Promise<Home> => get("api/home");
export const jobs = (): Promise<Job[]> => get("api/jobs");
export const project = (id: string): Promise<Project> => get(at(id));
export const field = (id: string): Promise<Field | null> => get(`${at(id)}/field`);
export const pieces = (id: string): Promise<Pieces> => get(`${at(id)}/pieces`);
/** Of each frame that is there, closed lines of x0, y0, x1, y1, .. px of the reel. */
export const outlines = (id: string, reel: number): Promise<number[][][]> => get(`${at(id)}/reels/${reel}/outlines`);
/** What looks as if it stood in the fluid: outlines of x0, y0, x1, y1, .. px of the picture, the largest first. */
export const standing = (id: string): Promise<number[][]> => get(`${at(id)}/standing`);
/** What a click takes where these marks are held: size times what it takes by itself. holds   or it is let go. */
export const lying = (id: string, [x, y]: Point, size: number, held: Drawn[]): Promise<{ holds: boolean; outlines: number[][] }> =>
  post(`${at(id)}/standing`, { x: Math.floor(x), y: Math.floor(y), size, held });
export const candidates = (id: string, piece: number): Promise<Candidates> => get(`${at(id)}/pieces/${piece}`);
export const credits = async (id: string): Promise<string> => (await ask(address.credits(id))).text();

export async function openPicture(file: File): Promise<string> {
  const answer = await ask(`api/projects?name=${name(file.name)}`, { method: "POST", body: file });
  return ((await answer.json()) as { id: string }).id;
}

export async function openStore(file: File): Promise<void> {
  await ask(`api/stores/file?name=${name(file.name)}`, { method: "POST", body: file });
}

/** A project that begins with a clip, or with its first frame as the picture. */
export async function openClip(file: File, as: "clip" | "picture" = "clip"): Promise<string> {
  const answer = await ask(`api/clips?as=${as}&name=${name(file.name)}`, { method: "POST", body: file });
  return ((await answer.json()) as { id: string }).id;
}

/** A project of a store's clip, which goes on without an end, or whose frames are a scene's stills. */
export const openStoredClip = async (store: string, clip: number, as: "clip" | "stills"): Promise<string> =>
  (await post<{ id: string }>(`api/stores/${name(store)}/clips/${clip}/projects?as=${as}`, {})).id;

export const renameProject = async (id: string, title: string): Promise<string> => (await post<{ id: string }>(`${at(id)}/name`, { name: title })).id;
/** longest   px that the copy's picture is reduced to. */
export const copyProject = async (id: string, longest?: number): Promise<string> =>
  (await post<{ id: string }>(`${at(id)}/copies${longest ? `?longest=${longest}` : ""}`, {})).id;

export const takes = (id: string): Promise<Takes | null> => get(`${at(id)}/takes`);
/** from   the frame that is on the screen. */
export const showLayers = (id: string, from: number): Promise<{ job: number }> => post(`${at(id)}/layers?from=${from}`, {});
export const findTakes = (id: string): Promise<{ job: number }> => post(`${at(id)}/takes`, {});

export async function removeProject(id: string): Promise<void> {
  await ask(at(id), { method: "DELETE" });
}

export async function giveMatte(id: string, file: File): Promise<void> {
  await ask(`${at(id)}/matte?name=${name(file.name)}`, { method: "POST", body: file });
}

export type Saved =
  | { taken: true; version: number; job: number }
  | { taken: false; version: number; document: Document };

/** keepalive   it arrives though the page is being closed; the browser takes 64 KB so. */
export async function save(id: string, document: Document, base: number, page: string, keepalive = false): Promise<Saved> {
  const answer = await ask(`${at(id)}/document?base=${base}&page=${page}`, {
    method: "PUT",
    body: JSON.stringify(document),
    keepalive,
  });
  const json = (await answer.json()) as { version: number; document: Document; job: number };
  return answer.status === 409 ? { taken: false, ...json } : { taken: true, ...json };
}

export const way = (id: string, name: string): Promise<Way> => get(`${at(id)}/ways/${name}`);
export const runWay = (id: string, name: string): Promise<{ job: number }> => post(`${at(id)}/ways/${name}`, {});

/** As SVG. */
export const foundLines = async (id: string, file: string, number: string): Promise<string> => (await ask(address.wayFile(id, "lines", file, number))).text();
export const clips = (id: string): Promise<string[]> => get(`${at(id)}/clips`);
export async function sendOwnClip(id: string, file: File): Promise<string> {
  const answer = await ask(`${at(id)}/clips?name=${name(file.name)}`, { method: "POST", body: file });
  return ((await answer.json()) as { name: string }).name;
}

export const stills = (id: string): Promise<string[]> => get(`${at(id)}/stills`);
export async function sendStill(id: string, file: File): Promise<void> {
  await ask(`${at(id)}/stills?name=${name(file.name)}`, { method: "POST", body: file });
}
export async function removeStills(id: string): Promise<void> {
  await ask(`${at(id)}/stills`, { method: "DELETE" });
}

export const history = (id: string): Promise<Kept | null> => get(`${at(id)}/history`);
export async function keepHistory(id: string, text: string, keepalive: boolean): Promise<void> {
  await ask(`${at(id)}/history`, { method: "PUT", body: text, keepalive });
}

export interface ExportRequest {
  name: string;
  layer?: string;
  preset?: string;
  depth?: string;
  range?: string;
  width?: string;
  "start-number"?: string;
}
export const startExport = (
  id: string,
  request: ExportRequest,
): Promise<{ job: number; folder: string; command: string }> => post(`${at(id)}/exports`, request);

/** The film of a way, made again as a file of this name. */
/** alone   the fluid with alpha, or the layers, in place of the film. */
export const exportWay = (id: string, way: string, file: string, alone: boolean): Promise<{ job: number; folder: string; command: string }> =>
  post(`${at(id)}/ways/${way}/exports`, { name: file, alone });

export const newStore = (title: string): Promise<{ id: string }> => post("api/stores", { name: title });
export async function sendClip(store: string, kind: string, file: File): Promise<void> {
  await ask(`api/stores/${name(store)}/clips?class=${name(kind)}&name=${name(file.name)}`, {
    method: "POST",
    body: file,
  });
}
export const ingest = (store: string, licence: string): Promise<{ job: number }> =>
  post(`api/stores/${name(store)}/ingest`, { licence });

export async function stopJob(lane: string, id: number): Promise<void> {
  await ask(`api/jobs/${lane}/${id}`, { method: "DELETE" });
}

export type Listener = (type: string, data: unknown) => void;

/** Hears what happens, and goes on after interruptions. Returns how to end it. */
export function listen(after: number, listener: Listener, connected: (yes: boolean) => void): () => void {
  const source = new EventSource(`api/events?after=${after}`);
  for (const type of ["job", "gap", "document", "matte", "field", "labels", "takes", "reel", "layers", "settled", "problem", "export", "way", "ingested"])
    source.addEventListener(type, (event) => listener(type, JSON.parse((event as MessageEvent<string>).data)));
  source.onopen = () => connected(true);
  source.onerror = () => connected(false);
  return () => source.close();
}

/** pictures   of a sequence, which is a folder; 0: it is a file. */
export interface Exported {
  name: string;
  bytes: number;
  pictures: number;
}
export const exports = (id: string): Promise<{ folder: string; files: Exported[] }> => get(`${at(id)}/exports`);
