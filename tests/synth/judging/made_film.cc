#include "tests/synth/judging/made_film.h"

#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::judging {
namespace {

constexpr int kRenewed = 8;  // frames from one layer to the next

/// CV_32F, deviation 24, mean 0.
cv::Mat layer(std::uint64_t seed, cv::Size size) {
  cv::Mat values(size, CV_32F);
  cv::RNG random(seed * 0x9E3779B97F4A7C15u);
  random.fill(values, cv::RNG::NORMAL, 0, 1);
  cv::GaussianBlur(values, values, {}, 1.5);
  cv::Scalar mean, deviation;
  cv::meanStdDev(values, mean, deviation);
  return (values - mean[0]) * (24 / deviation[0]);
}

cv::Mat coloured(const cv::Mat& values) {
  cv::Mat bgr;
  cv::merge(std::vector<cv::Mat>{values + 140, values + 128, values + 110}, bgr);
  bgr.convertTo(bgr, CV_8UC3);
  return bgr;
}

}  // namespace

cv::Mat made_grain(std::uint64_t seed, cv::Size size) { return coloured(layer(seed, size)); }

Evidence made_film(const Fault& fault, int frames) {
  const cv::Size wide(kMadeSize.width + frames, kMadeSize.height);
  const auto frame_of = [&](int number) {
    const int index = number / kRenewed;
    const double gone = static_cast<double>(number % kRenewed) / kRenewed;
    const cv::Mat one = layer(static_cast<std::uint64_t>(index) + 1, wide),
                  next = layer(static_cast<std::uint64_t>(index) + 2, wide);
    const cv::Mat mixed = std::sqrt(1 - gone) * one + std::sqrt(gone) * next;
    return coloured(mixed(cv::Rect(cv::Point(frames - number, 0), kMadeSize)));
  };
  cv::Mat matte(kMadeSize, CV_8U, cv::Scalar(0));
  matte(cv::Rect(8, 8, kMadeSize.width - 16, kMadeSize.height - 16)) = 255;
  const cv::Mat still = frame_of(0);
  Evidence film(still, matte, 25);
  for (int i = 0; i < frames; ++i) {
    cv::Mat frame = frame_of(i);
    if (fault) fault(frame, i);
    film.add(frame);
  }
  return film;
}

}  // namespace freshet::synth::judging
