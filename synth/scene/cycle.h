// synth/scene/cycle.h — the time after which all motion of a scene repeats.
#pragma once

#include <algorithm>
#include <cmath>

#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// Every motion is a sum of the cycle's harmonics, and its phases come from tables of one cycle: frame `frames` is
/// frame 0 to the bit.
struct Cycle {
  int frames = 1;
  double fps = 25;

  double seconds() const { return frames / fps; }
  /// Any frame's place in the cycle.
  int place(int frame) const { return ((frame % frames) + frames) % frames; }
};

/// After a film whose wind changes, and that is no loop, the cycle has so many seconds in which the wind goes back to
/// that of the beginning and what swung in it comes to rest. Nobody sees them.
inline constexpr double kAfterwardsS = 30;

/// A loop's is its length; of all else nobody sees a repetition within a minute or its own length.
inline Cycle cycle_of(const Scene& scene) {
  constexpr double kLongS = 60;
  const double after_s = scene.wind.changes() ? kAfterwardsS : 0;
  const int unseen = std::max(scene.frames + static_cast<int>(std::ceil(after_s * scene.fps)),
                              static_cast<int>(std::ceil(kLongS * scene.fps)));
  return {.frames = scene.loop ? scene.frames : unseen, .fps = scene.fps};
}

}  // namespace freshet::synth::scene
