// synth/animate/clips/patch_levels.h — how the mean luminance of one clip's patches rises and falls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/clips/clip_luma.h"
#include "synth/animate/placement/placement.h"
#include "synth/playing/timeline.h"

namespace freshet::synth::animate {

/// Mean luma of patches that share a timeline. A mean of a whole patch hardly tells moments between frames from the mix
/// of the frames around them, so no flow is asked.
class PatchLevels {
 public:
  /// source    size of the clip's frames.
  /// patches   into Placement::patches, of this clip.
  /// moments   what each output frame shows; outlives this.
  PatchLevels(cv::Size source, const Placement& placement, std::span<const std::size_t> patches,
              std::span<const playing::Moment> moments);

  /// Takes the means of those of the frames, all loaded, that any moment shows and that it has not seen. All threads;
  /// the same for any number, and for any parts of the clip in ascending order.
  void measure(const ClipLuma& luma, std::span<const std::uint32_t> frames);
  /// How far above its mean over all output frames the i-th patch is in one of them, luma. After measure() of every
  /// frame.
  float at(std::size_t i, int output) const;

 private:
  std::span<const playing::Moment> moments_;
  std::vector<std::vector<cv::Point>> spots_;  // by patch: px of the source
  playing::FrameWeights weights_;
  std::map<std::uint32_t, std::vector<float>> means_;  // by clip frame: of each patch
  std::vector<double> average_;                        // by patch
};

}  // namespace freshet::synth::animate
