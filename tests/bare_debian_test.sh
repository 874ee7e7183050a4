#!/bin/bash
# The Debian packages of a build with BUILD_SHARED_LIBS and FRESHET_PYTHON install on a bare Debian 12 (debootstrap,
# apt) and work there: a store of simulated clips is made, searched and animated, by the program, by Python and by a
# program that is compiled against libfreshet-dev. Needs root, debootstrap and a mirror; some 400 MB are fetched. By
# hand, not in the suite.
# usage: tests/bare_debian_test.sh ROOT BUILD [BARE [MIRROR]]   BARE: a folder that debootstrap has made, which is
# changed
set -euo pipefail
root=$(realpath "$1") build=$(realpath "$2") mirror=${4:-http://deb.debian.org/debian}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
bare=${3:-$scratch/bare}
[ -d "$bare/usr" ] || debootstrap --variant=minbase bookworm "$bare" "$mirror" > "$scratch/log" || { tail "$scratch/log"; exit 1; }
cp /etc/resolv.conf "$bare/etc/resolv.conf"
mkdir -p "$bare/try"
cpack --config "$build/CPackConfig.cmake" -B "$scratch/packages" > "$scratch/log" || { cat "$scratch/log"; exit 1; }
cp "$scratch"/packages/*.deb "$root/tests/install/read.cc" "$root/tests/install/animate.cc" "$bare/try"
cat > "$bare/try/run" << 'END'
set -euxo pipefail
export DEBIAN_FRONTEND=noninteractive HOME=/try
cd /try
apt-get update -qq
apt-get install -y -qq --no-install-recommends ./*.deb > apt.log
freshet --version
freshet synth simulate fire --size 192x144 --frames 32 -o clips/fire/1.mkv
freshet synth simulate waterfall --size 192x144 --frames 32 -o clips/fall/1.mkv
freshet ingest my.store clips --force
freshet store export my.store fall/1.mkv -o frames/%02d.png
freshet synth animate my.store frames/07.png --whole --frames 8 -o program.mkv --preset archive
freshet store verify my.store
python3 - << 'PYTHON'
import freshet
store = freshet.Store("my.store")
picture = freshet.read_picture("frames/07.png").bgr
height, width, _ = picture.shape
matte = freshet.read_picture("frames/07.png").bgr[:, :, 0] * 0 + 255
search = freshet.search(store, picture, matte, frames=8)
frames = list(freshet.animate(freshet.label(search)))
assert len(frames) == 8 and frames[3].shape == picture.shape, len(frames)
PYTHON
test -e /usr/share/man/man1/freshet.1.gz -a -e /usr/share/doc/freshet/copyright
apt-get install -y -qq --no-install-recommends g++ pkg-config > apt.log
for program in read animate; do
  c++ -std=c++20 $program.cc -o $program $(pkg-config --cflags --libs freshet) -I/usr/include/opencv4 -lopencv_core
done
./read my.store | grep -q patch.words
apt-get purge -y -qq freshet libfreshet0.1 libfreshet-dev python3-freshet > apt.log
test ! -e /usr/bin/freshet
END
unshare --mount --pid --fork chroot "$bare" sh -c 'mount -t proc proc /proc && bash /try/run' > "$scratch/out" 2>&1 || { tail -n 40 "$scratch/out"; exit 1; }
grep -m1 '^freshet [0-9]' "$scratch/out"
rm -rf "${bare:?}/try"
echo "ok: $(. "$bare/etc/os-release"; echo "$PRETTY_NAME"), bare"
