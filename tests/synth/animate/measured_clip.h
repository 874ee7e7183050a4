// tests/synth/animate/measured_clip.h — a clip whose metadata know its motion.
#pragma once

#include <utility>

#include "tests/synth/animate/flowing_clip.h"
#include "vision/settings.h"
#include "vision/temporal_spectrum.h"

namespace freshet::synth::animate {

inline FlowingClip measured(FlowingClip clip) {
  vision::MotionAccumulator motion(clip.size, clip.flow_step, 25, vision::Settings{}.spectrum);
  for (int i = 0; i + 1 < clip.frames; ++i) {
    const auto flow = clip.flow(i);
    motion.add(flow[0], flow[1]);
  }
  clip.motion = motion.finish();
  return clip;
}

}  // namespace freshet::synth::animate
