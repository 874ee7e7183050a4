// synth/animate/motion/carrying_field.h — the motion along which the picture is carried, frame by frame.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/motion/motion_sequence.h"

namespace freshet::synth::animate {

struct CarryingOptions {
  /// Of the patches' own flow about its mean, how much the carrying motion follows: 0 is a steady field.
  double variation = 1;
  /// Patches that overlap are mixed, and fluctuate less together than each does by itself: what is lost is given back,
  /// up to this many times. Clouds, smoke and fires lose about half (1.8 to 2.5 times), water less (1 to 1.2). What
  /// they do together is not lost: an uneven pace, doubled, would make a sky go to and fro.
  double max_regain = 2;
  /// Fluctuations are limited to this many times their root mean square at the place: where flow fails, it
  /// fails by much, and one wrong place would tear the picture.
  double max_deviation = 2.5;
  /// And to this many times the mean speed of the place; 0: not so. For motion that is asked: surf goes to and fro more
  /// than on, and where a slow drift is asked it folded a beach's waves. At .5 rapids come from 4.2 to 3.7 dB, other
  /// clips stay as they were.
  double max_of_asked = 0.5;
  /// Fluctuations are scaled by no less, and limited as if the mean were that of the assigned patches times this, but
  /// where the fluid is asked to stand (below .2 px/s; to 1, in part): flames that rise slowly in the mean leap all the
  /// same.
  double least_scale = 0;
  /// A frame whose mean speed is this many times the median frame's is bridged by its neighbours: cuts,
  /// flashes and repeated frames.
  double max_jump = 2.5;
};

/// Mean motion as it is asked for (or assigned), plus what the patches' flow does beside its own mean: turned by the
/// angle, and scaled by the ratio, from the assigned mean to the asked one (within least_scale and 4), and by what
/// mixing lost (max_regain). So the patches say how the fluid moves, and whoever draws says where to. Sampled every
/// step() px of the picture.
class CarryingField {
 public:
  /// sequence   of the assigned patches as they play.
  /// asked      CV_32FC2, px/s, the picture's size: the mean motion that is wanted (apply_guide).
  /// step       px of the picture between samples, >= 1.
  /// loop       the frames repeat: frame i is frame i + frames. Else the first and the last go on.
  CarryingField(std::shared_ptr<const MotionSequence> sequence, const cv::Mat& asked, int frames, double fps,
                int step, bool loop, const CarryingOptions& options);

  /// Displacement from output frame i to the next, px of the picture: CV_32FC2, size(), to be read alone. Any i. Safe
  /// from many threads; one warp of the coarse field, or none: every copy that is alive asks for the same frames, and
  /// the last ones are kept.
  cv::Mat at(int i) const;
  /// Root mean square speed of each place, px a frame: CV_32F, size().
  const cv::Mat& activity() const { return activity_; }
  cv::Size size() const { return mean_.size(); }
  int step() const { return step_; }

 private:
  int inside(int i) const;
  cv::Mat made(int frame) const;

  std::shared_ptr<const MotionSequence> sequence_;
  int frames_ = 1, step_ = 4;
  bool loop_ = false;
  double fps_ = 25;
  cv::Mat mean_;      // CV_32FC2, px a frame: asked
  cv::Mat assigned_;  // CV_32FC2, px/s: the sequence's own mean
  cv::Mat turn_;      // CV_32FC2: fluctuations are multiplied by this complex number, frames a px/s
  cv::Mat regained_;  // CV_32F, 1 .. max_regain: how much of it gives back what mixing lost
  cv::Mat activity_;  // CV_32F
  cv::Mat limit_;     // CV_32F, px a frame
  std::vector<int> stands_for_;    // by frame: the frame whose flow is used before it ...
  std::vector<int> stands_after_;  // ... and after it; equal where it is its own
  std::vector<float> fraction_;    // of the second
  mutable std::mutex guard_;
  mutable std::vector<std::pair<int, cv::Mat>> kept_;  // frame i at i modulo their number
};

}  // namespace freshet::synth::animate
