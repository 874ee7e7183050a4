#!/bin/sh
# Installs what is needed, builds, and runs every test. Works from nothing but a checkout on Debian 12.
# ./test.sh --long: the campaigns of tests/faults alone, at full length (hours).
# FRESHET_LONG_MINUTES=N ./test.sh --long: of each as many cases, in a mixed order, as N minutes allow.
# ./test.sh --soak [MINUTES]: many processes on one store, an hour unless said otherwise.
# ./test.sh --tsan [CTEST ARGUMENT..]: the tests under the thread sanitizer.
# ./test.sh --fuzz [SECONDS [TARGET..]]: coverage-guided fuzzing, two hours a target unless said otherwise.
set -eu
cd "$(dirname "$0")"
if [ "${1:-}" = --tsan ]; then
  shift
  exec tests/tsan/run.sh "$@"
fi
cmake/prepare.sh release
if [ "${1:-}" = --long ]; then
  shift
  FRESHET_LONG=1 exec ctest --preset release --timeout 86400 -R '^Faults\.' "$@"
fi
if [ "${1:-}" = --soak ]; then
  FRESHET_SOAK_MINUTES=${2:-60} exec ctest --preset release --timeout 86400 -R '^Faults\.Soak' -V
fi
if [ "${1:-}" = --fuzz ]; then
  shift
  exec tests/fuzz/run.sh "$@"
fi
exec ctest --preset release --parallel "$(nproc)" "$@"
