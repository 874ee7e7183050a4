#include "synth/animate/motion/deformation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
namespace {

constexpr double kSigma = 0.05;  // of the longer side, a fraction: sigma
constexpr double kSobel = 8;     // weights of its differences, over two samples
constexpr float kFluid = 0.5f;

/// Differences of a field across and down, for each sample.
struct Slopes {
  cv::Mat across, down;

  explicit Slopes(const cv::Mat& field) {
    cv::Sobel(field, across, CV_32F, 1, 0, 3, 1 / kSobel, 0, cv::BORDER_REPLICATE);
    cv::Sobel(field, down, CV_32F, 0, 1, 3, 1 / kSobel, 0, cv::BORDER_REPLICATE);
  }
};

}  // namespace

cv::Mat strain_rate(const cv::Mat& motion, double step) {
  const Slopes slopes(motion);
  const auto per_px = static_cast<float>(1 / step);
  cv::Mat out(motion.size(), CV_32F);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const cv::Vec2f u = slopes.across.at<cv::Vec2f>(y, x), v = slopes.down.at<cv::Vec2f>(y, x);
      out.at<float>(y, x) = per_px * (std::hypot(u[0] - v[1], v[0] + u[1]) + std::abs(u[0] + v[1])) / 2;
    }
  return out;
}

double vortex(const cv::Mat& directions, const cv::Mat& matte) {
  if (directions.empty()) return 0;
  const double sigma = std::max(directions.cols, directions.rows) * kSigma;
  cv::Mat mean;
  cv::GaussianBlur(directions, mean, {}, sigma, sigma, cv::BORDER_REPLICATE);
  const Slopes slopes(mean);
  float most = 0;
  for (int y = 0; y < mean.rows; ++y)
    for (int x = 0; x < mean.cols; ++x)
      if (matte.at<float>(y, x) > kFluid)
        most = std::max(most,
                        std::abs(slopes.across.at<cv::Vec2f>(y, x)[1] - slopes.down.at<cv::Vec2f>(y, x)[0]));
  return std::min(1.0, most * sigma / std::sqrt(std::numbers::pi / 2));
}

}  // namespace freshet::synth::animate
