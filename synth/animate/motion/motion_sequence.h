// synth/animate/motion/motion_sequence.h — how the fluid of an animation moves, frame by frame.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "stored/decoded_tiles.h"
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

/// Flow of one clip that is in memory already.
struct HeldFlow {
  cv::Rect samples;  // of the flow's planes; right at least where the patches lie and 8 samples around them
  /// Planes u and v of a frame, as stored: CV_16S, of the samples' size. Safe from many threads.
  std::function<std::array<cv::Mat, 2>(std::uint32_t)> at;
};

/// The motion M_i of the synthesised animation. It is the flow of the assigned patches' clips at the frames
/// that are shown, turned and scaled into their variants and averaged over squares of some 8 px. Where pieces
/// overlap it is mixed by weights that fall from each piece's middle. Beyond the pieces the motion of the
/// nearest goes on. Where a clip shows a frame twice (25 frames a second brought to 30), all go on as before and after.
///
/// Memory: by clip frame that is shown, not by output frame: 8 bytes for each square that a clip's patches lie on.
/// Frames are put together of these when they are asked for, and the last ones kept: 64,
/// or as many as fit into 64 MiB.
/// Source   Okabe et al. 2011, Sec. 6, "Dynamic Boundaries of Fluid".
class MotionSequence {
 public:
  /// Velocity in output frame i: CV_32FC2 of the picture's size, px per second of the animation, x right,
  /// y down. Safe from many threads.
  cv::Mat at(int i) const;
  /// The same, sampled in the middles of squares of `step` px of the picture: CV_32FC2 of `size`.
  cv::Mat at(int i, int step, cv::Size size) const;

  /// Variance over time of a patch's motion before it is mixed, limited and smoothed, mean over the patches that lie on
  /// a place; beyond the pieces that of the nearest goes on. Sampled as at(): CV_32F, (px/s)^2.
  cv::Mat own_variance(int step, cv::Size size) const;

  /// Held for all frames.
  std::size_t bytes() const;

 private:
  friend class MotionSums;
  struct Impl;
  explicit MotionSequence(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

/// Collects the motion of all patches, clip after clip.
class MotionSums {
 public:
  /// snapshot and placement outlive this.
  /// tiles   of this snapshot, decoded earlier; may be null.
  MotionSums(const store::Snapshot& snapshot, const vision::Settings& settings, const Placement& placement,
             cv::Size picture, int frames, stored::DecodedTiles* tiles = nullptr);
  ~MotionSums();

  /// Patches that are in no other group. held: the clip's flow, of every frame that is shown; null: it is read, in one
  /// pass, a slab of it per thread. All threads; the same for any number.
  /// Throws   Error{kDamaged} when the clip's flow does not fit its frames.
  void add(const PlayedPatches& group, const HeldFlow* held = nullptr);
  /// After all patches of the placement.
  MotionSequence means() &&;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::synth::animate
