#include "synth/scene/rendering/layer_glow.h"

#include <algorithm>
#include <cmath>

namespace freshet::synth::scene {
namespace {

constexpr double kUsualReach = 0.2;  // of the picture's longer side
constexpr double kSomeLight = 1e-3;  // mean of a frame: less is none

}  // namespace

LayerGlow::LayerGlow(double glow, std::optional<double> reach_px, cv::Size picture)
    : glow_(glow),
      reach_px_(reach_px.value_or(kUsualReach * std::max(picture.width, picture.height))),
      falloff_(picture, CV_32F, cv::Scalar(0)),
      light_{.falloff = &falloff_} {}

void LayerGlow::see(const cv::Mat& frame, cv::Point at) {
  const cv::Scalar sum = frame.empty() ? cv::Scalar() : cv::sum(frame);
  const double whole = sum[0] + sum[1] + sum[2];
  if (whole_ == 0 && whole > kSomeLight * static_cast<double>(frame.total())) {
    whole_ = whole;
    colour_ = sum / std::max({sum[0], sum[1], sum[2]});
    cv::Point2d middle{};
    for (int y = 0; y < frame.rows; ++y) {
      const auto* row = frame.ptr<cv::Vec4f>(y);
      for (int x = 0; x < frame.cols; ++x)
        middle += cv::Point2d(at.x + x, at.y + y) * ((row[x][0] + row[x][1] + row[x][2]) / whole);
    }
    for (int y = 0; y < falloff_.rows; ++y)
      for (int x = 0; x < falloff_.cols; ++x) {
        const double far = std::hypot(x - middle.x, y - middle.y) / reach_px_;
        falloff_.at<float>(y, x) = static_cast<float>(1 / (1 + far * far));
      }
  }
  const double level = whole_ > 0 ? whole / whole_ : 1;
  for (int c = 0; c < 3; ++c)
    light_.gain[static_cast<std::size_t>(c)] = static_cast<float>(glow_ * (level - 1) * colour_[c]);
}

}  // namespace freshet::synth::scene
