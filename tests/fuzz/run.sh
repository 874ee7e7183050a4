#!/bin/sh
# Fuzzes each target in turn, from the kept inputs on: run.sh [SECONDS [TARGET..]]. What is new lies in
# build/fuzz/found, what fails in build/fuzz/failed; ends with 1 when anything failed.
set -eu
cd "$(dirname "$0")/../.."
cmake/prepare.sh fuzz fuzz_targets
seconds=${1:-7200}
[ $# -gt 0 ] && shift
[ $# -gt 0 ] || set -- $(cd build/fuzz/tests/fuzz/corpus && ls | grep -vx planted)
export ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
failed=0
for target in "$@"; do
  found=build/fuzz/found/$target
  mkdir -p "$found" build/fuzz/failed
  build/fuzz/tests/fuzz/fuzz_"$target" -max_total_time="$seconds" -timeout=25 -rss_limit_mb=2300 -max_len=70000 \
    -print_final_stats=1 -artifact_prefix=build/fuzz/failed/"$target"- "$found" build/fuzz/tests/fuzz/corpus/"$target" || failed=1
done
exit $failed
