// video_texture.h — rivals of endless flow lines: a loop with a cross-fade, and video textures.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::bench {

/// A clip that ends in a cross-fade to its own beginning, again and again. The period is clip less fade.
/// clip     CV_8UC3. fade   frames, below half of the clip.
std::vector<cv::Mat> fading_loop(const std::vector<cv::Mat>& clip, int fade, int frames);

struct VideoTextureOptions {
  int taps = 2;  // m: frames of context to either side, binomial weights
  double sharpness =
      0.05;  // sigma, as a share of the mean distance: less jumps only where it is all but unseen
  double power = 2, discount = 0.995;  // p and alpha of the anticipated future cost
  std::uint64_t seed = 1;
};
/// Random play: after frame i comes frame j with a probability that falls with the (anticipated) distance between
/// frames i + 1 and j.
/// Source   Schoedl, Szeliski, Salesin, Essa 2000, Sec. 3.1 to 3.3 and 4.1; without pruning and without their morphing.
std::vector<cv::Mat> video_texture(const std::vector<cv::Mat>& clip, int frames,
                                   const VideoTextureOptions& options = {});

}  // namespace freshet::bench
