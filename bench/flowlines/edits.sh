#!/bin/sh
# Five edits after Bhat et al. 2004, drawn by hand on clips of 640 px (bench/flowlines/edits/), and how well their fluid
# follows the lines.
#
#   bench/flowlines/edits.sh FOOTAGE OUT [EDIT..]     channels, foam, trunk, chimneys, wind; all where none is named
#
# FRESHET and FOLLOWED name the programs: build/release/tools/freshet, build/release/bench/bench_followed. The edited
# films are written to OUT as pictures.
set -eu
[ $# -ge 2 ] || { sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 2; }
footage=$1 out=$2
shift 2
drawn=$(dirname "$0")/edits
freshet=${FRESHET:-build/release/tools/freshet} followed=${FOLLOWED:-build/release/bench/bench_followed}
mkdir -p "$out"

# edit NAME CLIP SECONDS LINES OPTIONS.. ; the film is as long as the clip's part
edit() {
  name=$1 source=$2 seconds=$3 lines=$4
  shift 4
  clip=$out/$name.mkv
  ffmpeg -v error -y -i "$footage/clips/$source" -t "$seconds" -vf scale=640:-2 -c:v libx264 -crf 8 "$clip"
  "$freshet" synth flowlines "$clip" --lines "$drawn/$lines.svg" --edited "$drawn/$name.svg" --frames $((30 * seconds)) \
    -o "$out/$name/%03d.png" --draw "$out/$name.png" --overwrite "$@" >/dev/null
  case "$*" in *stretched*) set -- --correspondence stretched ;; *) set -- ;; esac
  "$followed" "$out/$name/%03d.png" "$clip" --lines "$drawn/$lines.svg" --edited "$drawn/$name.svg" "$@"
}

# chimneys_behind FILE: what stands behind the plumes: the empty right half of the clip, mirrored, and three chimneys.
chimneys_behind() {
  ffmpeg -v error -y -i "$footage/clips/smoke/chimney_plume_grey.mp4" -frames:v 1 -filter_complex "scale=640:-2,
    split=2[a][b];[a]crop=320:360:320:0,split=2[right][r];[r]hflip[left];[left][right]hstack[empty];
    [b]crop=36:54:180:306,split=3[i][j][k];[empty][i]overlay=180:306[one];[one][j]overlay=330:306[two];
    [two][k]overlay=480:306" "$1"
}

[ $# -gt 0 ] || set -- channels foam trunk chimneys wind
for name in "$@"; do
  case $name in
    channels) edit channels water/waterfall_dusk_pool.mp4 4 fall_lines ;;
    foam) edit foam water/brook_mossy_rocks.mp4 4 foam_lines ;;
    trunk) edit trunk water/brook_mossy_rocks.mp4 4 brook_lines ;;
    chimneys)
      chimneys_behind "$out/chimneys_behind.png"
      edit chimneys smoke/chimney_plume_grey.mp4 8 plume_lines --patch 80 --background "$out/chimneys_behind.png" \
        --on-background --correspondence stretched
      ;;
    wind) edit wind fire/flames_wall_black.mp4 4 flame_lines --ground black --patch 200 --moving-camera ;;
    *) echo "no edit is called $name" >&2; exit 2 ;;
  esac
done
