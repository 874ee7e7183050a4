// synth/toml/range.h — what a number may be.
#pragma once

namespace freshet::synth {

/// Smallest and greatest value that a key takes.
struct Range {
  double low, high;
};

}  // namespace freshet::synth
