#include "synth/scene/rendering/glitter_glow.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::scene {
namespace {

float luma_of(const cv::Vec4f& colour) {
  return 0.114f * colour[0] + 0.587f * colour[1] + 0.299f * colour[2];
}

}  // namespace

GlitterGlow::GlitterGlow(double glow, std::optional<double> reach_px, const cv::Mat& still)
    : glints_(still.size(), CV_32F),
      falloff_(still.size(), CV_32F, cv::Scalar(0)),
      light_{.falloff = &falloff_} {
  const double reach = reach_px.value_or(kUsualReach * std::max(still.cols, still.rows));
  const double sigma = reach / std::sqrt(2 * std::log(2.0)), cell = std::max(1.0, sigma / 3);
  sigma_cells_ = sigma / cell;
  cells_ = {std::max(1, cvRound(still.cols / cell)), std::max(1, cvRound(still.rows / cell))};
  double whole = 0, sum = 0, square = 0;
  for (int y = 0; y < still.rows; ++y)
    for (const cv::Vec4f& colour : cv::Mat_<cv::Vec4f>(still.row(y))) {
      const double luma = luma_of(colour);
      whole += colour[3];
      sum += luma;
      square += luma * luma;
    }
  if (whole == 0) return;
  const double mean = sum / whole;
  threshold_ = static_cast<float>(mean + std::sqrt(std::max(0.0, square / whole - mean * mean)));
  gather(still, still_);
  cv::minMaxLoc(still_, nullptr, &brightest_);
  cv::Scalar colour;
  for (int y = 0; y < still.rows; ++y)
    for (int x = 0; x < still.cols; ++x)
      if (glints_.at<float>(y, x) > 0) colour += cv::Scalar(still.at<cv::Vec4f>(y, x));
  const double strongest = std::max({colour[0], colour[1], colour[2], 1e-9});
  for (int c = 0; c < 3; ++c)
    light_.gain[static_cast<std::size_t>(c)] = static_cast<float>(glow * colour[c] / strongest);
}

void GlitterGlow::gather(const cv::Mat& water, cv::Mat& out) {
  oneapi::tbb::parallel_for(0, water.rows, [&](int y) {
    const auto* from = water.ptr<cv::Vec4f>(y);
    auto* to = glints_.ptr<float>(y);
    for (int x = 0; x < water.cols; ++x) to[x] = std::max(0.0f, luma_of(from[x]) - threshold_ * from[x][3]);
  });
  cv::resize(glints_, out, cells_, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(out, out, {}, sigma_cells_);
}

void GlitterGlow::see(const cv::Mat& water) {
  if (!(brightest_ > 0)) return;
  gather(water, now_);
  cv::scaleAdd(still_, -1, now_, now_);
  now_ *= 1 / brightest_;
  cv::resize(now_, falloff_, falloff_.size(), 0, 0, cv::INTER_LINEAR);
}

}  // namespace freshet::synth::scene
