// synth/animate/animate.h — a still picture animated with the patches assigned to it.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "synth/animate/appearance.h"
#include "synth/animate/base_image.h"
#include "synth/animate/blend.h"
#include "synth/animate/placement.h"
#include "vision/settings.h"

namespace freshet::synth {

enum class AppearanceMatching {
  kNone,
  kFrame,     // the paper's: each frame by itself; it pumps
  kSequence,  // one model for the whole animation
};

struct AnimateOptions {
  int frames = 96;
  double fps = 25;
  BlendOptions blend;
  BaseImageOptions base;
  AppearanceMatching matching = AppearanceMatching::kSequence;
  AppearanceOptions appearance;
};

/// Where the time went, and with what.
struct AnimateReport {
  std::size_t clips = 0, pieces = 0;
  double decode_s = 0, blend_s = 0, base_s = 0, appearance_s = 0, render_s = 0, total_s = 0;
};

struct AnimateProgress {
  std::string stage;
  std::size_t done = 0, of = 0;
};

/// Renders the animation frame by frame into `sink`: CV_8UC3, the picture's size, in order.
///
/// picture    CV_8UC3 BGR. matte CV_8U, same size; where it is 0 every output pixel equals the picture's.
/// placement  every clip in it must last frames / fps seconds.
/// Throws     Error{kInput} when the placement does not pass check() or a clip is too short,
/// Error{kCancelled} when stopped. Memory     frames x picture x 4/3 floats, and the shown frames' luminance
/// of one clip at a time. Source     Okabe et al. 2011, Sec. 6.
AnimateReport animate(const store::Snapshot& snapshot, const vision::Settings& settings,
                      const cv::Mat& picture, const cv::Mat& matte, const Placement& placement,
                      const AnimateOptions& options, const std::function<void(const cv::Mat&)>& sink,
                      const std::function<void(const AnimateProgress&)>& progress = {},
                      std::stop_token stop = {});

}  // namespace freshet::synth
