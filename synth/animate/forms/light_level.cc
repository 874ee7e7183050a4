#include "synth/animate/forms/light_level.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "media/picture/light.h"

namespace freshet::synth::animate {
namespace {

constexpr int kSteps = 2048;
using Table = std::array<float, kSteps + 2>;

template <class Value>
Table table_of(const Value& value) {
  Table table;
  for (int i = 0; i < kSteps + 2; ++i) table[i] = value(static_cast<float>(i) / kSteps);
  return table;
}

float read(const Table& table, float at) {
  const float place = std::clamp(at, 0.0f, 1.0f) * kSteps;
  const int below = static_cast<int>(place);
  return table[below] + (place - static_cast<float>(below)) * (table[below + 1] - table[below]);
}

template <float (*of)(float)>
cv::Mat each(const cv::Mat& values) {
  cv::Mat out(values.size(), values.type());
  const int n = values.cols * values.channels();
  for (int y = 0; y < values.rows; ++y) {
    const auto* from = values.ptr<float>(y);
    auto* to = out.ptr<float>(y);
    for (int i = 0; i < n; ++i) to[i] = of(from[i]);
  }
  return out;
}

}  // namespace

float light_of(float level) {
  static const Table table = table_of([](float at) { return media::linear_of(at); });
  return read(table, level);
}

// Steep at its dark end: by the root, of which it is nearly a straight line.
float level_of(float light) {
  static const Table table = table_of([](float at) { return media::coded_of(at * at); });
  return read(table, std::sqrt(std::max(light, 0.0f)));
}

cv::Mat light_of(const cv::Mat& levels) { return each<light_of>(levels); }
cv::Mat level_of(const cv::Mat& light) { return each<level_of>(light); }

}  // namespace freshet::synth::animate
