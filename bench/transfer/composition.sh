#!/bin/sh
# Several fluids over one picture (Jamriska et al. 2015, Fig. 12): each a design in the look of an exemplar, laid over
# what the one before left.
#
#   bench/transfer/composition.sh PICTURE FOLDER FRAMES SIZE EXEMPLAR GROUND DESIGN X,Y [EXEMPLAR GROUND DESIGN X,Y ...]
#
# SIZE of a design (640x360), GROUND as synth transfer has it, X,Y where its top left corner lies in the picture, px.
# FOLDER/1, 2, ... are the compositions so far, the last with all fluids. It prints seconds a frame, and of how many
# frames the patches were used uniformly. FRESHET names the program: build/release/tools/freshet.
set -eu
[ $# -ge 8 ] || { sed -n '2,9s/^# \{0,1\}//p' "$0"; exit 2; }
under=$1 out=$2 frames=$3 size=$4
shift 4
freshet=${FRESHET:-build/release/tools/freshet}
fluid=0
echo "| exemplar | design | s a frame | uniform frames |"
echo "| --- | --- | --: | --: |"
while [ $# -ge 4 ]; do
  fluid=$((fluid + 1))
  mkdir -p "$out/$fluid"
  "$freshet" synth simulate "$3" --size "$size" --frames "$frames" -o "$out/$fluid-design" --overwrite >/dev/null
  "$freshet" synth transfer --design "$out/$fluid-design" --exemplar "$1" --ground "$2" --over "$under" --at "$4" \
    --composite "$out/$fluid/%03d.png" -o "$out/$fluid-film.mkv" --frames "$frames" --overwrite >/dev/null \
    2>"$out/$fluid.txt" || { cat "$out/$fluid.txt" >&2; exit 1; }
  sed -n 's/.* frames of .* in \([0-9.]*\) s .* uniformly in \([0-9]*\) frames.*/\1 \2/p' "$out/$fluid.txt" |
    awk -v exemplar="$(basename "$1")" -v design="$3" -v frames="$frames" \
      '{ printf "| %s | %s | %.2f | %d |\n", exemplar, design, $1 / frames, $2 }'
  under=$out/$fluid/%03d.png
  shift 4
done
