// quality_method.h — one way to animate, as a list of settings that differ from the defaults.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "query/labelling/labelling.h"
#include "synth/animate/animate.h"

namespace freshet::bench {

/// Who makes the frames.
enum class Renderer {
  kAnimate,         // synth::animate, from labels
  kCarried,         // carry_still along the clip's true mean motion: no labels, no hint
  kCarriedVarying,  // carry_still along the clip's own flow, frame by frame
  kOptimised,       // optimise_still along what is asked
  kExample,         // animate_by_example of one clip, along what is asked
  kTransfer         // transfer_flames, of fires alone: no labels, no hint
};

struct Method {
  std::string name;
  Renderer renderer = Renderer::kAnimate;
  query::LabelOptions label;
  synth::animate::AnimateOptions animate;
  bool own = false;  // the clip itself among the candidates: what rendering alone costs
  std::optional<double>
      speed{};  // times what is asked, or played (synth::takes::apply); none: "auto" (synth::takes::factor_of)
  bool horizon = true;      // water's straight border is one, as freshet synth animate has it
  bool same_class = false;  // candidates of the clip's class alone, as one who knows what is to be seen asks
  std::string labels_settings;  // what of its settings labels depend on: methods that agree share labels
};

/// A method or an ablation by name, and the settings that make it.
struct NamedSettings {
  std::string name, settings, what;
};
/// Ways to animate that stand beside each other in every table: ours, and its rivals. A new way of rendering
/// is a row here, and a key of its own in quality_method.cc.
const std::vector<NamedSettings>& methods();
/// Variations of ours, one choice changed in each.
const std::vector<NamedSettings>& ablations();

/// Applies "key=value key=value ..." (or with commas), in order. Throws Error{kUsage} for an unknown key, or
/// a value that is none of its own; the message lists the keys.
void apply_settings(const std::string& settings, Method& method);
/// One line a key: what it sets.
std::string setting_keys();

}  // namespace freshet::bench
