#!/bin/sh
# Installs the build into a scratch folder, builds programs outside the tree against it, and runs them on clips that
# they simulate.
# usage: tests/install_test.sh ROOT BUILD
set -eu
root=$1 build=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
prefix=$scratch/prefix
cmake --install "$build" --prefix "$prefix" > "$scratch/log"

# The public headers and no other, which include nothing but each other, the standard library and OpenCV's core.
(cd "$root/include" && find . -name '*.h' | sort) > "$scratch/public"
(cd "$prefix/include" && find . -type f | sort) > "$scratch/installed"
diff "$scratch/public" "$scratch/installed"
if grep -rhE '^ *# *include' "$prefix/include" | grep -vE '<[a-z_]+>|<opencv2/core.hpp>|"freshet/[a-z/]+\.h"'; then
  echo "a public header includes what is not installed"
  exit 1
fi

cmake -S "$root/tests/install" -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" > "$scratch/log"
cmake --build "$scratch/build" > "$scratch/log" || { cat "$scratch/log"; exit 1; }
"$prefix/bin/freshet" --version | grep -q '^freshet [0-9]'

# A message names the file that is not there.
cd "$scratch"
status=0
build/animate no.store still.png matte.png out.mp4 2> message || status=$?
[ $status -eq 1 ] && grep -q no.store message

mkdir -p clips/fall
build/simulate 1 clips/fall/1.mkv still.png matte.png
build/simulate 2 clips/fall/2.mkv still.png matte.png
build/simulate 7 out.mkv still.png matte.png
build/ingest my.store clips > listing 2> log || { cat log; exit 1; }
grep -q '^fall/1.mkv [1-9]' listing && grep -q '^fall/2.mkv [1-9]' listing

# What it holds, which clips are like a picture, and an index of one's own beside Freshet's.
build/read my.store > listing
grep -q 'patch.words' listing && grep -q '  motion ' listing
build/search my.store still.png | grep -qE 'fall/[12].mkv 0\.[0-9]'
build/own_index my.store | grep -q '"brute force"'

# The same animation as the program's, to the byte.
build/animate my.store still.png matte.png out.mp4
"$prefix/bin/freshet" synth animate my.store still.png --matte matte.png --class fall --frames 8 -o same.mp4 > log 2>&1
cmp out.mp4 same.mp4

# The same with something held back and an outline that stays, from a picture of 16 bits into a file of 16 bits.
ffmpeg -v error -i still.png -pix_fmt rgb48be deep.png
ffmpeg -v error -f lavfi -i color=black:size=192x144,drawbox=80:60:30:30:white:fill -frames:v 1 -pix_fmt gray held.png
build/animate my.store deep.png matte.png deep.mkv held.png
"$prefix/bin/freshet" synth animate my.store deep.png --matte matte.png --hold held.png --class fall --frames 8 \
    -o same.mkv > log 2>&1
cmp deep.mkv same.mkv

"$prefix/bin/freshet" synth simulate plume --size 96x80 --frames 4 -o design > log 2>&1
build/transfer design still.png matte.png look.mkv
[ -s look.mkv ]
build/tour out.mkv tour.mkv | grep -q '^8 frames of 192 x 144$'
[ -s tour.mkv ]

# Other ways to synthesise, each the program's to the byte.
mkdir stills
ffmpeg -v error -i out.mkv -vf "select=not(mod(n\,5))" -fps_mode passthrough stills/%d.png
build/stills stills stills.mkv | grep -q '^8 frames of 192 x 144$'
"$prefix/bin/freshet" synth stills stills --seconds 1 --fps 8 --one-region -o same_stills.mkv > log 2>&1
cmp stills.mkv same_stills.mkv
build/flowlines out.mkv lines.mkv lines.svg | grep -q '^40 frames along [1-9]'
"$prefix/bin/freshet" synth flowlines out.mkv --frames 40 --lines-out same.svg -o same_lines.mkv > log 2>&1
cmp lines.mkv same_lines.mkv
cmp lines.svg same.svg
cat > scene.toml << 'END'
picture = "still.png"
frames = 8
[[layer]]
name = "fall"
matte = "matte.png"
motion = "patches"
store = "my.store"
class = "fall"
END
build/scene scene.toml scene.mkv | grep -q '^8 frames of 192 x 144, 2 layers$'
"$prefix/bin/freshet" synth scene scene.toml -o same_scene.mkv > log 2>&1
cmp scene.mkv same_scene.mkv
