#include "synth/animate/staging.h"

#include <algorithm>

#include "synth/animate/placement/assigned.h"
#include "synth/animate/placement/retiming.h"

namespace freshet::synth::animate {

Staging stage(const store::Snapshot& snapshot, const query::Assignment& assignment, cv::Size picture,
              const query::MotionGuide& asked, const Playing& playing, const AnimateOptions& options) {
  Staging staging{.placement = placement_from(assignment, snapshot), .options = options};
  retime(staging.placement, playing.factor, playing.map, picture);
  staging.options.guide = asked;
  const auto retimed = [](const PlacedPatch& patch) { return patch.speed != 1; };
  if (std::any_of(staging.placement.patches.begin(), staging.placement.patches.end(), retimed))
    staging.options.guide.speed.release();
  return staging;
}

}  // namespace freshet::synth::animate
