// starter/recipe.h — which simulated clips the starter store has.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "synth/simulate/scene/scene_options.h"

namespace freshet::starter {

struct RecipeClip {
  std::string name;  // "fire/camp fire": its class, and what it shows
  synth::simulate::SceneOptions scene;
};

/// Clips in the order in which they are made. TOML: size, frames and fps for all, and a table [[clip]] for each, with
/// name and the keys of a ready-made clip (synth simulate --keys).
struct Recipe {
  std::string text;
  std::vector<RecipeClip> clips;

  /// 16 hex digits of its text and of the version of what is made from it.
  std::string hash() const;
};

/// The one that Freshet brings (starter.toml).
Recipe own_recipe();
/// name   stands for the file in messages.
/// Throws Error{kInput} naming file, line and key: what read_clip refuses, a name without a class or given twice, odd
/// sizes.
Recipe parse_recipe(std::string_view text, const std::filesystem::path& name);

}  // namespace freshet::starter
