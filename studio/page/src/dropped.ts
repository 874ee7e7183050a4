// What is dropped on the first page: pictures, clips, a store, a project's folder.
import * as api from "./api";
import * as state from "./state";
import type { Document } from "./types";

export interface Dropped {
  path: string; // from what was dropped: "fall/document.json"
  file: File;
}

const kMostFiles = 500;

/** What was chosen; of a folder, with its files' paths. */
export const chosen = (files: FileList | null): Dropped[] => [...(files ?? [])].map((file) => ({ path: file.webkitRelativePath || file.name, file }));

/** Folders are gone through. */
export async function dropped(transfer: DataTransfer | null): Promise<Dropped[]> {
  const entries = [...(transfer?.items ?? [])].map((item) => item.webkitGetAsEntry());
  const files = chosen(transfer?.files ?? null); // gone when the event is over
  const found: Dropped[] = [];
  for (const entry of entries) if (entry) await walk(entry, "", found);
  return found.length > 0 ? found : files;
}

async function walk(entry: FileSystemEntry, above: string, found: Dropped[]): Promise<void> {
  if (entry.name.startsWith(".") || entry.name === "Thumbs.db") return;
  if (entry.isDirectory && entry.name === "exports") return; // of a project: what can be made again
  if (found.length >= kMostFiles) throw new Error(`There are more than ${kMostFiles} files in it.`);
  const path = above + entry.name;
  if (entry.isFile) {
    found.push({ path, file: await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject)) });
    return;
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  for (;;) {
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return;
    for (const each of some) await walk(each, `${path}/`, found);
  }
}

export const isStore = ({ file }: Dropped): boolean => file.name.endsWith(".freshet");

/** The folder of a project among them, with what lies in it; null: there is none. */
export function projectAmong(all: Dropped[]): { name: string; files: Map<string, File> } | null {
  const document = all.find(({ path }) => /(^|\/)document\.json$/.test(path));
  if (!document) return null;
  const folder = document.path.slice(0, -"document.json".length);
  const name = folder.split("/").filter(Boolean).at(-1) ?? "project";
  const within = all.filter(({ path }) => path.startsWith(folder));
  return { name, files: new Map(within.map(({ path, file }) => [path.slice(folder.length), file])) };
}

/** Takes a copy of a project: its picture, all that was drawn, and what was given to it. Returns its id here; one of this
 *  name and picture that is here already stays as it is. */
export async function openProject(name: string, files: Map<string, File>): Promise<string> {
  const picture = [...files].find(([path]) => /^picture\.[a-z]+$/.test(path))?.[1];
  const text = await files.get("document.json")?.text();
  if (!picture || !text) throw new Error(`${name}: a project has picture.* and document.json`);
  const before = (await api.home()).projects;
  const id = await api.openPicture(new File([picture], name + picture.name.slice("picture".length)));
  if (before.some((each) => each.id === id)) {
    state.toast.value = `${name} is here already: it was opened as it is here.`;
    return id;
  }
  try {
    await fill(id, text, files);
  } catch (fault) {
    await api.removeProject(id); // half of one would be taken for the whole the next time
    throw fault;
  }
  return id;
}

async function fill(id: string, text: string, files: Map<string, File>): Promise<void> {
  const matte = files.get("given_matte.png");
  if (matte) await api.giveMatte(id, matte);
  for (const [path, file] of files) {
    if (path.startsWith("ways/stills/pictures/")) await api.sendStill(id, file);
    if (path.startsWith("ways/flowlines/clips/")) await api.sendOwnClip(id, file);
  }
  const [opened, home] = await Promise.all([api.project(id), api.home()]);
  const document = JSON.parse(text) as Document;
  // A store that is not open here cannot be named.
  if (!home.stores.some(({ path }) => path === document.store)) document.store = opened.document.store;
  const saved = await api.save(id, document, opened.version, "opening");
  if (!saved.taken) throw new Error("Another window is at this project.");
}
