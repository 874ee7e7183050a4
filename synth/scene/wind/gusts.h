// synth/scene/wind/gusts.h — the part of the wind that crosses the picture, so that its things move one after the
// other.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/cycle.h"
#include "synth/scene/scene.h"
#include "synth/scene/wind/wind_spectrum.h"

namespace freshet::synth::scene {

/// One scene's wind: turbulence that is carried along unchanged (Taylor's frozen turbulence), and a share that each
/// place has for itself. Beyond the paper, where one mean wind holds everywhere (its Sec. 5 names gusts as future
/// work); with gustiness 0 every place has only its own.
class Gusts {
 public:
  /// picture_width   px, which `wind.width_m` metres span.
  Gusts(const Wind& wind, const Cycle& cycle, int picture_width);

  /// The force on what stands at x (px) and gives way along `direction` in the picture (unit vector, y down), as the
  /// harmonics of a wind speed, m/s (the paper takes the force as proportional to it). What is across the wind
  /// is three quarters as strong, what is upright half (Simiu and Scanlan 1986: 2.5, 2 and 1.3 shear velocities).
  /// stream   of the place's own share.
  Harmonics force(double x, cv::Point2d direction, std::uint64_t stream) const;
  /// The force out of the picture, for foreshortening.
  Harmonics force_towards(double x, std::uint64_t stream) const;

  /// How much faster than its mean the gusts' wind is at this x and frame, fractions of the mean; 0 without gustiness.
  float strength(double x, int frame) const;
  bool any() const { return wind_.gustiness > 0; }
  const Wind& wind() const { return wind_; }

 private:
  double delay_s(double x) const;
  /// The fluctuation along (0), across (1) or upright (2) at a place.
  Harmonics part(int axis, double x, std::uint64_t stream) const;

  Wind wind_;
  Cycle cycle_;
  double metre_per_px_;
  Harmonics shared_[3];
  std::vector<float> slow_;  // the shared fluctuation along the wind without its fast part, at each frame
};

}  // namespace freshet::synth::scene
