#!/bin/sh
# Fails when a source file is not as clang-format would write it.
# usage: tests/format_test.sh ROOT
set -eu
cd "$1"
find include platform report cache store media hints vision stored ingest query synth studio library python tools tests bench \( -name '*.h' -o -name '*.cc' \) -print0 |
  xargs -0 clang-format --dry-run --Werror
