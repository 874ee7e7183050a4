#!/bin/sh
# Installs the build into a scratch folder and builds a program outside the tree against it.
# usage: tests/install_test.sh ROOT BUILD
set -eu
root=$1 build=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --install "$build" --prefix "$scratch/prefix" > "$scratch/log"
cmake -S "$root/tests/install" -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$scratch/prefix" > "$scratch/log"
cmake --build "$scratch/build" > "$scratch/log" || { cat "$scratch/log"; exit 1; }

# It must run, and its message must name the file that is not there.
status=0
"$scratch/build/uses_freshet" "$scratch/no.store" 2> "$scratch/message" || status=$?
[ $status -eq 1 ] && grep -q no.store "$scratch/message"
"$scratch/prefix/bin/freshet" --version | grep -q '^freshet [0-9]'
