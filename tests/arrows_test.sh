#!/bin/sh
# Fails when an #include goes against the arrows of docs/architecture.md, between rooms or inside one, or when a folder
# holds more units than a reader can keep in mind.
# usage: tests/arrows_test.sh ROOT
set -eu
cd "$1"

# Every folder with sources, and what it may include besides itself. A name stands for that folder alone; NAME/* for it
# and all below it. The public headers (include/freshet) and platform/ are open to all.
arrows='
include/freshet:
platform:
report: platform
store/format:
store/codec: store/format
store/records: store/format store/codec
store: store/format store/codec store/records
store/rewrite: store store/format store/records
media/frame:
media/picture: media/frame
media/video: media/frame media/picture
vision:
ingest: store media/* vision
query/stored: store media/frame vision
query/index: store store/rewrite vision query/stored
query/hints: media/picture
query/mrf:
query/search: store vision query/stored query/index query/mrf
query/costs: store vision query/stored query/mrf query/search
query/labelling: report store vision query/stored query/index query/mrf query/search query/costs
query/benchmark: report store query/stored query/index query/search query/labelling
synth/field:
synth/toml: synth/field
synth/animate/sampling: vision query/search
synth/animate/placement: store vision query/search query/labelling
synth/animate/blend: vision synth/animate/sampling synth/animate/placement
synth/animate/clips: store media/frame vision query/stored synth/animate/sampling synth/animate/placement synth/animate/blend
synth/animate/still: vision synth/animate/sampling synth/animate/motion
synth/animate/motion: store vision query/stored query/search synth/animate/sampling synth/animate/placement
synth/animate/frames: store vision query/stored query/search synth/animate/sampling synth/animate/placement synth/animate/blend synth/animate/clips synth/animate/still synth/animate/motion
synth/animate/carried: vision synth/animate/frames synth/animate/sampling synth/animate/placement synth/animate/blend synth/animate/clips synth/animate/still synth/animate/motion
synth/animate/paper: synth/animate/frames synth/animate/sampling synth/animate/blend synth/animate/clips synth/animate/still synth/animate/motion
synth/animate: report store vision query/labelling query/search synth/animate/*
synth/matte: report media/picture query/search
synth/scene/layers: media/picture synth/animate/motion synth/matte
synth/simulate/solver: synth/field
synth/simulate/scene: synth/field synth/simulate/solver
synth/simulate/clips: synth/field synth/simulate/solver synth/simulate/scene
synth/simulate/design: media/picture synth/field synth/toml synth/simulate/solver synth/simulate/scene
synth/simulate: synth/simulate/*
synth/scene: query/hints synth/field synth/toml
synth/scene/wind: synth/scene
synth/scene/water: synth/scene synth/scene/wind
synth/scene/motion: synth/scene synth/scene/wind synth/scene/water
synth/scene/rendering: media/* synth/scene synth/scene/* synth/animate/sampling synth/matte
synth/flowlines: vision query/hints query/mrf synth/animate/sampling synth/animate/motion synth/flowlines/jumps synth/flowlines/lines
synth/flowlines/jumps:
synth/flowlines/lines:
synth/flowlines/files: media/* store query/stored query/hints synth/flowlines synth/flowlines/lines
synth/stills: media/frame media/picture vision query/hints query/labelling synth/matte synth/toml report
synth/transfer: synth/field
synth/transfer/files: store media/* vision query/stored synth/transfer synth/animate/clips
studio/drawing: synth/matte
studio/ways: studio/drawing synth/simulate/design
studio: store media/* vision query/* synth/animate/* synth/matte studio/drawing studio/ways
studio/http: studio
library: store media/* vision ingest query/* synth/*
tools/console: store media/* vision query/*
tools/options: vision media/picture media/video query/* synth/animate/* synth/matte tools/console
tools: report store/* media/* vision ingest query/* synth/* studio studio/http tools/*
'
rooms="include platform report store media vision ingest query synth studio library tools"
max_units=16  # headers, with or without a source file, in one folder

find $rooms -name '*.h' -o -name '*.cc' | sort | xargs awk -v arrows="$arrows" -v max_units="$max_units" '
BEGIN {
  lines = split(arrows, line, "\n")
  for (i = 1; i <= lines; ++i) {
    if (line[i] == "") continue
    split(line[i], part, ":")
    known[part[1]] = 1
    may_use[part[1]] = part[2]
  }
}
function folder_of(path) { sub(/\/[^\/]*$/, "", path); return path }
function may(from, to,    words, n, i, root) {
  if (from == to || to == "include/freshet" || to == "platform") return 1
  n = split(may_use[from], words, " ")
  for (i = 1; i <= n; ++i) {
    if (words[i] == to) return 1
    if (words[i] ~ /\/\*$/) {
      root = substr(words[i], 1, length(words[i]) - 2)
      if (to == root || index(to, root "/") == 1) return 1
    }
  }
  return 0
}
FNR == 1 {
  folder = folder_of(FILENAME)
  if (!(folder in known)) {
    print FILENAME ": its folder is not among the arrows: say in tests/arrows_test.sh what it may use"
    known[folder] = 1
    failed = 1
  }
  if (FILENAME ~ /\.h$/) ++units[folder]
}
/^[ \t]*#[ \t]*include[ \t]*["<]/ {
  name = $0
  sub(/^[^"<]*["<]/, "", name)
  sub(/[">].*$/, "", name)
  if (name ~ /^\.\.?\//) {
    print FILENAME ":" FNR ": write includes from the root of the tree"
    failed = 1
  }
  to = name ~ /^freshet\// ? "include/freshet" : folder_of(name)
  if (to in known && !may(folder, to)) {
    print FILENAME ":" FNR ": " folder "/ may not include " to "/: see docs/architecture.md"
    failed = 1
  }
}
END {
  for (folder in units)
    if (units[folder] > max_units) {
      print folder "/ holds " units[folder] " headers, more than " max_units ": it has found a second subject"
      failed = 1
    }
  exit failed
}'
