#!/bin/sh
# Fails when an #include goes against the arrows of docs/architecture.md, between rooms or inside one, when modules of
# the page import each other in a circle, when a folder holds more units than a reader can keep in mind, or when two
# headers, or a type of a header and another type, have one name in folders of which one uses the other.
# usage: tests/arrows_test.sh ROOT
set -eu
cd "$1"

# Every folder with sources, lower ones first, and what it includes besides itself: neither more nor less. The public
# headers (include/freshet) and platform/ are open to all.
arrows='
include/freshet:
include/freshet/ways:
platform:
report:
cache:
store/format:
store/codec: store/format
store/records: store/format store/codec
store: store/format store/codec store/records
store/rewrite: store/format store/records store
media/frame:
media/picture: media/frame
media/video: media/frame media/picture
vision/flow:
vision: vision/flow
vision/look:
hints: media/picture vision/look
stored: store media/frame vision
ingest: store media/frame media/picture media/video vision vision/look stored
query/index: store store/rewrite vision stored
query/mrf:
query/search: store vision stored query/index
query/costs: store vision stored query/mrf query/search
query/labelling: report cache store vision vision/look stored query/index query/mrf query/search query/costs
query/benchmark: report store stored query/index query/search query/labelling
synth/field:
synth/toml: synth/field
synth/sampling: vision
synth/outline: synth/sampling
synth/playing: vision
synth/judging: report vision
synth/animate/placement: store vision query/search query/labelling
synth/animate/blend: vision synth/sampling synth/animate/placement
synth/animate/clips: store media/frame vision stored synth/sampling synth/playing synth/animate/placement synth/animate/blend
synth/animate/motion: store vision vision/look stored query/search synth/sampling synth/animate/placement
synth/animate/still: vision synth/sampling synth/animate/motion
synth/animate/frames: store vision stored query/search synth/sampling synth/outline synth/animate/placement synth/animate/blend synth/animate/clips synth/animate/motion synth/animate/still
synth/animate/paper: synth/sampling synth/animate/blend synth/animate/clips synth/animate/motion synth/animate/still synth/animate/frames
synth/animate/carried: vision vision/look synth/sampling synth/animate/placement synth/animate/blend synth/animate/clips synth/animate/motion synth/animate/still synth/animate/frames
synth/animate/forms: store vision media/picture stored synth/sampling synth/playing synth/animate/clips synth/animate/still synth/animate/frames synth/animate/carried
synth/animate: report store vision query/search query/labelling synth/animate/placement synth/animate/frames synth/animate/paper synth/animate/carried synth/animate/forms
synth/takes: report store vision query/search query/labelling synth/judging synth/animate/motion synth/animate/placement synth/animate
synth/matte: report media/picture query/search
synth/scene/layers: media/picture synth/outline synth/matte
synth/simulate/solver: synth/field
synth/simulate/scene: synth/field synth/simulate/solver
synth/simulate/clips: synth/field synth/simulate/solver synth/simulate/scene
synth/simulate/design: media/picture synth/field synth/toml synth/simulate/solver synth/simulate/scene
synth/simulate: synth/simulate/scene
synth/scene/kinds: media/frame synth/toml
synth/scene: media/frame hints synth/toml synth/scene/kinds
synth/scene/wind: synth/scene
synth/scene/water: synth/scene synth/scene/wind
synth/scene/motion: synth/scene synth/scene/wind synth/scene/water
synth/scene/rendering: media/picture synth/sampling synth/matte synth/scene/layers synth/scene synth/scene/wind synth/scene/water synth/scene/motion
synth/flowlines/jumps:
synth/flowlines/lines:
synth/flowlines: media/frame vision synth/sampling synth/outline synth/flowlines/jumps synth/flowlines/lines
synth/flowlines/files: store media/picture media/video hints stored synth/flowlines/lines synth/flowlines
synth/stills/between: cache vision synth/sampling
synth/stills: report cache media/frame media/picture hints synth/toml synth/outline synth/matte synth/stills/between
synth/transfer: synth/field
synth/transfer/files: cache store media/frame media/picture media/video vision stored synth/field synth/playing synth/transfer
synth/scene/frames: media/frame media/picture media/video hints vision synth/sampling synth/scene synth/scene/rendering synth/transfer synth/transfer/files
synth/scene/measured: store media/video vision stored synth/scene synth/scene/wind synth/scene/motion
synth/tour: media/frame media/picture media/video synth/toml synth/scene/layers synth/scene/frames
starter: cache store media/video vision ingest query/index synth/toml synth/simulate/scene synth/simulate/design synth/simulate
work: cache
studio/drawing: media/frame media/picture synth/matte synth/scene
studio/jobs:
studio/ways: cache media/picture synth/simulate/design synth/scene synth/scene/rendering synth/scene/frames studio/drawing
studio: cache store media/frame media/picture media/video hints vision vision/look stored query/index query/search query/labelling synth/animate/motion synth/takes synth/animate synth/matte synth/scene synth/stills work studio/drawing studio/jobs studio/ways
studio/http: studio
library: store media/frame media/picture media/video hints vision vision/look stored ingest query/index query/labelling query/benchmark synth/outline synth/animate synth/takes synth/matte
library/ways: hints media/picture synth/flowlines synth/flowlines/files synth/simulate/design synth/simulate synth/scene synth/scene/rendering synth/scene/frames synth/scene/measured synth/stills synth/tour synth/transfer synth/transfer/files library
python/binding:
python/binding/ways: python/binding
tools/console: store media/frame media/picture media/video query/index
tools/options: cache store starter media/picture media/video hints vision vision/look query/index query/mrf query/search query/costs synth/outline synth/animate/frames synth/animate synth/matte tools/console
tools: work report store store/rewrite media/frame media/video stored ingest query/index synth/toml starter studio studio/http tools/console tools/options
tools/work: synth/toml work tools/console tools
tools/query: store media/picture vision/look stored query/labelling query/benchmark synth/animate/placement synth/animate/motion tools/console tools/options tools
tools/store: report store stored query/index query/search query/labelling studio tools/console tools/options tools
tools/judging: media/frame media/picture media/video hints vision/look query/labelling synth/judging tools/console
tools/tour: media/picture synth/animate synth/tour tools/console tools/options
tools/synth: report store media/picture media/video hints vision/look stored query/labelling synth/judging synth/animate/placement synth/animate/motion synth/animate synth/takes synth/matte synth/scene/layers synth/simulate/design synth/simulate synth/scene synth/scene/rendering synth/scene/frames synth/scene/measured synth/flowlines synth/flowlines/files synth/stills synth/transfer synth/transfer/files tools/console tools/options tools tools/query tools/judging tools/tour
'
rooms="include platform report cache store media hints vision stored ingest query synth starter work studio library python tools"
max_units=17  # in one folder: a header and its source file are one, and so is a source file without a header

find $rooms -name '*.h' -o -name '*.cc' | sort | xargs awk -v arrows="$arrows" -v max_units="$max_units" '
BEGIN {
  lines = split(arrows, line, "\n")
  for (i = 1; i <= lines; ++i) {
    if (line[i] == "") continue
    split(line[i], part, ":")
    known[part[1]] = 1
    n = split(part[2], words, " ")
    for (k = 1; k <= n; ++k) {
      if (!(words[k] in known)) {
        print part[1] "/ may not use " words[k] "/: it is no folder, or stands higher"
        failed = 1
      }
      allowed[part[1], words[k]] = 1
    }
  }
}
function folder_of(path) { sub(/\/[^\/]*$/, "", path); return path }
FNR == 1 {
  folder = folder_of(FILENAME)
  if (!(folder in known)) {
    print FILENAME ": its folder is not among the arrows: say in tests/arrows_test.sh what it may use"
    known[folder] = 1
    failed = 1
  }
  unit = FILENAME
  sub(/\.[^.]*$/, "", unit)
  if (!(unit in counted)) ++units[folder]
  counted[unit] = 1
}
/^[ \t]*#[ \t]*include[ \t]*["<]/ {
  name = $0
  sub(/^[^"<]*["<]/, "", name)
  sub(/[">].*$/, "", name)
  if (name ~ /^\.\.?\//) {
    print FILENAME ":" FNR ": write includes from the root of the tree"
    failed = 1
  }
  to = name ~ /^freshet\// ? folder_of("include/" name) : folder_of(name)
  if (!(to in known) || to == folder || to ~ /^include\/freshet/ || to == "platform") next
  used[folder, to] = 1
  if (!((folder, to) in allowed)) {
    print FILENAME ":" FNR ": " folder "/ may not include " to "/: see docs/architecture.md"
    failed = 1
  }
}
/^(struct|class|enum class) [A-Za-z0-9_]+ [^;]*\{/ {
  name = $2 == "class" && $1 == "enum" ? $3 : $2
  is_public = FILENAME ~ /\.h$/
  places[name] = places[name] " " folder (is_public ? "+" : "-")
}
FNR == 1 && FILENAME ~ /\.h$/ {
  name = FILENAME
  sub(/^.*\//, "", name)
  places[name] = places[name] " " folder "+"
}
function one_name(name,    at, n, i, k, a, b) {
  n = split(places[name], at, " ")
  for (i = 1; i <= n; ++i)
    for (k = i + 1; k <= n; ++k) {
      if (at[i] ~ /-$/ && at[k] ~ /-$/) continue
      a = substr(at[i], 1, length(at[i]) - 1)
      b = substr(at[k], 1, length(at[k]) - 1)
      if (a == b || !((a, b) in allowed || (b, a) in allowed)) continue
      print name " is in " a "/ and in " b "/, which meet: give one another name"
      failed = 1
    }
}
END {
  for (name in places) one_name(name)
  for (arrow in allowed)
    if (!(arrow in used)) {
      split(arrow, part, SUBSEP)
      print part[1] "/ does not include " part[2] "/: take the arrow out of tests/arrows_test.sh"
      failed = 1
    }
  for (folder in units)
    if (units[folder] > max_units) {
      print folder "/ holds " units[folder] " units, more than " max_units ": it has found a second subject"
      failed = 1
    }
  exit failed
}'

# Python has a file for each public header; callbacks and stopping (job.h) are bound with calls.
for header in include/freshet/*.h include/freshet/ways/*.h; do
  name=$(basename "$header" .h)
  [ "$name" = job ] || [ -n "$(find python/binding -name "$name.cc")" ] || { echo "$header: no $name.cc in python/binding" && false; }
done

# The page: no circle of imports between its modules.
find studio/page/src -name '*.ts' -o -name '*.tsx' | sort | xargs awk '
FNR == 1 {
  module = FILENAME
  sub(/\.tsx?$/, "", module)
  modules[module] = 1
}
/(from|import) "\.\.?\/[^"]+"/ {
  name = $0
  sub(/^.*(from|import) "/, "", name)
  sub(/".*$/, "", name)
  to = module
  sub(/\/[^\/]*$/, "", to)
  while (name ~ /^\.\.?\//) {
    if (name ~ /^\.\.\//) sub(/\/[^\/]*$/, "", to)
    sub(/^\.\.?\//, "", name)
  }
  imports[module] = imports[module] " " to "/" name
}
function visit(module, path,    words, n, i) {
  if (seen[module] == 2) return
  if (seen[module] == 1) {
    print "a circle of imports:" path " " module
    failed = 1
    return
  }
  seen[module] = 1
  n = split(imports[module], words, " ")
  for (i = 1; i <= n; ++i)
    if (words[i] in modules) visit(words[i], path " " module)
  seen[module] = 2
}
END {
  for (module in modules) visit(module, "")
  exit failed
}'
