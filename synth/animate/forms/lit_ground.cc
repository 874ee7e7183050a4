#include "synth/animate/forms/lit_ground.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "synth/animate/forms/light_level.h"

namespace freshet::synth::animate {
namespace {

constexpr int kSide = 160;  // px that falling light is found on
constexpr float kFarthest = 0.02f,
                kNearest = 0.25f;             // of the most light: less lights nothing by day, more all
constexpr double kWide = 5;                   // times the reach: of the light that goes far
constexpr double kFaintest = 0.003;           // of the most light: of less no share is taken
constexpr float kNight = 0.05f, kDay = 0.2f;  // level of the ground's darkest quarter
constexpr float kDarkest = 0.4f, kBrightest = 1.8f;  // times the usual light

/// 1: nothing but fire lights this ground (CV_32FC3, light), to 0.
double darkness_of(const cv::Mat& ground) {
  cv::Mat luma;
  cv::cvtColor(ground, luma, cv::COLOR_BGR2GRAY);
  std::vector<float> each(luma.begin<float>(), luma.end<float>());
  const auto quarter = each.begin() + static_cast<std::ptrdiff_t>(each.size() / 4);
  std::nth_element(each.begin(), quarter, each.end());
  return std::clamp((kDay - level_of(*quarter)) / (kDay - kNight), 0.0f, 1.0f);
}

}  // namespace

LitGround::LitGround(const PartedStill& still, const cv::Mat& usual, double reach, double lighting)
    : size_(still.level.size()), darkness_(darkness_of(still.ground)) {
  const double by = std::max(1.0, std::max(size_.width, size_.height) / static_cast<double>(kSide));
  reduced_ = {std::max(1, cvRound(size_.width / by)), std::max(1, cvRound(size_.height / by))};
  sigma_ = std::max(1.0, reach / by);
  double most = 0;
  near_ = nearby(usual);
  cv::minMaxLoc(near_, nullptr, &most);
  near_ = (near_ / std::max(most, 1e-6) - kFarthest) / (kNearest - kFarthest);
  near_ = cv::max(lighting * cv::min(cv::max(near_, 0.0), 1.0), darkness_);
  usual_ = falling(usual);
  cv::minMaxLoc(usual_, nullptr, &most);
  usual_ = cv::max(usual_, kFaintest * std::max(most, 1e-6));
}

cv::Mat LitGround::nearby(const cv::Mat& level) const {
  cv::Mat out;
  cv::resize(light_of(level), out, reduced_, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(out, out, {}, sigma_, 0, cv::BORDER_REPLICATE);
  return out;
}

cv::Mat LitGround::falling(const cv::Mat& level) const {
  const cv::Mat near = nearby(level);
  cv::Mat far;
  cv::resize(near, far, {(near.cols + 3) / 4, (near.rows + 3) / 4}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(far, far, {}, kWide * sigma_ / 4, 0, cv::BORDER_REPLICATE);
  cv::resize(far, far, reduced_, 0, 0, cv::INTER_LINEAR);
  return near + far;
}

cv::Mat LitGround::brightening(const cv::Mat& level, float share) const {
  cv::Mat more = falling(level), out;
  for (int y = 0; y < more.rows; ++y)
    for (int x = 0; x < more.cols; ++x) {
      float& at = more.at<float>(y, x);
      const float change = std::clamp(at / usual_.at<float>(y, x), kDarkest, kBrightest) - 1;
      at = 1 + share * near_.at<float>(y, x) * change;
    }
  cv::resize(more, out, size_, 0, 0, cv::INTER_LINEAR);
  return out;
}

}  // namespace freshet::synth::animate
