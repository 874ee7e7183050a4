#include <fmt/format.h>

#include "freshet/error.h"
#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {
namespace {

// Not-a-number is in no range.
void range(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw Error(ErrorKind::kUsage, name, fmt::format("{} is out of range", value),
              fmt::format("Give {} to {}", low, high));
}

}  // namespace

void check(const TransferOptions& options) {
  range("patch", options.patch, 3, 9);
  if (options.patch % 2 == 0) {
    throw Error(ErrorKind::kUsage, "patch", fmt::format("{} is even", options.patch), "Give 3, 5, 7 or 9");
  }
  range("lambda", options.lambda, 0, 1);
  range("eta", options.eta, 0, 16);
  range("curvature", options.curvature, 0, 16);
  range("divergence", options.divergence, 0, 16);
  range("radius", options.radius, 0.5, 50);
  range("lower", options.lower, 0, 1);
  range("upper", options.upper, 0, 1);
  if (options.lower >= options.upper) {
    throw Error(ErrorKind::kUsage, "lower",
                fmt::format("{} is not below upper, {}", options.lower, options.upper),
                "Give thresholds in order");
  }
  range("levels", options.levels, 0, 10);
  range("iterations", options.iterations, 1, 100);
  range("passes", options.passes, 1, 100);
  range("vote_power", options.vote_power, 0, 4);
  if (options.quarter_turns != 1 && options.quarter_turns != 4) {
    throw Error(ErrorKind::kUsage, "quarter_turns",
                fmt::format("{} is neither 1 nor 4", options.quarter_turns));
  }
  range("motion_blur", options.motion_blur, 0, 4);
}

bool SegmentUse::uniform() const {
  std::int64_t once_more = 0, sum = 0;
  for (std::size_t n = 0; n < sources_used.size(); ++n) {
    const std::int64_t patches = sources_used[n], uses = static_cast<std::int64_t>(n);
    if (patches != 0 && uses != min_uses && uses != min_uses + 1) return false;
    if (uses == min_uses + 1) once_more += patches;
    sum += patches * uses;
  }
  return once_more == remainder && sum == targets;
}

}  // namespace freshet::synth::transfer
