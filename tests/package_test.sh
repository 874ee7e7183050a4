#!/bin/sh
# Manual pages and completions made from the help say what the program does; the Debian packages unpack into a root
# where the program runs; lintian finds nothing that is not answered; the source archive configures with no git.
# usage: tests/package_test.sh ROOT BUILD
set -eu
root=$1 build=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() {
  echo "$1"
  exit 1
}

cd "$scratch"
cpack --config "$build/CPackConfig.cmake" -B "$scratch/packages" > log 2>&1 || { cat log; exit 1; }
mkdir root
for package in packages/*.deb; do dpkg-deb -x "$package" root; done
for name in $(grep -oE 'PACKAGE_NAME "[a-z0-9.-]+"' "$build/CPackConfig.cmake" | grep -E '"(python3-)?freshet|"libfreshet' | cut -d'"' -f2 | sort -u); do
  ls packages/"$name"_*.deb > /dev/null || fail "there is no package $name"
done

LD_LIBRARY_PATH=$(dirname "$(find "$scratch/root/usr" -name 'libfreshet.so.*' | head -n 1)")
export LD_LIBRARY_PATH
freshet=$scratch/root/usr/bin/freshet
"$freshet" --version | grep -q '^freshet [0-9]'
"$freshet" synth simulate fire --size 64x48 --frames 2 -o fire.mkv > log 2>&1
[ -s fire.mkv ]
if [ -d root/usr/lib/python3 ]; then
  PYTHONPATH=$scratch/root/usr/lib/python3/dist-packages /usr/bin/python3 -c '
import freshet
assert len(list(freshet.simulate("fire", size=(64, 48), frames=2))) == 2'
fi
if [ -e "$LD_LIBRARY_PATH/pkgconfig/freshet.pc" ]; then
  unpacked() { PKG_CONFIG_PATH=$LD_LIBRARY_PATH/pkgconfig PKG_CONFIG_SYSROOT_DIR=$scratch/root pkg-config "$@" freshet; }
  # shellcheck disable=SC2046
  c++ -std=c++20 "$root/tests/install/read.cc" -I/usr/include/opencv4 $(unpacked --cflags --libs) -o read
  status=0
  ./read none.store 2> log || status=$?
  [ $status -eq 1 ] && grep -q none.store log
fi

# A page for each command, that names its options; nothing that groff warns of.
share=$scratch/root/usr/share
zcat "$share/man/man1/freshet-synth-animate.1.gz" | grep -q 'matte'
for page in "$share"/man/man1/*.gz; do
  zcat "$page" | groff -man -Tutf8 -ww -z 2> log
  [ ! -s log ] || { cat log; fail "$page"; }
done
[ "$(ls "$share/man/man1" | wc -l)" -gt 20 ]

# Completions offer commands, options, and the values of options.
bash -c '
  . "$1"
  ask() { COMP_WORDS=(freshet "$@"); COMP_CWORD=$#; _freshet; echo "${COMPREPLY[@]}"; }
  [ "$(ask synth ani)" = animate ] && [ "$(ask synth animate --depth h)" = half ] && [[ "$(ask synth animate a.store --overw)" = --overwrite ]]
' _ "$share/bash-completion/completions/freshet" || fail "bash completion"
zsh -n "$share/zsh/vendor-completions/_freshet"
fish -c "source $share/fish/vendor_completions.d/freshet.fish; complete -C 'freshet synth animate --depth h'" > log 2>&1
[ "$(cut -f1 log)" = half ] || { cat log; fail "fish completion"; }
fish -c "source $share/fish/vendor_completions.d/freshet.fish; complete -C 'freshet --pro'" > log 2>&1
grep -q -- --progress log || { cat log; fail "fish completion of the program's own options"; }

desktop-file-validate "$share/applications/freshet.desktop"
lintian --fail-on error,warning --suppress-tags-from-file "$root/cmake/package/lintian-answers" packages/*.deb > log 2>&1 ||
  { cat log; exit 1; }

# The source archive: no git, and nothing of it that is missing.
cpack --config "$build/CPackSourceConfig.cmake" -B "$scratch/source" > log 2>&1 || { cat log; exit 1; }
tar -xf source/*.tar.gz
cd freshet-*/
[ ! -e .git ] && [ ! -e build ]
cmake -S . -B build -G Ninja -DFRESHET_TESTS=OFF -DFRESHET_BENCH=OFF > "$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
