#!/bin/sh
# Installs the packages that are missing (Debian 12, as root or through sudo) and builds a preset.
# usage: cmake/prepare.sh PRESET [TARGET...]
set -eu
cd "$(dirname "$0")/.."
preset=$1
shift

missing= extra=
[ "$preset" != fuzz ] || extra="clang libclang-rt-14-dev"
# shellcheck disable=SC2013
for package in $(cat cmake/debian-packages.txt) $extra; do
  # Other makers' packages of node bring npm along, and cannot stand beside Debian's.
  [ "$package" = npm ] && command -v npm > /dev/null && continue
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q '^install ok installed' || missing="$missing $package"
done
if [ -n "$missing" ]; then
  echo "Installing packages:$missing" >&2
  root=
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo > /dev/null || {
      echo "Packages are missing:$missing. Install them as root, or install sudo, and run this again." >&2
      exit 1
    }
    root=sudo
  fi
  $root apt-get update -qq >&2
  # shellcheck disable=SC2086
  $root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >&2
fi

[ -f "build/$preset/build.ninja" ] || cmake --preset "$preset" >&2
if [ $# -gt 0 ]; then
  cmake --build --preset "$preset" --target "$@" >&2
else
  cmake --build --preset "$preset" >&2
fi
