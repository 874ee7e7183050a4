#include "studio/drawing/recipe.h"

#include <algorithm>

#include <fmt/format.h>

#include "studio/drawing/toml_text.h"

namespace freshet::studio {

std::vector<std::pair<std::string, std::string>> method_settings_of(const Document& document) {
  if (!document.flames.empty()) return {{"method", "forms"}, {"flames", document.flames}};
  std::vector<std::pair<std::string, std::string>> settings;
  const Document usual;
  each_method_setting([&](std::string name, auto field, const auto&...) {
    std::ranges::replace(name, '_', '-');
    if (document.*field != usual.*field) settings.emplace_back(name, fmt::format("{}", document.*field));
  });
  return settings;
}

std::string recipe_lines(const Document& document, const RecipeFiles& files,
                         const std::set<std::string>& without) {
  std::string toml;
  const auto say = [&](const std::string& name, const std::string& value) {
    if (!without.contains(name)) toml += fmt::format("{} = {}\n", name, value);
  };
  if (!document.store.empty()) say("STORE", toml_text(document.store));
  say("PICTURE", toml_text(files.picture));
  if (files.whole)
    say("whole", "true");
  else if (!files.matte.empty())
    say("matte", toml_text(files.matte));
  if (!files.held.empty()) say("hold", toml_text(files.held));
  if (!files.strokes.empty()) say("strokes", toml_text(files.strokes));
  if (!files.assignment.empty()) {
    say("assignment", toml_text(files.assignment));
  } else {
    if (!document.class_name.empty()) say("class", toml_text(document.class_name));
    if (!document.excluded_clips.empty()) say("exclude", toml_list(document.excluded_clips));
  }
  say("frames", fmt::format("{}", document.frames));
  say("fps", fmt::format("{}", document.fps));
  if (document.loop && document.frames > 1) say("loop", "true");
  if (document.speed != 0) say("speed", fmt::format("{}", document.speed));
  if (document.horizon != "auto") say("horizon", toml_text(document.horizon));
  if (!files.tempo.empty()) say("retiming-map", toml_text(files.tempo));
  if (document.moving_outline) say("boundary", "\"moving\"");
  for (const auto& [name, value] : method_settings_of(document))
    say(name, value.front() >= '0' && value.front() <= '9' ? value : toml_text(value));
  return toml;
}

std::string recipe_toml(const Document& document, const RecipeFiles& files) {
  return "# In this folder: freshet synth animate --config project.toml -o OUT.mp4\n[synth.animate]\n" +
         recipe_lines(document, files);
}

}  // namespace freshet::studio
