// tests/harness/noise.h — pictures of noise from a seed.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace freshet {

/// Each value uniform in [low, high).
inline cv::Mat noise(cv::Size size, int type, std::uint64_t seed, double low = 0, double high = 256) {
  cv::Mat out(size, type);
  cv::RNG(seed).fill(out, cv::RNG::UNIFORM, low, high);
  return out;
}

/// CV_32F.
inline cv::Mat normal_noise(cv::Size size, std::uint64_t seed, double mean, double deviation) {
  cv::Mat out(size, CV_32F);
  cv::RNG(seed).fill(out, cv::RNG::NORMAL, mean, deviation);
  return out;
}

}  // namespace freshet
