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

/// Of every cell of a clip of FlowingClip's size, how much of its local contrast stays, and how much goes along.
inline vision::CellMap contrasts(float stays, float goes) {
  vision::CellMap made{
      .rows = 4, .columns = 5, .channels = vision::kLayoutChannels, .cell = 32, .values = {}};
  for (int i = 0; i < made.rows * made.columns; ++i)
    for (int channel = 0; channel < vision::kLayoutChannels; ++channel)
      made.values.push_back(channel < vision::kLifeBands ? stays : goes);
  return made;
}

/// Of every cell of a clip of FlowingClip's size, how long each band lives.
inline vision::CellMap living(float life_s) {
  vision::CellMap made{.rows = 4, .columns = 5, .channels = vision::kLifeChannels, .cell = 32, .values = {}};
  for (int i = 0; i < made.rows * made.columns; ++i)
    for (int channel = 0; channel < vision::kLifeChannels; ++channel)
      made.values.push_back(channel < vision::kLifeBands ? life_s : 0.01f);
  return made;
}

}  // namespace freshet::synth::animate
