#!/bin/sh
# Fails when README.md, a document or a comment names a file, folder, command, option or bench that does not exist, when
# docs/architecture.md leaves out a folder, and when docs/terms.md explains what nothing uses, or too much.
# usage: tests/docs_test.sh ROOT
set -eu
export LC_ALL=C
cd "$1"
engine=$(sed -n 's/^rooms="\(.*\)"$/\1/p' tests/arrows_test.sh)
[ -n "$engine" ]
rooms="$engine tests bench docs cmake contrib"
documents="README.md $(find docs -name '*.md' | sort)"
sources=$(find $engine tests bench -name '*.h' -o -name '*.cc' -o -name '*.sh' -o -name 'CMakeLists.txt')
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
missing=$scratch/missing
: > "$missing"
cat $(find tools -name '*.cc') > "$scratch/tools"
# A setting of a method is an option too (tools/options/method_options.h).
grep -oE '"[a-z][a-z-]+"' synth/animate/method_settings.cc | sed 's/"/"--/' >> "$scratch/tools"
any=$(echo $rooms | tr ' ' '|')
path="($any)/[A-Za-z0-9_./*-]*"

# Links, relative to the document that holds them.
for document in $documents; do
  awk '/^```/ { code = !code } !code' "$document" | grep -oE '\]\([^)]+\)' | sed -E 's/^\]\(//; s/\)$//; s/#.*$//' | grep -vE '^(https?:|$)' |
    while read -r target; do
      [ -e "$(dirname "$document")/$target" ] || echo "$document: a link to $target"
    done || true
done >> "$missing"

# Paths from the root of the tree: in a document anywhere, in sources where they end like a file.
{
  grep -oE "(^|[^A-Za-z0-9_./-])$path" $documents || true
  grep -HE '(//|^ *#)' $sources | grep -v '#include' | grep -oE "^[^:]*:|(^|[^A-Za-z0-9_./-])$path\.(h|cc|md|sh|html|txt)" |
    awk '/^[^ ]*:$/ { file = $0; next } { print file $0 }'
} | sed -E "s|^([^:]*):[^A-Za-z]*|\1 |" | sort -u | while read -r document name; do
  while case $name in *[./*-]) ;; *) false ;; esac; do name=${name%?}; done
  for found in "$name"*; do [ -e "$found" ] || echo "$document: $name"; break; done
done >> "$missing"

# Files that a document names without their folder.
grep -oE '`[a-z0-9_]+\.(h|cc|sh|cmake)`' $documents | tr -d '`' | sort -u | tr ':' ' ' | while read -r document name; do
  find . -path ./build -prune -o -name "$name" -print | grep -q . || echo "$document: $name"
done >> "$missing"

# The architecture has a line for every folder of the engine.
find $engine -name '*.h' | sed 's|/[^/]*$||' | sort -u |
  while read -r folder; do
  grep -q "\`$folder/\`" docs/architecture.md || echo "docs/architecture.md: a line for $folder/"
done >> "$missing"

# Commands: freshet A, or freshet A B where A has commands below it.
commands=$(grep -oE 'add(_subcommand)?\("[a-z0-9]+"' "$scratch/tools" | grep -oE '[a-z0-9]+"' | tr -d '"'
           grep -A1 -E 'add(_subcommand)?\($' "$scratch/tools" | grep -oE '^ *"[a-z0-9]+",' | tr -d ' ",')
grep -oE '(^|[`(" ])freshet (store|query|synth) [a-z|\\0-9]+|(^|`)freshet [a-z]+' $documents |
  sed -E 's/^([^:]*):.*freshet /\1 /' | sort -u | while read -r document words; do
  for word in $(echo "$words" | tr '|\\' '  '); do
    echo "$commands" | grep -qx "$word" || echo "$document: the command freshet $words"
  done
done >> "$missing"

# Options of these commands, where a document is about nothing else.
grep -vE 'cmake|ffmpeg|ctest|demo\.sh' README.md docs/manual.md docs/benchmark.md | sed -E 's/^([^:]*):/\1 /' |
  grep -oE '^[^ ]+|[^a-z-]--[a-z][a-z-]+' | awk '!/--/ { file = $0; next } { sub(/^[^-]/, ""); print file, $0 }' |
  sort -u > "$scratch/options"
grep -oE -- '--[a-z][a-z-]+([",]|$)' "$scratch/tools" | tr -d '",' | sort -u > "$scratch/known"
awk 'NR == FNR { known[$0]; next } !($2 in known) { print $1 ": the option " $2 }' "$scratch/known" "$scratch/options" >> "$missing"

# A glossary of at most 80 entries, each of which something else uses, as one word or with - or _ in it.
entries=$(grep -c '^| \*\*' docs/terms.md)
[ "$entries" -le 80 ] || echo "docs/terms.md: of its $entries entries each beyond 80" >> "$missing"
cat $(echo "$documents" | tr ' ' '\n' | grep -v terms.md) $sources $(find studio/page -name '*.ts*') | tr 'A-Z' 'a-z' |
  tr -cs 'a-z0-9' ' ' > "$scratch/words"
grep '^| \*\*' docs/terms.md | grep -oE '\*\*[^*]+\*\*' | tr -d '*' | tr 'A-Z-' 'a-z ' |
  awk 'NR == FNR { words = words $0 " "; next }
       !index(words, " " $0 " ") && !index(words, " " $0 "s ") && !index(words, " " $0 "es ") {
         print "docs/terms.md: a use of \"" $0 "\""
       }' "$scratch/words" - >> "$missing"

# Benches.
grep -oE 'bench_[a-z_]+' $documents | sort -u | tr ':' ' ' | while read -r document bench; do
  grep -q "add_executable($bench " bench/CMakeLists.txt || echo "$document: $bench"
done >> "$missing"

sed 's/$/, which does not exist/' "$missing"
[ ! -s "$missing" ]
