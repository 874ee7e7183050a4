// synth/animate/clip_luma.h — the luminance of the frames of one clip that an animation shows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "media/frame.h"
#include "store/store.h"

namespace freshet::synth {

/// For each output frame, the clip's frame that is shown: the one nearest in time. Frames are not mixed: a
/// mixture halves the contrast of what moves fast, and so makes an animation pulse at the beat of the two
/// rates. Throws Error{kInput} when the clip ends before the last output frame.
std::vector<std::uint32_t> frames_shown(const store::Snapshot& snapshot, store::ClipId clip, int frames,
                                        double fps);

/// Frames of one clip in memory: raw samples of what the needed rectangles touch, and their average.
class ClipLuma {
 public:
  /// needed   px of the source frame; only the 64 x 64 blocks that they touch are decoded, each once.
  /// shown    clip frames, ascending; repeats are decoded once.
  /// Cost     bytes of the needed blocks a distinct frame; all threads.
  ClipLuma(const store::Snapshot& snapshot, store::ClipId clip, std::span<const cv::Rect> needed,
           std::span<const std::uint32_t> shown);

  /// Output frame i less the average over all output frames; CV_32F, luma in 0..1, source size, zero where
  /// nothing was needed. The average is that of the frames shown, not of the whole clip: what the clip did at
  /// other times would stay on the picture as a stain. Source: Okabe et al. 2011, Sec. 6, D_i = F_i - A.
  void difference(std::size_t i, cv::Mat& out) const;

 private:
  media::PixelLayout layout_;
  std::vector<std::size_t> frame_of_output_;  // into frames_
  std::vector<cv::Mat> frames_;  // luma samples as stored, or 8-bit luma where it had to be computed
  bool raw_ = true;
  cv::Mat average_, wanted_;
};

}  // namespace freshet::synth
