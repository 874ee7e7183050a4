// synth/scene/motion/cloud_drift.h — clouds go along with the wind (Chuang et al. 2005, Sec. 3.5).
#pragma once

#include <opencv2/core.hpp>

#include "synth/scene/cycle.h"
#include "synth/scene/motion/motion.h"
#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// A translation over a texture that is cyclic along x. In a loop that lasts about as long as the clouds need to
/// come round, they come round a whole number of times. In a shorter one that would be a storm: there the frame is a
/// mixture of two copies, one that leaves the still's place at the loop's beginning, and one that reaches it at its
/// end; the first fades into the second.
class CloudDrift : public Motion {
 public:
  /// period_px   of the texture. rows   of the layer, px: far_speed holds at the last.
  CloudDrift(const CloudMotion& clouds, const Wind& wind, const Cycle& cycle, bool loop, double period_px,
             const cv::Range& rows, int picture_width);

  void go_to(int frame) override;
  float reach() const override { return reach_; }
  void row(int copy, int x, int y, int n, float* dx, float* dy) const override;
  float second() const override { return second_; }
  double speed_px_per_s() const { return speed_; }
  bool mixes() const { return mixes_; }

 private:
  Cycle cycle_;
  cv::Range rows_;
  double speed_ = 0, far_speed_ = 1;
  bool mixes_ = false;
  double gone_[2] = {0, 0};  // px at full speed, of both copies
  float second_ = 0, reach_ = 0;
};

}  // namespace freshet::synth::scene
