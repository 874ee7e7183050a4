// tests/vision/made_texture.h — a picture with detail of some pixels everywhere.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace freshet::vision {

/// Blurred noise, CV_8U; the same each time.
inline cv::Mat made_noise(cv::Size size) {
  cv::Mat noise(size, CV_8U);
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(noise, noise, {}, 2);
  return noise;
}

/// The same over the whole range of grey.
inline cv::Mat made_texture(cv::Size size) {
  cv::Mat texture = made_noise(size);
  cv::normalize(texture, texture, 0, 255, cv::NORM_MINMAX);
  return texture;
}

}  // namespace freshet::vision
