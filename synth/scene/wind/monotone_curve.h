// synth/scene/wind/monotone_curve.h — a smooth curve through points that never overshoots them.
#pragma once

#include <vector>

namespace freshet::synth::scene {

/// Cubic between its points, with a continuous slope; between two points it only rises or only falls, and before the
/// first and after the last it holds their values.
/// Source   Fritsch and Butland 1984: a slope is the weighted harmonic mean of those of the chords at both sides, and 0
///          where they differ in sign and at both ends.
class MonotoneCurve {
 public:
  /// times   growing. values   as many, at least one.
  MonotoneCurve(std::vector<double> times, std::vector<double> values);

  double at(double time) const;

 private:
  std::vector<double> times_, values_, slopes_;
};

}  // namespace freshet::synth::scene
