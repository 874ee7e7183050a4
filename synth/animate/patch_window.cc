#include "synth/animate/patch_window.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace freshet::synth {
namespace {

cv::Size reduced_size(cv::Size source, float scale) {
  return {std::max(1, static_cast<int>(std::lround(source.width * scale))),
          std::max(1, static_cast<int>(std::lround(source.height * scale)))};
}

}  // namespace

void reduce_to_scale(const cv::Mat& frame, float scale, cv::Mat& out) {
  if (scale == 1)
    out = frame;
  else
    cv::resize(frame, out, reduced_size(frame.size(), scale), 0, 0, cv::INTER_AREA);
}

PatchWindow::PatchWindow(cv::Size source, const vision::Variant& variant, cv::Point patch, int side)
    : side_(side) {
  const vision::VariantFrame frame = vision::variant_frame(source, variant);
  const cv::Size reduced = reduced_size(source, variant.scale);
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
  if (!upright_) {
    cv::Mat x(side, side, CV_32F), y(side, side, CV_32F);
    for (int row = 0; row < side; ++row)
      for (int column = 0; column < side; ++column) {
        const cv::Point2d p = reduced_at(patch.x + column, patch.y + row);
        x.at<float>(row, column) = static_cast<float>(p.x);
        y.at<float>(row, column) = static_cast<float>(p.y);
      }
    cv::convertMaps(x, y, x_, y_, CV_16SC2);
  }
}

void PatchWindow::cut(const cv::Mat& reduced, cv::Mat& out) const {
  if (!upright_)
    cv::remap(reduced, out, x_, y_, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  else if (mirrored_)
    cv::flip(reduced(window_), out, 1);
  else
    reduced(window_).copyTo(out);
}

}  // namespace freshet::synth
