#!/bin/sh
# A real browser goes through the studio: builds the page, and runs browser_test.mjs with Debian's Chromium, and what
# measures its times, small; or in Debian's Firefox some of it (FRESHET_BROWSERS).
# usage: tests/studio/browser_test.sh FRESHET PAGE_SCRATCH PAGE [firefox NAMES]
# NAMES   of tests, a regular expression; those that are left out by FRESHET_BROWSERS stay out
# Ends with 77, and says so, where there is no browser or node, or the npm registry cannot be reached.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
skip() {
  echo "SKIPPED: the studio was not tried in a browser: $*" >&2
  exit 77
}
browser=${4:-chromium}
for program in node npm "$browser"; do
  command -v "$program" > /dev/null || skip "$program is not installed"
done
if ! cmp -s "$here/../../studio/page/package-lock.json" "$2/installed.json"; then
  npm ping --loglevel=error > /dev/null 2>&1 || skip "the npm registry cannot be reached"
fi
"$here/../../studio/page/build.sh" "$2" "$3"

# What the page takes a document for (types.ts) is what the server writes (document_test.cc): no field more or less.
scratch=$2/types
mkdir -p "$scratch"
cp "$here/../../studio/page/src/types.ts" "$scratch/"
{
  echo 'import type { Document } from "./types";'
  printf 'export const document: Document = '
  cat "$here/drawing/document.json"
  echo ';'
} > "$scratch/document.ts"
node "$2/node_modules/typescript/bin/tsc" --noEmit --strict --target es2022 --module esnext --moduleResolution bundler \
  "$scratch/document.ts"

export FRESHET="$1" PAGE="$3" MODULES="$2/node_modules" BROWSER="$browser"
node --test --test-reporter=spec --test-name-pattern="${5:-.}" "$here/browser_test.mjs"
[ "$browser" = chromium ] || exit 0

times=$(mktemp -d)
trap 'rm -rf "$times"' EXIT
cd "$times"
mkdir -p clips/fall
"$1" synth simulate waterfall --size 192x144 --frames 40 --seed 1 -o clips/fall/1.mkv
"$1" ingest times.store clips
"$1" synth simulate waterfall --size 320x200 --frames 1 --seed 12 -o still.png --alpha matte.png
node "$here/../../bench/studio/browser_times.mjs" times.store still.png matte.png fall --times 1
