// tests/synth/judging/grain.h — frames of grain alone, without a film around them.
#pragma once

#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "tests/harness/noise.h"

namespace freshet::synth::judging {

inline const cv::Size kSize(160, 96);

/// The matte of a film that is all fluid.
inline cv::Mat everywhere() { return cv::Mat(kSize, CV_8U, cv::Scalar(255)); }

/// Luma, CV_8U, the same for a seed.
inline cv::Mat grain(int seed) {
  cv::Mat luma = noise(kSize, CV_8U, static_cast<std::uint64_t>(seed) * 0x9E3779B97F4A7C15u, 60, 196);
  cv::GaussianBlur(luma, luma, {}, 1.5);
  return luma;
}

}  // namespace freshet::synth::judging
