// studio/ways/sweep_recipe.h — settings to be tried, as the options of `synth sweep`.
#pragma once

#include <string>
#include <vector>

#include "studio/drawing/document.h"
#include "studio/drawing/recipe.h"

namespace freshet::studio {

/// The words of its --vary options. Throws Error{kUsage} where nothing is varied, saying what is missing.
std::vector<std::string> sweep_words(const Document& document);

/// For --config: the recipe without what is varied. Pieces that were pinned stay, unless others are to be chosen.
std::string sweep_toml(const Document& document, RecipeFiles files);

}  // namespace freshet::studio
