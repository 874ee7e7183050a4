#include "studio/drawing/recipe.h"

#include <fmt/format.h>

namespace freshet::studio {
namespace {

/// A basic string of TOML.
std::string quoted(const std::string& text) {
  std::string escaped = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped + '"';
}

}  // namespace

std::string recipe_toml(const Document& document, const RecipeFiles& files) {
  std::string toml =
      "# In this folder: freshet synth animate --config project.toml -o OUT.mp4\n[synth.animate]\n";
  const auto say = [&](const char* name, const std::string& value) {
    toml += fmt::format("{} = {}\n", name, value);
  };
  if (!document.store.empty()) say("STORE", quoted(document.store));
  say("PICTURE", quoted(files.picture));
  if (files.whole)
    say("whole", "true");
  else if (!files.matte.empty())
    say("matte", quoted(files.matte));
  if (!files.held.empty()) say("hold", quoted(files.held));
  if (!files.strokes.empty()) say("strokes", quoted(files.strokes));
  if (!files.assignment.empty()) {
    say("assignment", quoted(files.assignment));
  } else {
    if (!document.class_name.empty()) say("class", quoted(document.class_name));
    if (!document.excluded_clips.empty()) {
      std::string names;
      for (const std::string& name : document.excluded_clips)
        names += (names.empty() ? "" : ", ") + quoted(name);
      say("exclude", "[" + names + "]");
    }
  }
  say("frames", fmt::format("{}", document.frames));
  say("fps", fmt::format("{}", document.fps));
  if (document.loop && document.frames > 1) say("loop", "true");
  if (document.speed != 1) say("speed", fmt::format("{}", document.speed));
  if (!files.tempo.empty()) say("retiming-map", quoted(files.tempo));
  if (document.moving_outline) say("boundary", "\"moving\"");
  return toml;
}

}  // namespace freshet::studio
