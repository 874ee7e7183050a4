#include "studio/ways/sweep_recipe.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"

namespace freshet::studio {
namespace {

constexpr const char* kStrokes = "strokes.svg";

/// Of `synth animate`.
std::string option_of(const std::string& setting) {
  if (setting == "outline") return "boundary";
  return setting == "lines" ? "strokes" : setting;
}

/// As `--vary` writes it.
std::string value_of(const std::string& setting, const std::string& value) {
  if (setting == "outline") return value == "moving" ? "moving" : "static";
  if (setting == "lines") return value == "with" ? kStrokes : "-";
  if (value.empty()) return "-";
  std::string escaped;
  for (const char c : value) {
    if (c == ',' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

}  // namespace

std::vector<std::string> sweep_words(const Document& document) {
  const std::vector<SweepAxis>& axes = document.sweep.axes;
  if (swept(document.sweep) < 2)
    throw Error(ErrorKind::kUsage, "sweep", "nothing varies", "Choose a setting and two values of it");
  if (swept(document.sweep) > kMostSwept)
    throw Error(ErrorKind::kUsage, "sweep",
                fmt::format("it is {} films, at most {} are made", swept(document.sweep), kMostSwept),
                "Leave values out");
  std::vector<std::string> words;
  for (const SweepAxis& axis : axes) {
    std::vector<std::string> values;
    for (const std::string& value : axis.values) values.push_back(value_of(axis.setting, value));
    words.push_back(fmt::format("--vary={}={}", option_of(axis.setting), fmt::join(values, ",")));
  }
  return words;
}

std::string sweep_toml(const Document& document, RecipeFiles files) {
  std::set<std::string> varied;
  for (const SweepAxis& axis : document.sweep.axes) varied.insert(option_of(axis.setting));
  if (varied.contains("strokes") && document.strokes.empty() && document.directions.empty())
    throw Error(ErrorKind::kUsage, "sweep", "there are no lines to leave out", "Draw some under Flow");
  if (varied.contains("class") || varied.contains("strokes")) files.assignment.clear();
  Document shown = document;
  if (!document.sweep.full) shown.frames = std::min(document.frames, kShortSweep);
  return "# In the project's folder: freshet synth sweep --config ways/sweep/sweep.toml --vary "
         "OPTION=VALUES\n"
         "[synth.sweep]\n" +
         recipe_lines(shown, files, varied);
}

}  // namespace freshet::studio
