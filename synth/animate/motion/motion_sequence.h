// synth/animate/motion/motion_sequence.h — how the fluid of an animation moves, frame by frame.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "synth/animate/placement/placement.h"
#include "vision/settings.h"

namespace freshet::synth::animate {

/// What each output frame shows of one clip.
struct ShownFrame {
  std::uint32_t frame = 0;  // of the clip
  double rate = 1;          // clip seconds that pass in a second of the animation
};

/// Patches of one clip that play together.
struct PlayedPatches {
  store::ClipId clip{};
  std::vector<std::size_t> patches;  // into Placement::patches
  std::vector<ShownFrame> shown;     // by output frame
};

/// The motion M_i of the synthesised animation. It is the flow of the assigned patches' clips at the frames
/// that are shown, turned and scaled into their variants and averaged over squares of some 8 px. Where pieces
/// overlap it is mixed by weights that fall from each piece's middle. Beyond the pieces the motion of the
/// nearest goes on.
class MotionSequence {
 public:
  /// played   each patch of the placement once; `frames` frames shown of each.
  /// Throws   Error{kDamaged} when a clip's flow does not fit its frames.
  /// Cost     one pass over the flow of the frames shown, all threads; memory frames x picture / 64 x 8 bytes,
  ///          and per thread a slab of one clip's flow.
  /// Source   Okabe et al. 2011, Sec. 6, "Dynamic Boundaries of Fluid".
  MotionSequence(const store::Snapshot& snapshot, const vision::Settings& settings,
                 const Placement& placement, std::span<const PlayedPatches> played, cv::Size picture,
                 int frames);

  /// Velocity in output frame i: CV_32FC2 of the picture's size, px per second of the animation, x right,
  /// y down. Safe from many threads.
  cv::Mat at(int i) const;
  /// The same, sampled in the middles of squares of `step` px of the picture: CV_32FC2 of `size`.
  cv::Mat at(int i, int step, cv::Size size) const;

 private:
  cv::Size picture_;
  double piece_scale_ = 1;
  cv::Matx23d squares_from_picture_;
  std::vector<cv::Mat> squares_;  // by output frame, CV_32FC2
};

}  // namespace freshet::synth::animate
