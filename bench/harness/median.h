// bench/harness/median.h — the middle one of some runs' figures.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace freshet::bench {

/// The upper one of two middle values. At least one value.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace freshet::bench
