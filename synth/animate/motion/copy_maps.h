// synth/animate/motion/copy_maps.h — where each copy of the carried picture comes from, frame by frame.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// One copy of the picture in one frame.
struct CopyMap {
  float weight = 0;  // the weights of a frame's copies sum to 1
  cv::Mat source;    // CV_32FC2, sampled as the field: from a place to where the copy has it from, px
};

/// Three copies of the picture are carried along a field that changes from frame to frame. Each stands as it is
/// in its own frame, is carried on for half a life after it, and shows for half a life before it what is yet to
/// come: so fluid comes in and goes out at borders, and no copy is stretched for longer than half a life. Their
/// own frames lie a third of a life apart, weights are (1 + cos) / 3. Around output frame 0 the weights go over
/// to its copy alone: there the picture is itself.
/// Source: textures carried and regenerated, Max and Becker 1995, Neyret 2003; here along unsteady flow, both
/// ways in time. The frame in which a copy is as the picture lies up to a sixth of a life beside the middle of its
/// life, another for each copy: else what is shown would come again every third of a life. Not in Okabe et al. 2011.
class CopyMaps {
 public:
  static constexpr int kCopies = 3;

  /// third        frames between the copies' own times, >= 1. loop_frames: > 0, a multiple of third: the period.
  /// start_still  frame 0 is the picture.
  /// displacement  from output frame i to the next, any i: px of the picture, CV_32FC2 of `size`, sampled every
  ///               `step` px (CarryingField::at). Called from many threads.
  CopyMaps(std::function<cv::Mat(int)> displacement, cv::Size size, int step, int third, int loop_frames,
           bool start_still);

  /// Makes what at() needs of output frames [first, first + count), and forgets what lies before. In ascending
  /// order. All threads.
  void prepare(int first, int count);
  /// Of a prepared frame. Safe from many threads.
  std::array<CopyMap, kCopies> at(int i) const;
  /// The output frame in which a copy is as the picture.
  int own_frame(int copy) const;
  /// 1 in frame 0, falling to 0 within a third of a life; around it from both sides in a loop.
  double beginning(int i) const;
  /// How far frame i is the picture itself, 0..1: as far as it is the beginning, where that is asked.
  double still(int i) const { return start_still_ ? beginning(i) : 0; }
  /// A third of a life in frames that fits: as asked, or the divisor of a loop nearest to it.
  static int third_of(double life_s, double fps, int loop_frames);

 private:
  int first_copy(int i) const;
  int middle(int copy) const { return copy * third_ + phase_; }
  void carry_copy(int copy);

  std::function<cv::Mat(int)> displacement_;
  cv::Size size_;
  int step_ = 1;
  int third_ = 1, loop_frames_ = 0, reach_ = 1;
  int phase_ = 0;  // of the middles of lives: a loop that does not begin as the still begins between two
  bool start_still_ = true;
  std::map<int, std::vector<cv::Mat>> maps_;  // by copy: frames -reach_ .. reach_ from the middle of its life
};

}  // namespace freshet::synth::animate
