// studio/ways/sweep_recipe.h — settings to be tried, as the options of `synth sweep`.
#pragma once

#include <string>
#include <vector>

#include "studio/drawing/document.h"
#include "studio/drawing/recipe.h"

namespace freshet::studio {

/// The words of its --vary options. Throws Error{kUsage} where nothing is varied, or too much, saying what is missing.
std::vector<std::string> sweep_words(const Document& document);

/// For --config: the recipe without what is varied. Pieces that were pinned stay, unless others are to be chosen.
/// Throws Error{kUsage} where lines are to be left out, and there are none.
std::string sweep_toml(const Document& document, RecipeFiles files);

}  // namespace freshet::studio
