#!/bin/sh
# A page on which people judge films without knowing whose they are (bench_blind_look): four pictures of which other
# methods' results exist, ours with the strokes of bench/quality/peers, and stills of real clips, ours (the clip itself
# left out) beside what was filmed and the still carried along its true motion.
#
#   bench/quality/blind_page.sh FOOTAGE STORE OUT [CLIPS]
#
# STORE is of all clips of FOOTAGE/clips and indexed; CLIPS a list as bench_quality --clips takes it. The page is
# OUT/page, its key OUT/page-key.json. It holds footage: do not share it beyond those whom you ask. FRESHET and BENCH
# name the program and the folder of the benches: build/release/tools/freshet, build/release/bench.
set -eu
[ $# -ge 3 ] || { sed -n '2,10s/^# \{0,1\}//p' "$0"; exit 2; }
footage=$1 store=$2 out=$3
clips=${4:-rapids,waterfall_dusk,brook_mossy,flames_wall,campfire,chimney,smoke_puffs,cumulus}
drawn=$(dirname "$0")/peers
freshet=${FRESHET:-build/release/tools/freshet} bench=${BENCH:-build/release/bench}
mkdir -p "$out"

set --
for peer in river:00981_00048 cove:00982_03204 turquoise:00987_00156 beach:00994_00000; do
  scene=${peer%%:*} folder=$footage/peers/${peer#*:}
  # What is no water is grey in these mattes.
  convert "$folder/mask.jpg" -colorspace gray -level 60%,90% "$out/${scene}_matte.png"
  # As long as the others' films, which are of 61 or 62 frames at 30 a second.
  "$freshet" synth animate "$store" "$folder/input.jpg" --matte "$out/${scene}_matte.png" --class water \
    --strokes "$drawn/$scene.svg" --frames 61 --fps 30 -o "$out/$scene.mp4" --overwrite >/dev/null
  set -- "$@" --film "$scene:ours=$out/$scene.mp4"
  for film in "$folder"/result_*.mp4; do
    method=${film##*/result_}
    set -- "$@" --film "$scene:${method%.mp4}=$film"
  done
done

"$bench/bench_quality" "$store" --clips "$clips" --hints strokes+speed --methods ours,eulerian-varying --set same-class=1 \
  --frames 60 --films "$out/clips"
for folder in "$out"/clips/*/; do
  scene=$(basename "$folder")
  for film in "$folder"*.mp4; do set -- "$@" --film "$scene:$(basename "$film" .mp4)=$film"; done
done
"$bench/bench_blind_look" "$out/page" "$@"
