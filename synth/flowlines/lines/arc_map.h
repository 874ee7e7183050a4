// synth/flowlines/lines/arc_map.h — which place of the input line a place of an edited line shows.
#pragma once

#include <vector>

#include "synth/flowlines/lines/flow_line.h"

namespace freshet::synth::flowlines {

enum class Correspondence {
  kEqual,      // points at equal arc lengths correspond: texture keeps its size, and its speed
  kStretched,  // the input line's whole length goes onto the edited line's
};

/// The input line's arc length at an edited line's. Where the edited line's speed is v, texture is drawn out to v times
/// its length, and so goes v times as fast. Beyond the edited line's ends it goes on as there.
class ArcMap {
 public:
  ArcMap(const FlowLine& edited, const FlowLine& input, Correspondence correspondence);
  float operator()(float arc) const;

 private:
  std::vector<float> at_;  // by sample of the edited line, never falling; two at least
};

}  // namespace freshet::synth::flowlines
