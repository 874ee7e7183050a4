#include "synth/animate/forms/lit_ground.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synth/animate/forms/light_level.h"

namespace freshet::synth::animate {
namespace {

constexpr int kSide = 160;                            // px that falling light is found on
constexpr float kFarthest = 0.02f, kNearest = 0.25f;  // of the most light: less lights nothing, more all
constexpr float kDarkest = 0.4f, kBrightest = 1.8f;   // times the usual light

}  // namespace

LitGround::LitGround(const PartedStill& still, const cv::Mat& usual, double reach, double lighting)
    : size_(still.level.size()), lighting_(static_cast<float>(lighting)) {
  const double by = std::max(1.0, std::max(size_.width, size_.height) / static_cast<double>(kSide));
  reduced_ = {std::max(1, cvRound(size_.width / by)), std::max(1, cvRound(size_.height / by))};
  sigma_ = std::max(1.0, reach / by);
  usual_ = falling(usual);
  double most = 0;
  cv::minMaxLoc(usual_, nullptr, &most);
  most = std::max(most, 1e-6);
  near_ = (usual_ / most - kFarthest) / (kNearest - kFarthest);
  near_ = cv::min(cv::max(near_, 0.0), 1.0);
  usual_ = cv::max(usual_, 0.01 * most);
}

cv::Mat LitGround::falling(const cv::Mat& level) const {
  cv::Mat out;
  cv::resize(light_of(level), out, reduced_, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(out, out, {}, sigma_, 0, cv::BORDER_REPLICATE);
  return out;
}

cv::Mat LitGround::brightening(const cv::Mat& level, float share) const {
  cv::Mat more = falling(level), out;
  for (int y = 0; y < more.rows; ++y)
    for (int x = 0; x < more.cols; ++x) {
      float& at = more.at<float>(y, x);
      const float change = std::clamp(at / usual_.at<float>(y, x), kDarkest, kBrightest) - 1;
      at = 1 + share * lighting_ * near_.at<float>(y, x) * change;
    }
  cv::resize(more, out, size_, 0, 0, cv::INTER_LINEAR);
  return out;
}

}  // namespace freshet::synth::animate
