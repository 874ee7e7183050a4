// synth/scene/motion/stillness.h — what does not move, or brings its own frames.
#pragma once

#include <algorithm>

#include "synth/scene/motion/motion.h"

namespace freshet::synth::scene {

class Stillness : public Motion {
 public:
  void go_to(int) override {}
  float reach() const override { return 0; }
  void row(int, int, int, int n, float* dx, float* dy) const override {
    std::fill(dx, dx + n, 0.0f);
    std::fill(dy, dy + n, 0.0f);
  }
};

}  // namespace freshet::synth::scene
