#include "vision/look/lab_colours.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace freshet::vision {
namespace {

constexpr double kSide = 640;  // px
constexpr int kBins = 24;      // of each of L, a, b

/// Of each pixel the bin of its colour.
cv::Mat bins_of(const cv::Mat& lab) {
  cv::Mat bins(lab.size(), CV_32S);
  const auto bin = [](float share) { return std::clamp(static_cast<int>(share * kBins), 0, kBins - 1); };
  for (int y = 0; y < lab.rows; ++y)
    for (int x = 0; x < lab.cols; ++x) {
      const auto& c = lab.at<cv::Vec3f>(y, x);
      bins.at<int>(y, x) =
          (bin(c[0] / 100) * kBins + bin((c[1] + 60) / 120)) * kBins + bin((c[2] + 60) / 120);
    }
  return bins;
}

/// Log of how frequent each pixel's colour is among pixels so weighed.
cv::Mat log_frequency(const cv::Mat& bins, const cv::Mat& weight) {
  std::vector<float> share(std::size_t{kBins} * kBins * kBins), next(share.size());
  for (int y = 0; y < bins.rows; ++y)
    for (int x = 0; x < bins.cols; ++x)
      share[static_cast<std::size_t>(bins.at<int>(y, x))] += weight.at<float>(y, x);
  float sum = 0;
  for (const float s : share) sum += s;
  for (int pass = 0; pass < 2; ++pass)
    for (const int stride : {1, kBins, kBins * kBins}) {
      for (int i = 0; i < static_cast<int>(share.size()); ++i) {
        const int along = i / stride % kBins;
        const auto at = [&](int step) {
          return along + step < 0 || along + step >= kBins
                     ? 0
                     : share[static_cast<std::size_t>(i + step * stride)];
        };
        next[static_cast<std::size_t>(i)] = .25f * at(-1) + .5f * at(0) + .25f * at(1);
      }
      share.swap(next);
    }
  cv::Mat out(bins.size(), CV_32F);
  for (int y = 0; y < bins.rows; ++y)
    for (int x = 0; x < bins.cols; ++x)
      out.at<float>(y, x) =
          std::log(share[static_cast<std::size_t>(bins.at<int>(y, x))] / (sum + 1e-9f) + 1e-5f);
  return out;
}

}  // namespace

cv::Size worked_size(cv::Size whole) {
  const double scale = kSide / std::max(whole.width, whole.height);
  return {std::max(1, cvRound(whole.width * scale)), std::max(1, cvRound(whole.height * scale))};
}

cv::Mat worked_matte(const cv::Mat& matte) {
  cv::Mat inside;
  cv::resize(matte, inside, worked_size(matte.size()), 0, 0, cv::INTER_AREA);
  return inside > 127;
}

cv::Mat gaussian(const cv::Mat& plane, double sigma) {
  cv::Mat out;
  cv::GaussianBlur(plane, out, {}, sigma);
  return out;
}

cv::Mat lab_of(const cv::Mat& picture) {
  cv::Mat lab;
  picture.convertTo(lab, CV_32F, 1 / 255.);
  cv::cvtColor(lab, lab, cv::COLOR_BGR2Lab);
  return lab;
}

float median(const cv::Mat& plane, const cv::Mat& where) {
  std::vector<float> values;
  for (int y = 0; y < plane.rows; ++y)
    for (int x = 0; x < plane.cols; ++x)
      if (where.at<uchar>(y, x)) values.push_back(plane.at<float>(y, x));
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

float robust_deviation(const cv::Mat& plane, float middle, const cv::Mat& where) {
  return 1.48f * median(cv::abs(plane - middle), where) + 2;
}

cv::Mat log_ratio_beside(const cv::Mat& lab, const cv::Mat& inside) {
  if (cv::countNonZero(inside) == static_cast<int>(inside.total())) return cv::Mat::zeros(lab.size(), CV_32F);
  cv::Mat fluid, away;
  inside.convertTo(fluid, CV_32F, 1 / 255.);
  cv::distanceTransform(~inside, away, cv::DIST_L2, 5);
  cv::exp(away * (-1 / 60.f), away);
  const cv::Mat bins = bins_of(lab);
  return log_frequency(bins, away.mul(1 - fluid)) - log_frequency(bins, fluid);
}

}  // namespace freshet::vision
