// synth/animate/animate.h — a still picture animated with the patches assigned to it.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <variant>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "store/store.h"
#include "synth/animate/carried/carried_renderer.h"
#include "synth/animate/forms/forms_renderer.h"
#include "synth/animate/frames/animation.h"
#include "synth/animate/paper/paper_renderer.h"
#include "synth/animate/placement/placement.h"
#include "vision/settings.h"

namespace freshet::synth::animate {

/// How frames are made: one renderer's options (renderer.h).
using Method = std::variant<CarriedOptions, FormsOptions, PaperOptions>;

struct AnimateOptions : FrameOptions {
  Method method{};
  /// In place of CarriedOptions in `method`, whose they take, where the picture is of a fire (fire_renderer). Nothing
  /// where somebody named the method.
  std::optional<FormsOptions> for_fires = FormsOptions{.flames = Flames::kOwn};
};

/// Renders the animation frame by frame into `sink`: the picture's size, in order, one at a time, while the next
/// ones are made. The sinks of mattes and motion are called in order too, from another thread.
///
/// picture    CV_8UC3 BGR, or CV_32FC3: sRGB code, 1 is white.
/// matte      CV_8U, same size; where it is 0 every output pixel equals the picture's.
/// placement  clips that do not last frames / fps seconds are played again by their loop rules (timeline.h).
///            With `loop`, clips play whole numbers of their loops, each beginning at another moment.
/// Throws     Error{kInput} when the placement does not pass check(), or a clip is too short for the
///            animation and for a loop rule; Error{kCancelled} when stopped.
/// Memory     see FrameOptions::memory_bytes. The same frames for any of it, and any number of threads.
AnimateReport animate(const store::Snapshot& snapshot, const vision::Settings& settings,
                      const cv::Mat& picture, const cv::Mat& matte, const Placement& placement,
                      const AnimateOptions& options, const std::function<void(const cv::Mat&)>& sink,
                      const ProgressFunction& progress = {}, std::stop_token stop = {});

}  // namespace freshet::synth::animate
