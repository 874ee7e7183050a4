#include "synth/animate/forms/flame_columns.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "platform/smoothstep.h"

namespace freshet::synth::animate {
namespace {

constexpr double kSmallest = 0.004;  // of the longer side: half of a flame's least width that has a bed
constexpr double kBedBeside = 0.02;  // of the same: sigma of columns that share their bed
constexpr float kLeastBed = 0.05f;   // of the columns around: where fewer have a bed there is none
constexpr double kNearFlames =
    0.1;  // of the longer side: light begins to fade so far from flames, is gone twice as far
constexpr double kBelowBed = 0.012;         // of the longer side: over which light ends below the bed
constexpr double kTipBeside = 0.04;         // of the same: sigma of columns that share their tip
constexpr double kGap = 0.02;               // of the same: dark that parts a flame from what burns below it
constexpr float kFoot = 0.2f, kTip = 0.8f;  // of a flame's height

double longer_side(const cv::Mat& level) { return std::max(level.cols, level.rows); }

/// Values of some columns, even over neighbours.
class EvenColumns {
 public:
  explicit EvenColumns(int columns) : sums_(1, columns, CV_32F, cv::Scalar(0)), counts_(sums_.clone()) {}
  void set(int x, int value) {
    sum_ += value, ++count_;
    sums_.at<float>(x) = static_cast<float>(value);
    counts_.at<float>(x) = 1;
  }
  void even(double sigma) {
    for (cv::Mat* row : {&sums_, &counts_})
      cv::GaussianBlur(*row, *row, {0, 1}, sigma, 0, cv::BORDER_CONSTANT);
  }
  /// Of the columns around, how many have a value.
  float known(int x) const { return counts_.at<float>(x); }
  float at(int x) const { return sums_.at<float>(x) / counts_.at<float>(x); }
  /// Far from all of them their mean.
  float at_or_mean(int x) const {
    constexpr float kLittle = 0.01f;
    const auto mean = static_cast<float>(sum_ / std::max(1.0, count_));
    return (sums_.at<float>(x) + kLittle * mean) / (counts_.at<float>(x) + kLittle);
  }
  bool none() const { return count_ == 0; }

 private:
  double sum_ = 0, count_ = 0;
  cv::Mat sums_, counts_;
};

/// Flames that have a bed: specks have none. CV_8U.
cv::Mat whole_flames(const cv::Mat& level) {
  const int speck = 2 * std::max(1, static_cast<int>(std::lround(kSmallest * longer_side(level)))) + 1;
  cv::Mat out;
  cv::morphologyEx(level > kShines, out, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {speck, speck}));
  return out;
}

/// flames  whole_flames.
std::vector<float> lowest_of(const cv::Mat& flames) {
  EvenColumns rows(flames.cols);
  for (int x = 0; x < flames.cols; ++x)
    for (int y = flames.rows - 1; y >= 0; --y)
      if (flames.at<std::uint8_t>(y, x) != 0) {
        rows.set(x, y);
        break;
      }
  rows.even(std::max(1.0, kBedBeside * longer_side(flames)));
  std::vector<float> bed(flames.cols, -1);
  for (int x = 0; x < flames.cols; ++x)
    if (rows.known(x) > kLeastBed) bed[x] = rows.at(x);
  return bed;
}

}  // namespace

std::vector<float> beds_of(const cv::Mat& level) { return lowest_of(whole_flames(level)); }

cv::Mat reach_of(const cv::Mat& level) {
  const double side = longer_side(level), near = kNearFlames * side, below = kBelowBed * side;
  cv::Mat from_any, from_whole, reach(level.size(), CV_32F);
  cv::distanceTransform(level <= kShines, from_any, cv::DIST_L2, 3);
  const cv::Mat flames = whole_flames(level);
  cv::distanceTransform(~flames, from_whole, cv::DIST_L2, 3);
  const std::vector<float> bed = lowest_of(flames);
  for (int x = 0; x < level.cols; ++x)
    for (int y = 0; y < level.rows; ++y) {
      // What shines below a bed may where it is, as faintly as it does, and not around it.
      const float shines = level.at<float>(y, x), away = from_whole.at<float>(y, x);
      const double far = from_any.at<float>(y, x) / near,
                   under = bed[x] < 0         ? 0
                           : shines > kShines ? std::min<double>(away / below, 1 - shines)
                                              : std::min(y - bed[x], away) / below;
      reach.at<float>(y, x) = static_cast<float>(std::clamp(std::min(2 - far, 1 - under), 0.0, 1.0));
    }
  return reach;
}

cv::Mat tips_of(const cv::Mat& level) {
  const cv::Mat flames = whole_flames(level);
  const int gap = std::max(2, static_cast<int>(kGap * longer_side(level)));
  EvenColumns tops(level.cols), feet(level.cols);
  for (int x = 0; x < level.cols; ++x) {
    const auto burns = [&](int y) { return flames.at<std::uint8_t>(y, x) != 0; };
    int top = 0;
    while (top < level.rows && !burns(top)) ++top;
    if (top == level.rows) continue;
    int foot = top;
    for (int y = top; y < level.rows && y - foot <= gap; ++y)
      if (burns(y)) foot = y;
    tops.set(x, top);
    feet.set(x, foot);
  }
  cv::Mat tips = cv::Mat::zeros(level.size(), CV_32F);
  if (tops.none()) return tips;
  const double sigma = std::max(1.0, kTipBeside * longer_side(level));
  tops.even(sigma);
  feet.even(sigma);
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x) {
      const float foot = feet.at_or_mean(x), height = std::max(1.0f, foot - tops.at_or_mean(x));
      tips.at<float>(y, x) = smoothstep(kFoot, kTip, (foot - static_cast<float>(y)) / height);
    }
  return tips;
}

}  // namespace freshet::synth::animate
