#!/bin/sh
# Fails when a source file is not as clang-format would write it, or when one of its lines (clang-format leaves comments
# alone), or one of a document outside of tables and code, is longer than 120 columns.
# usage: tests/format_test.sh ROOT
set -eu
cd "$1"
rooms=$(sed -n 's/^rooms="\(.*\)"$/\1/p' tests/arrows_test.sh)
[ -n "$rooms" ]
find $rooms tests bench \( -name '*.h' -o -name '*.cc' \) -print0 | xargs -0 clang-format --dry-run --Werror
tab=$(printf '\t')
{
  find $rooms tests bench \( -name '*.h' -o -name '*.cc' \) | xargs awk '{ print FILENAME ":" FNR ":\t" $0 }'
  find README.md docs -name '*.md' | xargs awk '
    FNR == 1 { code = 0 }
    /^ *```/ { code = !code }
    !code && !/^(    | *\|)/ && !/!\[/ { print FILENAME ":" FNR ":\t" $0 }'
} | if LC_ALL=C.UTF-8 grep -E "$tab.{121}"; then
  echo 'Lines of more than 120 columns'
  exit 1
fi
