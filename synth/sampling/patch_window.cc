#include "synth/sampling/patch_window.h"

#include <algorithm>
#include <cmath>

#include "platform/vectors.h"
#include "synth/sampling/cubic.h"

namespace freshet::synth::sampling {
namespace {

FRESHET_WIDE void cut_turned(const float* plane, std::ptrdiff_t stride, const std::int32_t* x,
                             const std::int32_t* y, int n, float* out) {
  cubic(plane, 0, stride, x, y, n, out);
}

/// The same where samples are missing beyond the plane's edges: those on the edge go on.
float cubic_at_edge(const cv::Mat& plane, std::int32_t x, std::int32_t y) {
  const auto &wx = kCubic.of[x & (kCubicSteps - 1)], &wy = kCubic.of[y & (kCubicSteps - 1)];
  float sum = 0;
  for (int i = 0; i < 4; ++i) {
    const float* row = plane.ptr<float>(std::clamp((y >> kCubicShift) - 1 + i, 0, plane.rows - 1));
    float across = 0;
    for (int k = 0; k < 4; ++k)
      across += wx[k] * row[std::clamp((x >> kCubicShift) - 1 + k, 0, plane.cols - 1)];
    sum += wy[i] * across;
  }
  return sum;
}

}  // namespace

cv::Size reduced_to_scale(cv::Size frame, float scale) {
  return {std::max(1, static_cast<int>(std::lround(frame.width * scale))),
          std::max(1, static_cast<int>(std::lround(frame.height * scale)))};
}

PatchWindow::PatchWindow(cv::Size source, const vision::Variant& variant, cv::Point patch, int side)
    : side_(side) {
  const vision::VariantFrame frame = vision::variant_frame(source, variant);
  const cv::Size reduced = reduced_to_scale(source, variant.scale);
  const double scale_x = static_cast<double>(reduced.width) / source.width;
  const double scale_y = static_cast<double>(reduced.height) / source.height;
  const auto source_at = [&](double x, double y) -> cv::Point2d {
    const cv::Vec2d p = frame.source_from_variant * cv::Vec3d(x, y, 1);
    return {p[0], p[1]};
  };
  const auto reduced_at = [&](double x, double y) -> cv::Point2d {
    const cv::Point2d p = source_at(x, y);
    return {(p.x + 0.5) * scale_x - 0.5, (p.y + 0.5) * scale_y - 0.5};
  };

  // The source pixels under the window's corners, and a margin for reduction and interpolation.
  cv::Point2d low(1e9, 1e9), high(-1e9, -1e9);
  for (int corner = 0; corner < 4; ++corner) {
    const cv::Point2d p =
        source_at(patch.x + (corner & 1 ? side - 1 : 0), patch.y + (corner & 2 ? side - 1 : 0));
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const int margin = static_cast<int>(std::ceil(3 / variant.scale));
  needed_ = cv::Rect(cv::Point(static_cast<int>(std::floor(low.x)) - margin,
                               static_cast<int>(std::floor(low.y)) - margin),
                     cv::Point(static_cast<int>(std::ceil(high.x)) + margin + 1,
                               static_cast<int>(std::ceil(high.y)) + margin + 1)) &
            cv::Rect({}, source);

  upright_ = variant.rotation_deg == 0;
  mirrored_ = variant.flip;
  if (upright_) {
    const cv::Point2d a = reduced_at(patch.x, patch.y), b = reduced_at(patch.x + side - 1, patch.y);
    window_ = cv::Rect(static_cast<int>(std::lround(std::min(a.x, b.x))), static_cast<int>(std::lround(a.y)),
                       side, side);
    // Rounding of the reduced size can push a window over the edge by a pixel.
    window_.x = std::clamp(window_.x, 0, std::max(0, reduced.width - side));
    window_.y = std::clamp(window_.y, 0, std::max(0, reduced.height - side));
    upright_ = window_.br().x <= reduced.width && window_.br().y <= reduced.height;
  }
  const cv::Rect whole({}, reduced);
  if (upright_) {
    read_ = window_;
    return;
  }
  x_.resize(static_cast<std::size_t>(side) * side);
  y_.resize(x_.size());
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const cv::Point2d p = reduced_at(patch.x + column, patch.y + row);
      x_[row * side + column] = static_cast<std::int32_t>(std::lround(p.x * kCubicSteps));
      y_[row * side + column] = static_cast<std::int32_t>(std::lround(p.y * kCubicSteps));
    }
  const auto [left, right] = std::minmax_element(x_.begin(), x_.end());
  const auto [top, bottom] = std::minmax_element(y_.begin(), y_.end());
  const cv::Rect around(cv::Point((*left >> kCubicShift) - 1, (*top >> kCubicShift) - 1),
                        cv::Point((*right >> kCubicShift) + 3, (*bottom >> kCubicShift) + 3));
  inside_ = (around & whole) == around;
  read_ = around & whole;
  if (!inside_) {
    // A window beside the frame still reads its edge.
    const cv::Point nearest(std::clamp(around.x, 0, reduced.width - 1),
                            std::clamp(around.y, 0, reduced.height - 1));
    read_ |= cv::Rect(nearest, cv::Size(1, 1));
    const cv::Point farthest(std::clamp(around.br().x - 1, 0, reduced.width - 1),
                             std::clamp(around.br().y - 1, 0, reduced.height - 1));
    read_ |= cv::Rect(farthest, cv::Size(1, 1));
  }
}

void PatchWindow::cut(const cv::Mat& reduced, cv::Mat& out) const {
  if (upright_ && mirrored_) {
    cv::flip(reduced(window_), out, 1);
  } else if (upright_) {
    reduced(window_).copyTo(out);
  } else {
    out.create(side_, side_, CV_32F);
    if (inside_)
      cut_turned(reduced.ptr<float>(), static_cast<std::ptrdiff_t>(reduced.step1()), x_.data(), y_.data(),
                 side_ * side_, out.ptr<float>());
    else
      for (int i = 0; i < side_ * side_; ++i) out.ptr<float>()[i] = cubic_at_edge(reduced, x_[i], y_[i]);
  }
}

}  // namespace freshet::synth::sampling
