// synth/scene/motion/cloud_drift.h — clouds go along with the wind (Chuang et al. 2005, Sec. 3.5).
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/cycle.h"
#include "synth/scene/motion/motion.h"
#include "synth/scene/scene.h"
#include "synth/scene/wind/weather.h"

namespace freshet::synth::scene {

/// How fast clouds go, and after how many pixels they come round.
struct CloudCourse {
  double speed_px_per_s = 0;
  int period_px = 0;       // of their texture
  bool dissolves = false;  // the loop is too short for them to come round
  /// Where the wind changes: px gone at every frame of the cycle, and at its end; the speed above is their mean.
  std::vector<double> gone_px{};

  double gone_at(int place, double fps) const {
    return gone_px.empty() ? speed_px_per_s * place / fps : gone_px[static_cast<std::size_t>(place)];
  }
  /// px, of no frame of the first `frames`, nor the one after, more.
  double furthest_px(int frames, double fps) const;
};
/// width_px   of the layer's box.
/// Where the wind changes, clouds have gone the integral of its speed along the picture; a speed of their own holds for
/// the strongest wind.
CloudCourse course_of(const CloudMotion& clouds, const Wind& wind, const Cycle& cycle, bool loop,
                      int width_px, int picture_width);

/// px gone along the picture and away from the viewer, at each frame of the cycle and at its end, of what goes with the
/// wind above the ground as fast as these clouds do over the picture.
std::vector<cv::Point2d> way_over_ground(const CloudMotion& clouds, const Weather& weather,
                                         const Cycle& cycle, int picture_width);

/// A translation over a texture that is cyclic along x. In a loop that lasts long enough for the clouds to cross the
/// picture, they come round a whole number of times, the speed changed by little. In a shorter one that would be a
/// storm: there each cloud dissolves where it has gone, at a time of its own, and forms again where it was. At any
/// time most of the sky is one copy alone, the whole of it at the loop's ends.
class CloudDrift : public Motion {
 public:
  /// box    of the layer, px: far_speed holds at its last row.
  CloudDrift(const CloudCourse& course, const CloudMotion& clouds, const Cycle& cycle, const cv::Rect& box,
             std::uint64_t seed);

  void go_to(int frame) override;
  void go_on_from(int frame) override;
  float reach() const override { return reach_; }
  void row(int copy, int x, int y, int n, float* dx, float* dy) const override;
  bool second(int x, int y, int n, float* part) const override;

 private:
  void go_to_place(int place);
  double speed_at(int y) const;

  CloudCourse course_;
  Cycle cycle_;
  cv::Rect box_;
  double far_speed_ = 1;
  double gone_[2] = {0, 0};     // px at full speed, of both copies
  float reach_ = 0, time_ = 0;  // time: of the loop, 0..1
  double cell_px_ = 1;
  cv::Mat turns_;  // CV_32F: when the cloud at a node dissolves, of the loop; nodes from -margin_ cells on
  int margin_ = 0;
};

}  // namespace freshet::synth::scene
