// synth/animate/printed.h — Okabe et al. 2011 as printed: each option of an animation that the paper settles.
#pragma once

#include <vector>

namespace freshet::synth::animate {

struct PrintedOption {
  const char* name;   // "blend": --blend of the command line
  const char* value;  // "paper"
  const char* where;  // "Sec. 6"
};

/// Labels and rendering, and what an unsaid hint is. Sigma, rho and the shutter, which the paper leaves open, are not
/// among them; lambda has its value by default.
const std::vector<PrintedOption>& printed_options();

}  // namespace freshet::synth::animate
