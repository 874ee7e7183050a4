// vision/look/fluid_kind.h — which class of fluid a still shows: water, fire, smoke or clouds, told from its look
// alone.
#pragma once

#include <array>
#include <string_view>

#include "vision/look/fluid_look.h"

namespace freshet::vision {

inline constexpr const char* kFire = "fire";
inline constexpr std::array<const char*, 4> kFluidKinds{"water", kFire, "smoke", "clouds"};

struct FluidKind {
  std::array<double, kFluidKinds.size()> share{};  // probabilities, of sum 1
  int best = 0;
  std::string_view name() const { return kFluidKinds[static_cast<std::size_t>(best)]; }
  double sureness() const { return share[static_cast<std::size_t>(best)]; }
  /// docs/measurements/critic.md says how many are, and how many of these are right.
  bool sure() const { return sureness() >= .85; }
};

/// A multinomial logistic regression, whose weights (kind_weights.h) bench_kind learns from outlined stills and clips.
/// A figure further than kFarthest deviations from its mean counts as if it were there.
FluidKind fluid_kind(const FluidLook& look);
inline constexpr double kFarthest = 3;

}  // namespace freshet::vision
