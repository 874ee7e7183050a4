// synth/scene/wind/gusts.h — the part of the wind that crosses the picture, so that its things move one after the
// other.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/cycle.h"
#include "synth/scene/scene.h"
#include "synth/scene/wind/weather.h"
#include "synth/scene/wind/wind_spectrum.h"

namespace freshet::synth::scene {

/// Standard deviation of the force on what gives way along `direction` (as Gusts::force), a share of the wind speed's.
double force_strength(const Wind& wind, cv::Point2d direction);

/// One scene's wind: turbulence that is carried along unchanged (Taylor's frozen turbulence), and a share that each
/// place has for itself. Beyond the paper, where one mean wind holds everywhere (its Sec. 5 names gusts as future
/// work); with gustiness 0 every place has only its own.
///
/// Where the wind changes, turbulence is a pattern along the way that the air has gone, read off as it passes: its
/// speed is turbulence * v(t) times the pattern at the integral of v. At any moment it has the spectrum (Eq. 8) and the
/// variance of the wind of that moment; nothing in it jumps, for what changes is how fast and how strongly the same
/// pattern is felt. A loop's pattern is as long as the air goes in it. With a wind that stays it is the same sum of
/// harmonics as without keys, but for those above half the frame rate.
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

  /// What the mean wind adds to these two beyond that of time 0, which the still shows; empty where the wind stays. Its
  /// first harmonic is a mean that is not 0.
  Harmonics mean_force(cv::Point2d direction) const;
  Harmonics mean_force_towards() const;

  /// How much faster than its mean the gusts' wind is at this x and frame, fractions of the mean; 0 without gustiness.
  float strength(double x, int frame) const;
  /// The gusts of the strongest wind alone, as if it stayed.
  Gusts steady() const { return Gusts(weather_.strongest(), cycle_, metre_per_px_); }
  bool any() const { return weather_.gusts(); }
  const Wind& wind() const { return wind_; }
  const Weather& weather() const { return weather_; }

 private:
  Gusts(const Wind& wind, const Cycle& cycle, double metre_per_px);

  double delay_s(double x) const;
  /// The fluctuation along (0), across (1) or upright (2) at a place.
  Harmonics part(int axis, double x, std::uint64_t stream) const;
  /// The same where the wind changes, at the weather's steps but the last.
  std::vector<double> passing(int axis, double x, std::uint64_t stream) const;
  /// Turbulence of 1 along the air's way, evenly over all of it, without what the oscillations of `slow` lack.
  std::vector<double> pattern(std::uint64_t stream, bool slow) const;

  Wind wind_;
  Cycle cycle_;
  Weather weather_;
  double metre_per_px_;
  Harmonics shared_[3];
  std::vector<double> shared_pattern_[3], slow_pattern_;  // where the wind changes
  std::vector<float> slow_;  // the shared fluctuation along the wind without its fast part, at each frame
};

}  // namespace freshet::synth::scene
