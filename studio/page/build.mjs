// Builds the page into a folder: node build.mjs [FOLDER]
import { build } from "esbuild";
import { cp, mkdir, rm } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "dist");
await rm(out, { recursive: true, force: true });
await mkdir(out, { recursive: true });
await build({
  absWorkingDir: here,
  entryPoints: { studio: "src/main.tsx" },
  outdir: out,
  bundle: true,
  minify: true,
  format: "esm",
  target: ["chrome109", "firefox115", "safari16"],
  jsx: "automatic",
  jsxImportSource: "preact",
  loader: { ".woff2": "file", ".svg": "file" },
  assetNames: "[name]-[hash]",
  legalComments: "linked",
  logLevel: "warning",
});
await cp(join(here, "src/index.html"), join(out, "index.html"));
for (const name of ["icon.svg", "icon-192.png", "icon-512.png", "freshet.webmanifest"]) await cp(join(here, "src", name), join(out, name));
// An example of our own, which needs no file at hand (docs/pictures.md). EXAMPLES: where docs/pictures lies.
const examples = process.env.EXAMPLES ?? join(here, "../../docs/pictures");
for (const name of [".jpg", ".webp", "_matte.png", "_flow.svg"]) await cp(join(examples, `bay_evening${name}`), join(out, `example${name}`));
