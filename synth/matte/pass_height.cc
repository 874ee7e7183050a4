#include "synth/matte/pass_height.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::matte {
namespace {

constexpr double kSmoothing = 1.5;  // px: fluids' own texture is no pass

}  // namespace

cv::Mat steepness(const cv::Mat& picture) {
  cv::Mat lab, x, y;
  picture.convertTo(lab, CV_32F, 1 / 255.0);
  cv::cvtColor(lab, lab, cv::COLOR_BGR2Lab);
  cv::GaussianBlur(lab, lab, {}, kSmoothing);
  cv::Sobel(lab, x, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(lab, y, CV_32F, 0, 1, 3, 0.125);
  cv::Mat steep(picture.size(), CV_32F);
  for (int row = 0; row < steep.rows; ++row)
    for (int column = 0; column < steep.cols; ++column)
      steep.at<float>(row, column) =
          static_cast<float>(std::sqrt(x.at<cv::Vec3f>(row, column).dot(x.at<cv::Vec3f>(row, column)) +
                                       y.at<cv::Vec3f>(row, column).dot(y.at<cv::Vec3f>(row, column))));
  return steep;
}

cv::Mat pass_heights(const cv::Mat& relief, const cv::Mat& seeds) {
  using Entry = std::pair<float, int>;  // height, pixel
  cv::Mat heights(relief.size(), CV_32F, cv::Scalar(FLT_MAX));
  auto* const least = heights.ptr<float>();
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (int i = 0; i < static_cast<int>(relief.total()); ++i)
    if (seeds.at<std::uint8_t>(i / relief.cols, i % relief.cols) != 0) {
      least[i] = 0;
      open.emplace(0.0F, i);
    }
  while (!open.empty()) {
    const auto [height, i] = open.top();
    open.pop();
    if (height > least[i]) continue;
    const cv::Point at(i % relief.cols, i / relief.cols);
    for (const cv::Point step : {cv::Point(-1, 0), cv::Point(1, 0), cv::Point(0, -1), cv::Point(0, 1)}) {
      const cv::Point next = at + step;
      if (next.x < 0 || next.y < 0 || next.x >= relief.cols || next.y >= relief.rows) continue;
      const int j = next.y * relief.cols + next.x;
      const float over = std::max(height, relief.at<float>(next));
      if (over >= least[j]) continue;
      least[j] = over;
      open.emplace(over, j);
    }
  }
  return heights;
}

}  // namespace freshet::synth::matte
