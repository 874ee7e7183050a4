#!/bin/sh
# Builds the studio's page: checks its types, and leaves its files in a folder. Needs node, npm, and once the registry.
# usage: studio/page/build.sh SCRATCH OUT
set -eu
source=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
scratch=$(cd "$1" && pwd)
mkdir -p "$2"
out=$(cd "$2" && pwd)

# Everything in the build's own folder: the source tree stays as it is.
cp "$source/package.json" "$source/package-lock.json" "$source/tsconfig.json" "$source/build.mjs" "$scratch/"
rm -rf "$scratch/src"
cp -R "$source/src" "$scratch/src"
cd "$scratch"
if ! cmp -s package-lock.json installed.json; then
  npm ci --no-audit --no-fund --loglevel=error
  cp package-lock.json installed.json
fi
node node_modules/typescript/bin/tsc --noEmit
EXAMPLES="$source/../../docs/pictures" node build.mjs "$out"
