// tests/bench/quality/still_and_flow.h — a still of grain, a flow that is the same everywhere, and how far films part.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace freshet::bench {

/// CV_8UC3: noise, blurred by a Gaussian of sigma px.
inline cv::Mat grain_of(cv::Size size, double sigma) {
  cv::Mat still(size, CV_8UC3);
  cv::RNG random(4);
  random.fill(still, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(still, still, {}, sigma);
  return still;
}
inline cv::Mat all_of(cv::Size size) { return cv::Mat(size, CV_8U, cv::Scalar(255)); }
inline cv::Mat flow_of(cv::Size size, float u, float v) { return cv::Mat(size, CV_32FC2, cv::Scalar(u, v)); }

/// Grey levels between two CV_8UC3, mean of all values.
inline double levels_apart(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total() * 3);
}

}  // namespace freshet::bench
