// synth/scene/wind/weather.h — a wind that changes over the film (Chuang et al. 2005, Sec. 5: from calm to storm).
#pragma once

#include <vector>

#include "synth/scene/cycle.h"
#include "synth/scene/scene.h"
#include "synth/scene/wind/monotone_curve.h"

namespace freshet::synth::scene {

/// The wind of each moment: speed, direction and gustiness by monotone curves through the wind's keys, the direction by
/// the short way round (by the left where both ways are half a turn). Before the first key a value goes on from
/// the wind's own, after its last it stays. All is periodic with the cycle: a wind that does not end as it begins goes
/// back within the cycle's last seconds (kAfterwardsS), which no film shows.
class Weather {
 public:
  static constexpr int kSteps = 4;  // a frame, for what is integrated over time

  /// Throws nothing; wind.at's times grow.
  Weather(const Wind& wind, const Cycle& cycle);

  bool changes() const { return wind_.changes(); }
  /// The wind of a moment, without keys; 0 <= seconds <= cycle.seconds().
  Wind at(double seconds) const;
  Wind at_frame(int frame) const { return at(cycle_.place(frame) / cycle_.fps); }

  /// The wind at its fastest, without keys. What a layer says in px holds for it.
  const Wind& strongest() const { return strongest_; }
  double calmest_m_per_s() const { return calmest_; }
  /// Whether any of it crosses the picture at any time.
  bool gusts() const { return gusts_; }

  struct Step {
    double speed_m_per_s, cosine, sine, gustiness;
    double gone_m;  // that the air went since the beginning, whatever its direction
  };
  /// kSteps a frame, from the cycle's beginning to its end, which is there too; empty where nothing changes.
  const std::vector<Step>& steps() const { return steps_; }

  /// s, growing from 0 to the last key's time: four steps from one key to the next, fewer where keys are many, and
  /// some fifty at most.
  std::vector<double> knots_s() const;

 private:
  Wind wind_;
  Cycle cycle_;
  MonotoneCurve speed_, direction_, gustiness_;
  Wind strongest_;
  double calmest_ = 0;
  bool gusts_ = false;
  std::vector<Step> steps_;
};

}  // namespace freshet::synth::scene
