// studio/drawing/recipe.h — a project as the file of options with which the command line makes the same animation.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "studio/drawing/document.h"

namespace freshet::studio {

/// What of a project's folder there is for an animation.
struct RecipeFiles {
  std::string picture;      // "picture.png"
  std::string matte, held;  // "": none
  bool whole = false;       // all of the picture is fluid
  std::string strokes;      // "": none
  std::string tempo;        // "": none
  std::string assignment;   // "": patches are chosen anew; they are the same
};

/// The method and its settings that were chosen, as `synth animate` names them (synth/animate/method_settings.h): name,
/// value.
std::vector<std::pair<std::string, std::string>> method_settings_of(const Document& document);
/// The options of `freshet synth animate`, a line each, for a file that is read in the project's folder.
/// without   options that are left out.
std::string recipe_lines(const Document& document, const RecipeFiles& files,
                         const std::set<std::string>& without = {});
/// For `freshet synth animate --config project.toml`.
std::string recipe_toml(const Document& document, const RecipeFiles& files);

}  // namespace freshet::studio
