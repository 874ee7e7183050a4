// include/freshet/animate.h — a still picture animated with the patches chosen for it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "freshet/label.h"

namespace freshet {

/// The length of the animation and its rate are those of the search (SearchOptions::frames, fps).
struct AnimateOptions {
  /// The last frame runs into the first without a seam.
  bool loop = false;
  /// How fast everything plays, 0.05 to 20: 1 as filmed, 0.5 slow motion. Nothing: at the pace.
  std::optional<double> speed{};
  /// "slow", "natural", "fast": as the kind of fluid goes at the picture's size; "auto": half-way from as filmed to
  /// natural, or as filmed where the guide asks speeds or the class is none of water, fire, smoke and clouds.
  std::string pace = "auto";
  /// CV_8UC3 of the picture's size, times speed: black 0.5, mid-grey 1, white 2. Empty: the same everywhere.
  cv::Mat retiming_map{};
  /// The fluid carries its outline along, with softer rims.
  bool moving_outline = false;
  /// CV_8UC3 of the picture's size, or as deep as below: what lies behind a moving outline. Empty: guessed from around
  /// the matte.
  cv::Mat background{};
  /// The picture that was searched with, with all of its bits (Picture::deep): CV_16UC3, sRGB code, or CV_32FC3, linear
  /// light. Frames are then of its type. Empty: that picture itself.
  cv::Mat deep{};
  /// Bytes that frames in the making may take; more of them are made in batches, the same to the bit. A
  /// picture needs some 280 bytes per pixel by itself.
  std::size_t memory_bytes = std::size_t{2000} << 20;
};

struct AnimateReport {
  int frames = 0;
  std::size_t clips = 0, pieces = 0;
  double seconds = 0;  // wall clock
};

/// Hands every frame to `sink`, in order, one at a time: CV_8UC3, or the type of AnimateOptions::deep, of the picture's
/// size, valid during the call. Where the matte is 0, a frame is the picture, to the bit.
/// Throws  Error{kInput} when a map or background has another size, Error{kUsage} for an option out of range,
///         Error{kCancelled}, and what the sink throws. The same frames for any number of threads.
AnimateReport animate(const Labelling& labelling, const std::function<void(const cv::Mat& frame)>& sink,
                      const AnimateOptions& options = {}, const Job& job = {});

/// The same into a file, as VideoWriter makes it; none is left where this throws. Its format must hold the frames'
/// type.
AnimateReport animate(const Labelling& labelling, const std::filesystem::path& video,
                      const AnimateOptions& options = {}, const Job& job = {});

}  // namespace freshet
