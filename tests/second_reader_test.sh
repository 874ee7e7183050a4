#!/bin/sh
# The reader in contrib/, which was written from docs/format.md, gives the frames and the digest that the engine gives;
# and none of a store that is damaged. Skipped, loudly, without python3-xxhash and python3-zstandard.
# usage: tests/second_reader_test.sh ROOT FRESHET
set -eu
reader=$1/contrib/freshet_store.py freshet=$2 python=/usr/bin/python3
if ! "$python" -c 'import xxhash, zstandard' 2> /dev/null; then
  echo "SKIPPED: the second reader is not tried: install python3-xxhash and python3-zstandard" >&2
  exit 77
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

# Clips of one plane and of three, of 8 and of 10 bits, with sizes that are no multiples of a tile's.
"$freshet" synth simulate river --size 70x50 --frames 18 --seed 1 -o a.mkv > log 2>&1
"$freshet" synth simulate river --size 100x67 --frames 17 --seed 2 -o river.mkv > log 2>&1
ffmpeg -v error -i river.mkv -pix_fmt yuv420p10le -c:v ffv1 b.mkv
ffmpeg -v error -i a.mkv -pix_fmt gray -c:v ffv1 c.mkv

same_digest() {
  engine=$("$freshet" store digest "$1") second=$("$python" "$reader" digest "$1")
  [ "$engine" = "$second" ] || { echo "$1: $engine, and by the second reader $second"; exit 1; }
}

"$freshet" ingest s.store --force --no-index a.mkv b.mkv c.mkv > log 2>&1
same_digest s.store
for clip in a.mkv b.mkv c.mkv; do
  "$freshet" store framemd5 s.store $clip | grep -v '^#' | sed 's/.*[ ,]//' > engine
  "$python" "$reader" framemd5 s.store $clip > second
  diff engine second
done
"$freshet" index s.store > log 2>&1
same_digest s.store
"$freshet" store compact s.store > log 2>&1
same_digest s.store
"$python" "$reader" info s.store > info
grep -q '"patch.words"' info

# More words than a byte can number: two bytes each, through all that is done with a store.
bytes_of() { "$python" "$reader" column "$1" a.mkv "$2" | wc -c; }
ffmpeg -v error -i river.mkv -frames:v 1 still.png
"$freshet" ingest w.store --force --words 500 a.mkv > log 2>&1
"$freshet" ingest x.store --force --words 500 --no-index b.mkv > log 2>&1
[ "$(bytes_of w.store patch.words)" = $((81 * $(bytes_of w.store patch.x))) ] # two bytes a patch, as words have
"$freshet" store merge w.store x.store -o m.store > log 2>&1
"$freshet" index m.store > log 2>&1
same_digest m.store
digest=$("$freshet" store digest m.store)
candidates() { "$freshet" query candidates "$1" still.png --frames 10 --json 2> log | sed 's/"seconds".*//'; }
candidates m.store > before
"$freshet" store verify m.store > log 2>&1
"$freshet" store compact m.store > log 2>&1
"$freshet" store repair m.store -o r.store > log 2>&1
"$freshet" index r.store --rebuild > log 2>&1
for store in m.store r.store; do
  [ "$("$freshet" store digest $store)" = "$digest" ] || { echo "$store is another than it was"; exit 1; }
  candidates $store > after
  cmp before after
done
same_digest r.store

# Damage: the engine's digest, or none.
whole=$("$freshet" store digest s.store)
"$python" - s.store << 'END' > places
import os, random, sys
random.seed(5)
for _ in range(6):
    print(random.randrange(8192, os.path.getsize(sys.argv[1])))
END
seen=0
while read -r at; do
  "$python" - s.store "$at" << 'END'
import sys
data = bytearray(open(sys.argv[1], "rb").read())
data[int(sys.argv[2])] ^= 16
open("d.store", "wb").write(data)
END
  if digest=$("$python" "$reader" digest d.store 2> fault); then
    [ "$digest" = "$whole" ] || { echo "byte $at turned: digest $digest, expected $whole"; exit 1; }
  else
    seen=$((seen + 1))
    grep -q '^d.store: ' fault || { echo "byte $at turned:"; cat fault; exit 1; }
  fi
done < places
[ $seen -ge 3 ] || { echo "of 6 damages only $seen were seen"; exit 1; }
