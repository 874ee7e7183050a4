#!/bin/sh
# Installs the packages that are missing (Debian 12, as root or through sudo) and builds a preset.
# usage: cmake/prepare.sh [--for PURPOSES] PRESET [TARGET...]
# PURPOSES   of packages, in one word with commas, as cmake/debian-packages.txt has them: build, page, tests, bench
#            [all]
set -eu
cd "$(dirname "$0")/.."
purposes=build,page,tests,bench
if [ "$1" = --for ]; then
  purposes=$2
  shift 2
fi
preset=$1
shift

missing= extra=
[ "$preset" != fuzz ] || extra="clang libclang-rt-14-dev"
# shellcheck disable=SC2013
for package in $(awk -v for_="$purposes" 'index("," for_ ",", "," $2 ",") { print $1 }' cmake/debian-packages.txt) $extra; do
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
  # Another apt may be at work, as it is in a machine's first minutes: it is waited for.
  wait="-o DPkg::Lock::Timeout=600"
  # shellcheck disable=SC2086
  for attempt in 1 2 3 4 5 6 7 8 9 10; do
    $root apt-get $wait update -qq >&2 && break  # its own lock on the lists knows of no time
    [ "$attempt" -lt 10 ] || exit 1
    sleep 15
  done
  # shellcheck disable=SC2086
  $root env DEBIAN_FRONTEND=noninteractive apt-get $wait install -y -qq --no-install-recommends $missing >&2
fi

# A tree that has tests and benches keeps them; a new one has what packages were asked for. Other presets say it
# themselves.
configure=
[ -f "build/$preset/build.ninja" ] || configure=" "
if [ "$preset" = release ]; then
  for part in tests:FRESHET_TESTS bench:FRESHET_BENCH; do
    case ",$purposes," in
      *",${part%:*},"*) configure="$configure -D${part#*:}=ON" ;;
      *) [ -z "$configure" ] || configure="$configure -D${part#*:}=OFF" ;;
    esac
  done
fi
# shellcheck disable=SC2086
[ -z "$configure" ] || cmake --preset "$preset" $configure >&2
if [ $# -gt 0 ]; then
  cmake --build --preset "$preset" --target "$@" >&2
else
  cmake --build --preset "$preset" >&2
fi
