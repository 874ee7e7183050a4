#!/bin/sh
# The main job, end to end, from nothing but a checkout on Debian 12.
#
#   ./demo.sh                                    with clips that Freshet simulates itself
#   ./demo.sh CLIPS_FOLDER PICTURE [MATTE]       with your own clips (folders in it name the classes) and picture;
#                                                MATTE is grey, white where the fluid is
#   ./demo.sh --studio [STORE] [PICTURE]         opens the studio in the browser: with the simulated clips, or your own
#
# Everything that it makes lies in demo/ (or $FRESHET_DEMO). What is there already is used again.
set -eu
clips= picture= matte= studio=
if [ "${1:-}" = --studio ]; then
  studio=yes
  shift
elif [ $# -gt 0 ]; then
  if [ $# -lt 2 ] || [ $# -gt 3 ]; then
    sed -n '2,10p' "$0" | sed 's/^# \{0,1\}//' >&2
    exit 2
  fi
  clips=$(realpath -e "$1") || { echo "demo.sh: $1: no such folder" >&2; exit 1; }
  picture=$(realpath -e "$2") || { echo "demo.sh: $2: no such picture" >&2; exit 1; }
  if [ $# -eq 3 ]; then
    matte=$(realpath -e "$3") || { echo "demo.sh: $3: no such matte" >&2; exit 1; }
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

if [ -z "$clips" ]; then
  # A small database of our own: several clips of each kind of fluid, each from its own seed.
  clips=$out/clips
  for kind in waterfall river fire smoke; do
    mkdir -p "$clips/$kind"
    for seed in 1 2 3; do
      [ -s "$clips/$kind/$seed.mkv" ] ||
        "$freshet" synth simulate $kind --size 480x270 --frames 100 --seed $seed --overwrite -o "$clips/$kind/$seed.mkv"
    done
  done
  # The still: one frame of a waterfall that is not in the database, and the part of it that moves.
  picture=$out/still.png
  matte=$out/still_matte.png
  [ -s "$matte" ] ||
    "$freshet" synth simulate waterfall --size 640x360 --frames 1 --seed 12 --overwrite -o "$picture" --alpha "$matte"
  name=simulated
  set -- --class waterfall --direction down
else
  name=$(basename "$clips")-$(basename "$picture" | sed 's/\.[^.]*$//')
  set --
fi
store=$out/$(basename "$clips").freshet

"$freshet" ingest "$store" "$clips"
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
