#!/bin/sh
# The main job, end to end, from nothing but a checkout on Debian 12.
#
#   ./demo.sh                                    a simulated still, animated with the starter store of simulated clips
#   ./demo.sh PICTURE [MATTE]                    your own picture, with the starter store;
#                                                MATTE is grey, white where the fluid is
#   ./demo.sh CLIPS_FOLDER PICTURE [MATTE]       with your own clips too (folders in it name the classes)
#   ./demo.sh --studio [STORE] [PICTURE]         opens the studio in the browser
#
# Everything that it makes lies in demo/ (or $FRESHET_DEMO). What is there already is used again.
set -eu
clips= picture= matte= studio=
if [ "${1:-}" = --studio ]; then
  studio=yes
  shift
elif [ $# -gt 0 ]; then
  if [ -d "$1" ] && [ $# -ge 2 ]; then
    clips=$(realpath -e "$1")
    shift
  fi
  if [ $# -gt 2 ]; then
    sed -n '2,12p' "$0" | sed 's/^# \{0,1\}//' >&2
    exit 2
  fi
  picture=$(realpath -e "$1") || { echo "demo.sh: $1: no such picture" >&2; exit 1; }
  if [ $# -eq 2 ]; then
    matte=$(realpath -e "$2") || { echo "demo.sh: $2: no such matte" >&2; exit 1; }
  fi
fi
here=$PWD
cd "$(dirname "$0")"
if [ -n "$studio" ]; then
  cmake/prepare.sh --for build,page release freshet studio_page
else
  cmake/prepare.sh --for build release freshet
fi
freshet=$PWD/build/release/tools/freshet
out=${FRESHET_DEMO:-$PWD/demo}
mkdir -p "$out"
if [ -n "$studio" ] && [ $# -gt 0 ]; then
  cd "$here"
  exec "$freshet" studio "$@"
fi

set --
if [ -z "$picture" ]; then
  # One frame of a simulated waterfall, and the part of it that moves.
  picture=$out/still.png
  matte=$out/still_matte.png
  [ -s "$matte" ] ||
    "$freshet" synth simulate waterfall --size 640x360 --frames 1 --seed 12 --overwrite -o "$picture" --alpha "$matte"
  set -- --class water --direction down
fi
name=$(basename "$picture" | sed 's/\.[^.]*$//')
if [ -n "$clips" ]; then
  store=$out/$(basename "$clips").freshet
  name=$(basename "$clips")-$name
  "$freshet" ingest "$store" "$clips"
else
  store=$out/starter.freshet
  [ -s "$store" ] || "$freshet" store starter -o "$store"
fi
[ -z "$studio" ] || exec "$freshet" studio "$store" "$picture"
"$freshet" query candidates "$store" "$picture" ${matte:+--matte "$matte"} "$@" --overwrite \
  --sheet "$out/$name-candidates.png"
"$freshet" query label "$store" "$picture" ${matte:+--matte "$matte"} "$@" \
  --overwrite -o "$out/$name-assignment.json" --map "$out/$name-labels.png"
[ -n "$matte" ] && set -- --matte "$matte" || set -- --whole
"$freshet" synth animate "$store" "$picture" "$@" --assignment "$out/$name-assignment.json" \
  --overwrite -o "$out/$name.mp4"

cat <<END

The store:              $store
Candidates (sheet):     $out/$name-candidates.png
Labels by clip (map):   $out/$name-labels.png
Assignment:             $out/$name-assignment.json
Animation:              $out/$name.mp4
END
