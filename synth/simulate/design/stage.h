// synth/simulate/design/stage.h — what all parts of a staged design look up: sizes, time, and noise.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "synth/simulate/scene/design.h"
#include "synth/simulate/solver/noise.h"

namespace freshet::synth::simulate {

struct Stage {
  cv::Size picture;  // px
  cv::Size cells;    // of the flow, over the same area
  double fps = 25;
  float step_s = 0;    // seconds per step of the simulation
  double clock_s = 0;  // now, from frame 0; negative in the warm-up
  Noise noise;

  /// Where on the axis of time noise is read now.
  float noise_time() const { return static_cast<float>(clock_s + 512.0); }
  /// Cells per step for one height per second.
  float speed_unit() const { return static_cast<float>(cells.height) * step_s; }
};

}  // namespace freshet::synth::simulate
