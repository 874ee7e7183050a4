#!/bin/sh
# Fails when an #include goes against the arrows of docs/architecture.md: a room may include its own headers,
# those of the tree's root (freshet_error.h and the like), and those of the rooms below it.
# usage: tests/arrows_test.sh ROOT
set -eu
cd "$1"
may_use() {
  case $1 in
    store | media | vision) echo "" ;;
    ingest | query) echo "store media vision" ;;
    synth) echo "store media vision query" ;;
    tools) echo "store media vision ingest query synth" ;;
  esac
}
rooms="store media vision ingest query synth tools"
status=0
for room in $rooms; do
  [ -d "$room" ] || { echo "$room/: the room is missing"; status=1; continue; }
  for other in $rooms; do
    [ "$other" = "$room" ] && continue
    case " $(may_use $room) " in *" $other "*) continue ;; esac
    if grep -rnE "#[[:space:]]*include[[:space:]]*[\"<]$other/" "$room"; then
      echo "$room/ may not include $other/: see docs/architecture.md"
      status=1
    fi
  done
done
# A file reaches others by their full name only: "../" would slip past the check above.
if grep -rnE '#[[:space:]]*include[[:space:]]*"\.\.?/' $rooms; then
  echo "write includes from the root of the tree"
  status=1
fi
exit $status
