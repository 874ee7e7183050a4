// include/freshet/ways/transfer.h — a designed motion gets the look of an exemplar (Jamriska et al. 2015, LazyFluids).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include <opencv2/core.hpp>

#include "freshet/job.h"

namespace freshet {

/// Where the fluid is and how it moves, a file per frame, paired in order.
struct Design {
  /// Masks: a folder or a pattern (%05d, ####) of pictures, or a video. Their alpha where they have one, else
  /// their luminance.
  std::filesystem::path alpha{};
  /// Motion fields, px per frame: a folder or a pattern of .flo (y down) or .exr (y up).
  std::filesystem::path flow{};
};

/// What the fluid shall look like.
struct Look {
  /// A picture, a folder or a pattern of pictures, or a video; shorter ones are looped.
  std::filesystem::path exemplar{};
  /// Masks of the exemplar: one picture, or as many frames as it has. Empty: its own alpha; without any it is
  /// opaque.
  std::filesystem::path alpha{};
};

struct TransferOptions {
  /// Only so many of the first frames; 0: all.
  int frames = 0;
  /// Side of a patch, px, odd, 3 to 9.
  int patch = 5;
  /// Weight of temporal coherence, 0 to 1.
  double lambda = 0.2;
  /// Weights, 0 to 16, of what else patches are chosen by: how the outline bends (the look has one), and how the flow
  /// spreads (the look is a video). 1 is strong; more speckles rims.
  double curvature = 0, divergence = 0;
  /// Whether the motion that a video has itself is taken out of its texture, so that the design alone moves it.
  bool stabilise = false;
  /// Length of the blur along the motion, frames, 0 to 4.
  double motion_blur = 0;
  /// Another seed, another animation of the same kind.
  std::uint64_t seed = 1;
};

struct TransferReport {
  int frames = 0;
  cv::Size size;  // px, of the frames
};

/// Hands every frame to `sink`, in order: CV_32FC4 BGRA, 0..1, straight alpha, valid during the call.
/// Throws  Error{kInput} naming the file: missing, unreadable, of another size than the first, without fluid;
///         Error{kUsage} for an option out of range, or one that asks for what the look lacks; Error{kCancelled}, and
///         what the sink throws.
///         Same input and options, same bytes, for any number of threads.
TransferReport transfer(const Design& design, const Look& look,
                        const std::function<void(const cv::Mat& bgra)>& sink,
                        const TransferOptions& options = {}, const Job& job = {});

}  // namespace freshet
