#include "synth/animate/clips/patch_levels.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

#include "vision/variant.h"

namespace freshet::synth::animate {
namespace {

/// Pixels of the clip that a patch shows, one for each of its own.
std::vector<cv::Point> spots_of(cv::Size source, const PlacedPatch& placed, int side) {
  const vision::VariantFrame frame = vision::variant_frame(source, placed.variant);
  std::vector<cv::Point> spots;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const cv::Vec2d at = frame.source_from_variant * cv::Vec3d(placed.patch.x + x, placed.patch.y + y, 1);
      spots.emplace_back(std::clamp(static_cast<int>(std::lround(at[0])), 0, source.width - 1),
                         std::clamp(static_cast<int>(std::lround(at[1])), 0, source.height - 1));
    }
  return spots;
}

}  // namespace

PatchLevels::PatchLevels(cv::Size source, const Placement& placement, std::span<const std::size_t> patches,
                         std::span<const playing::Moment> moments)
    : moments_(moments), weights_(playing::frame_weights(moments)), average_(patches.size(), 0) {
  for (const std::size_t p : patches)
    spots_.push_back(spots_of(source, placement.patches[p], placement.side));
}

void PatchLevels::measure(const ClipLuma& luma, std::span<const std::uint32_t> frames) {
  std::vector<std::uint32_t> fresh;
  for (const std::uint32_t frame : frames)
    if (weights_.contains(frame) && !means_.contains(frame)) {
      fresh.push_back(frame);
      means_[frame].resize(spots_.size());
    }
  oneapi::tbb::parallel_for(std::size_t{0}, fresh.size(), [&](std::size_t f) {
    std::vector<float>& means = means_.at(fresh[f]);
    for (std::size_t i = 0; i < spots_.size(); ++i) means[i] = luma.mean(fresh[f], spots_[i]);
  });
  for (const std::uint32_t frame : fresh)
    for (std::size_t i = 0; i < spots_.size(); ++i) average_[i] += weights_.at(frame) * means_.at(frame)[i];
}

float PatchLevels::at(std::size_t i, int output) const {
  double level = 0;
  playing::each_frame(moments_[static_cast<std::size_t>(output)], [&](std::uint32_t frame, double weight) {
    level += weight * (means_.at(frame)[i] - average_[i]);
  });
  return static_cast<float>(level);
}

}  // namespace freshet::synth::animate
