// synth/sampling/bilinear.h — a field read between its samples.
#pragma once

#include <algorithm>

#include <opencv2/core.hpp>

namespace freshet::synth::sampling {

/// The value at (x, y), px, samples at whole numbers; beyond the field the outermost go on.
/// Of       the field's element: float (CV_32F), cv::Vec2f (CV_32FC2), cv::Vec3b (CV_8UC3), ...
/// T        the same of floats.
template <class T, class Of = T>
T bilinear(const cv::Mat& field, float x, float y) {
  x = std::clamp(x, 0.0f, static_cast<float>(field.cols - 1));
  y = std::clamp(y, 0.0f, static_cast<float>(field.rows - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, field.cols - 1), y1 = std::min(y0 + 1, field.rows - 1);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const Of* a = field.ptr<Of>(y0);
  const Of* b = field.ptr<Of>(y1);
  return (1 - fy) * ((1 - fx) * T(a[x0]) + fx * T(a[x1])) + fy * ((1 - fx) * T(b[x0]) + fx * T(b[x1]));
}

}  // namespace freshet::synth::sampling
