#include <initializer_list>
#include <string>

#include <fmt/format.h>

#include "cache/result_cache.h"
#include "freshet/error.h"
#include "studio/ways/way.h"

namespace freshet::studio {
namespace {

std::string clip_store(const Document& document) { return document.flowlines.dropped ? "" : document.store; }

/// The clip that is chosen, as `synth flowlines` is told of it.
std::vector<std::string> flowlines_of(const Document& document) {
  const Flowlines& flowlines = document.flowlines;
  if (flowlines.clip.empty())
    throw Error(ErrorKind::kUsage, "flowlines", "no clip is chosen", "Choose one, or drop one");
  std::vector<std::string> words{"synth", "flowlines"};
  if (flowlines.dropped) {
    words.push_back(own_clip_path(flowlines.clip));
  } else {
    if (document.store.empty())
      throw Error(ErrorKind::kUsage, "flowlines", "the clip has no store", "Choose one under Look");
    words.insert(words.end(), {"--store=" + document.store, "--clip=" + flowlines.clip});
  }
  if (flowlines.moving_camera) words.emplace_back("--moving-camera");
  return words;
}

/// A name for what was found in a clip: what was found in another one is not taken for it, by 128 bits.
std::string found_name(const Document& document) {
  cache::KeyHash hash;
  hash.add(clip_store(document));
  hash.add(document.flowlines.clip);
  return "found-" + cache::hex(hash.key());
}

/// The lines that are found in the clip.
WayPlan plan_lines(const Document& document) {
  const std::string found = found_name(document);
  WayPlan plan{.folder = "flowlines",
               .commands = {flowlines_of(document)},
               .film = "",
               .answer = found + ".json",
               .shown = {found + ".svg"},
               .store = clip_store(document)};
  std::vector<std::string>& words = plan.commands[0];
  words.insert(words.end(), {"--frames", "1", "-o", "ways/flowlines/first.png", "--lines-out",
                             "ways/flowlines/" + found + ".svg", "--json", "--overwrite"});
  return plan;
}

/// The clip without an end, along its lines, or where they were moved.
WayPlan plan_flowlines(const Document& document) {
  const Flowlines& flowlines = document.flowlines;
  WayPlan plan{.folder = "flowlines",
               .commands = {flowlines_of(document)},
               .film = "ways/flowlines/film.mp4",
               .answer = "made.json",
               .shown = {"drawn.png"},
               .store = clip_store(document)};
  std::vector<std::string>& words = plan.commands[0];
  const auto say = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
  say({"--frames", std::to_string(flowlines.frames)});
  if (flowlines.loop) say({"--loop"});
  if (!flowlines.lines.empty()) say({"--lines", "ways/flowlines/lines.svg"});
  if (!flowlines.edited.empty()) {
    say({"--edited", "ways/flowlines/edited.svg"});
    if (flowlines.join > 0) say({"--join", fmt::format("{:g}", flowlines.join)});
    if (flowlines.stretched) say({"--correspondence", "stretched"});
    if (flowlines.ground != "none") say({"--ground", flowlines.ground});
  }
  say({"-o", plan.film, "--draw", "ways/flowlines/drawn.png", "--json", "--overwrite"});
  return plan;
}

std::vector<WayFile> flowlines_files(const WayInput& input) {
  const Flowlines& flowlines = input.document.flowlines;
  std::vector<WayFile> files;
  if (!flowlines.lines.empty()) files.push_back({"lines.svg", clip_lines_svg(flowlines.lines)});
  if (!flowlines.edited.empty()) files.push_back({"edited.svg", clip_lines_svg(flowlines.edited)});
  return files;
}

std::vector<WayFile> no_files(const WayInput&) { return {}; }

}  // namespace

extern const Way kFlowlinesWay{.name = "flowlines", .plan = plan_flowlines, .files = flowlines_files};
extern const Way kLinesWay{.name = "lines", .plan = plan_lines, .files = no_files};

}  // namespace freshet::studio
