// synth/scene/rendering/cloud_shade.h — shadows of clouds glide over the land.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/cycle.h"
#include "synth/scene/scene.h"
#include "synth/scene/water/camera.h"
#include "synth/scene/wind/weather.h"

namespace freshet::synth::scene {

/// Clouds that shade the land are not those that the picture shows: they stand above the viewer. So their shadows are
/// smooth noise on the ground's plane, which two fifths of it exceed, with soft rims. They go where the wind does, in
/// the foreground as many pixels a second as the clouds of the sky, further away by perspective. Towards the horizon,
/// where they would be streaks across all that stands there, they fade.
///
/// In a loop the noise of the beginning goes over into the noise that has come as far, its variance kept: shadows glide
/// without an end, and change their forms within the loop.
class CloudShade {
 public:
  /// clouds     `shade` above 0. horizon   of the ground, px; the picture's last row lies below it.
  CloudShade(const CloudMotion& clouds, const Line& horizon, const Weather& weather, const Cycle& cycle,
             bool loop, std::uint64_t seed, cv::Size picture);

  void go_to(int frame);
  /// What of the light comes down to each pixel of the frame, 0..1, CV_32F of the picture's size; overwritten. The same
  /// for any number of threads. Cost: two samples of the noise for each of some 100 000 nodes.
  void light(cv::Mat& out);
  /// The same for what stands at a place, px.
  float light_at(cv::Point2d foot) const;

 private:
  /// In samples of the noise to the right and away, and how much is seen of shadows there, 0..1.
  cv::Vec3f ground(double x, double y) const;
  float light_on(const cv::Vec3f& ground) const;

  double darkness_, size_px_;
  bool loop_;
  Cycle cycle_;
  cv::Size picture_;
  WaterCamera camera_;             // above the ground, 1 m wide where a pixel is of its last row
  std::vector<cv::Point2d> gone_;  // samples, at each frame of the cycle and at its end
  cv::Mat noise_;                  // CV_32F, periodic; mean 0, variance 1
  cv::Mat ground_, nodes_;         // CV_32FC3, CV_32F
  cv::Vec2f at_[2];                // samples: where both copies have gone to
  float second_ = 0, gain_ = 1;    // share of the second copy; what keeps the variance
  float likeness_ = 0;             // correlation of both
};

}  // namespace freshet::synth::scene
