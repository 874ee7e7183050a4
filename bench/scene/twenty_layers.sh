#!/bin/bash
# A drawn harbour of twenty layers for freshet synth scene: still.png, a matte for each layer, and scene.toml.
#
#   bench/scene/twenty_layers.sh FOLDER      with freshet and ImageMagick's convert on the path
set -euo pipefail
cd "$1"
w=900 h=675 shore=380

freshet synth simulate clouds --size ${w}x${shore} --frames 1 --seed 21 -o sky.png --overwrite
toml=scene.toml
cat > $toml <<END
picture = "still.png"
frames = 100
fps = 25
loop = true
[wind]
speed = 6
direction = 10
gustiness = 0.5
END

# layer NAME MOTION KEYS DRAWING: draws the layer over the still, its matte, and its table. Furthest first.
tables=()
convert sky.png -background '#2f5a35' -gravity north -extent ${w}x${h} still.png
layer() {
  local name=$1 motion=$2 keys=$3 file=$4
  convert -size ${w}x${h} xc:none -draw "$(cat "$file")" own.png
  convert still.png own.png -composite still.png
  convert own.png -alpha extract -depth 8 "${name// /_}.png"
  tables=("[[layer]]
name = \"$name\"
matte = \"${name// /_}.png\"
motion = \"$motion\"
$keys" "${tables[@]}")
}
# tree SEED X ROOT TALL WIDE: a trunk and three hundred leaves, lit from above.
tree() {
  awk -v seed="$1" -v x="$2" -v root="$3" -v tall="$4" -v wide="$5" 'BEGIN {
    srand(seed); printf "fill #3d2c1c polygon %d,%d %d,%d %d,%d %d,%d\n", x-4, root, x-2, root-0.5*tall, x+2, root-0.5*tall, x+4, root
    for (i = 0; i < 420; ++i) {
      a = 6.2832 * rand(); r = sqrt(rand()); u = r * cos(a); v = r * sin(a)
      px = x + wide * u * (1 + 0.25 * sin(3 * a + seed)); py = root - 0.6 * tall + 0.4 * tall * v
      light = 0.5 - 0.35 * v + 0.35 * (rand() - 0.5); s = 2 + 5 * rand()
      printf "fill rgb(%d,%d,%d) ellipse %.1f,%.1f %.1f,%.1f 0,360\n", 20+70*light, 50+110*light, 20+30*light, px, py, s, 0.7*s
    } }' > tree.txt
}
# boat X WATERLINE SCALE COLOUR: hull, thin mast and two sails.
boat() {
  awk -v x="$1" -v y="$2" -v s="$3" -v c="$4" 'BEGIN {
    printf "fill %s polygon %d,%d %d,%d %d,%d %d,%d\n", c, x-60*s, y-18*s, x+66*s, y-20*s, x+48*s, y, x-46*s, y
    printf "fill #f3ead8 rectangle %d,%d %d,%d\n", x-60*s, y-21*s, x+66*s, y-18*s
    printf "fill #2a1c12 rectangle %.1f,%d %.1f,%d\n", x-1.2, y-170*s, x+1.2, y-18*s
    printf "fill #efe3c6 polygon %d,%d %d,%d %d,%d\n", x+5*s, y-160*s, x+5*s, y-40*s, x+58*s, y-36*s
    printf "fill #d9cba8 polygon %d,%d %d,%d %d,%d\n", x-6*s, y-150*s, x-6*s, y-40*s, x-46*s, y-34*s }' > boat.txt
}
# hills COLOUR HEIGHT SEED: a ridge, and its woods as a rough rim.
hills() {
  awk -v colour="$1" -v height="$2" -v seed="$3" -v shore="$shore" 'BEGIN {
    printf "fill %s polygon 0,%d", colour, shore
    for (x = 0; x <= 900; x += 6)
      printf " %d,%.1f", x, shore - height * (1 + 0.42 * sin(x / 97 + seed) + 0.3 * sin(x / 41 + 2 * seed) + 0.05 * sin(x * seed))
    printf " 900,%d\n", shore }'
}
{ hills '#8fa9c4' 62 1; hills '#5d8a80' 34 4; } > hills.txt
layer hills still "" hills.txt
for i in 0 1; do
  x=$((150 + 420 * i))
  echo "fill #d8c8a8 rectangle $x,330 $((x + 90)),$((shore + 4)) fill #9a4a32 polygon $((x - 8)),332 $((x + 45)),292 $((x + 98)),332
fill #3b3f4a rectangle $((x + 15)),345 $((x + 30)),365 rectangle $((x + 58)),345 $((x + 73)),365" > house.txt
  layer "house $i" still "" house.txt
done
n=0
for spot in "40 385 150 42" "110 384 110 30" "300 384 170 46" "370 386 120 34" "470 384 190 40" "720 385 140 44" "790 386 180 48" "865 384 130 36"; do
  read -r x root tall wide <<< "$spot"
  tree $((n + 3)) "$x" "$root" "$tall" "$wide"
  layer "tree $n" tree "armature = [$x, $root, $x, $((root - tall))]
frequency = 0.$((4 + n % 4))
mass = 2.5
shimmer = 0.8" tree.txt
  n=$((n + 1))
done
# The lake mirrors what stands on its shore.
convert still.png -crop ${w}x$((h - shore))+0+$((shore - (h - shore))) +repage -flip -fill '#123040' -colorize 28 -blur 0x0.8 lake_colour.png
convert still.png lake_colour.png -geometry +0+$shore -composite still.png
convert -size ${w}x${h} xc:black -fill white -draw "rectangle 0,$shore $w,$h" lake.png
lake="[[layer]]
name = \"lake\"
matte = \"lake.png\"
motion = \"water\"
mapping = \"normals\"
mirrors = true
horizon = [0, $shore, $w, $shore]"
front=("${tables[@]}")
tables=()
n=0
for spot in "230 470 0.8 #7a2f2a" "640 500 1.0 #28496b" "430 560 1.25 #2f5d46"; do
  read -r x y s c <<< "$spot"
  boat "$x" "$y" "$s" "$c"
  convert -size ${w}x${h} xc:none -draw "$(cat boat.txt)" -flip -channel A -evaluate multiply 0.6 +channel mirrored.png
  convert -size ${w}x${h} xc:none mirrored.png -geometry +0+$((2 * y - h)) -composite own.png
  convert still.png own.png -composite still.png
  convert own.png -alpha extract -depth 8 "mirror_$n.png"
  [ $n = 0 ] || tables=("[[layer]]
name = \"mirror $n\"
matte = \"mirror_$n.png\"
motion = \"boat\"
water = \"lake\"
reflection_of = \"boat $n\"
heave = 10
roll = 8" "${tables[@]}")
  layer "boat $n" boat "water = \"lake\"
heave = 10
roll = 8
hull = [$(awk "BEGIN{print $x-46*$s}"), $y, $(awk "BEGIN{print $x+48*$s}"), $y]" boat.txt
  n=$((n + 1))
done
for i in 0 1; do
  awk -v seed=$((i + 20)) -v at=$((60 + 760 * i)) 'BEGIN { srand(seed); for (i = 0; i < 40; ++i) {
    x = at + 110 * (rand() - 0.5); tall = 120 + 90 * rand(); lean = 30 * (rand() - 0.5); l = rand()
    printf "fill rgb(%d,%d,%d) polygon %.1f,675 %.1f,%.1f %.1f,675\n", 60+60*l, 90+60*l, 30+20*l, x-3, x+lean, 675-tall, x+3 } }' > reeds.txt
  layer "reeds $i" tree "armature = [[$((25 + 760 * i)), 674, $((25 + 760 * i)), 510], [$((60 + 760 * i)), 674, $((60 + 760 * i)), 490], [$((95 + 760 * i)), 674, $((95 + 760 * i)), 510]]
frequency = 0.9" reeds.txt
done
printf '%s\n' "${tables[@]}" "$lake" "${front[@]}" '[[layer]]
name = "sky"
matte = "rest"
motion = "clouds"
speed = 12' >> $toml
