#include "synth/animate/staging.h"

#include <algorithm>

#include <oneapi/tbb/global_control.h>

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

std::size_t animations_at_once(std::size_t memory_bytes, cv::Size picture) {
  const std::size_t min_bytes =
      (std::size_t{96} << 20) + static_cast<std::size_t>(picture.area()) * (kPictureBytesPerPixel + 16 * 8);
  const std::size_t threads =
      oneapi::tbb::global_control::active_value(oneapi::tbb::global_control::max_allowed_parallelism);
  return std::clamp<std::size_t>(memory_bytes / min_bytes, 1, threads);
}

}  // namespace freshet::synth::animate
