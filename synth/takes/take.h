// synth/takes/take.h — ways to make one animation that are worth a try, as changes to what was asked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "synth/animate/animate.h"
#include "synth/animate/staging.h"

namespace freshet::synth::takes {

inline constexpr int kMaxTakes = 8;

/// What is changed of an animation as it was asked: all of it unset is that itself.
struct Take {
  std::string name{};       // for a person: "as asked", "half as fast"
  std::string options{};    // of freshet synth animate, that make it so; empty: as asked
  double speed = 1;         // times what is asked, or played
  bool own_speeds = false;  // speeds that are asked are left out: clips go as they were filmed
  std::optional<animate::Layout> layout{};
  double life = 1;     // times the half-life of detail
  bool forms = false;  // flames from clips
};

/// What a person left open: only that is varied.
struct Open {
  bool speed = true, layout = true, life = true, method = true;
};

/// Up to `count` takes, the one as asked first, the most promising of the kind next.
/// kind     a store's class.
/// method   that was asked; only carried pictures are varied.
std::vector<Take> plan_takes(const std::string& kind, const animate::AnimateOptions& options,
                             const query::MotionGuide& asked, const Open& open, int count);

/// The take's changes to what an animation is made of.
/// half_life_s   that detail has as asked (AnimateReport); 0: not known, and then lives are left.
void apply(const Take& take, double half_life_s, animate::AnimateOptions& options, query::MotionGuide& asked,
           animate::Playing& playing);

}  // namespace freshet::synth::takes
