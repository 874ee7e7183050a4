#!/bin/sh
# The tests under the thread sanitizer, but for campaigns, fuzzing and browsers: run.sh [CTEST ARGUMENT..].
#
# The sanitizer sees only what is compiled with it. What one task writes and the next one reads is put in order inside
# oneTBB, so with the distribution's own library each parallel loop would be reported as a race, and suppressing those
# reports would hide races of ours. So oneTBB is built from the distribution's source with the sanitizer, in
# build/tsan/tbb, where programs of the preset look for it first (CMakePresets.json). OpenCV's loops run on it too. Its
# allocator is left out: what is freed there and used again would look like a race.
#
# OpenCV, FFmpeg and LMDB are as the distribution builds them: their locks and threads are seen, their own reading and
# writing is not.
set -eu
cd "$(dirname "$0")/../.."
cmake/prepare.sh tsan
tbb=$PWD/build/tsan/tbb
if [ ! -e "$tbb/libtbb.so.12" ]; then
  mkdir -p "$tbb/lists/partial"
  version=$(dpkg-query -W -f='${source:Version}' libtbb-dev)
  . /etc/os-release
  for suite in "$VERSION_CODENAME" "$VERSION_CODENAME-updates"; do
    echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian $suite main"
  done > "$tbb/sources.list"
  (
    cd "$tbb"
    options="-qq -o Dir::Etc::sourcelist=$tbb/sources.list -o Dir::Etc::sourceparts=- -o Dir::State::lists=$tbb/lists"
    # shellcheck disable=SC2086
    apt-get $options update
    # shellcheck disable=SC2086
    apt-get $options source --download-only "onetbb=$version"
    mkdir -p source
    tar -xf onetbb_*.orig.tar.* -C source --strip-components=1
    cmake -S source -B build -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DTBB_TEST=OFF -DTBB_STRICT=OFF \
      -DTBBMALLOC_BUILD=OFF -DTBB_SANITIZE=thread -DCMAKE_CXX_FLAGS=-D__TBB_DYNAMIC_LOAD_ENABLED=0
    cmake --build build --target tbb
    cp -a build/*/libtbb.so.12* .
  ) >&2
fi
# What OpenCV and LMDB copy is guarded in ways that are not seen. Tests fork while threads of oneTBB wait.
options="suppressions=$PWD/tests/tsan/suppressions.txt ignore_noninstrumented_modules=1 die_after_fork=0 history_size=7"
export TSAN_OPTIONS="$options${TSAN_OPTIONS:+ $TSAN_OPTIONS}"
exec ctest --preset tsan --timeout 3600 -E '^(Faults|Fuzz|Install|SecondReader|Studio\.Browser)' "$@"
