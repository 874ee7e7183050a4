#!/bin/sh
# Fails when a source file is not as clang-format would write it.
# usage: tests/format_test.sh ROOT
set -eu
cd "$1"
find freshet_allocation.h freshet_error.h freshet_vectors.h store media vision ingest query synth tools tests bench \( -name '*.h' -o -name '*.cc' \) -print0 |
  xargs -0 clang-format --dry-run --Werror
