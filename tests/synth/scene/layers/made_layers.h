// tests/synth/scene/layers/made_layers.h — small pictures whose layers are known.
#pragma once

#include <cmath>
#include <cstdint>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "platform/random.h"

namespace freshet::synth::scene {

/// A colour with soft noise of it, CV_32FC3 within 0..1.
inline cv::Mat made_texture(cv::Size size, const cv::Scalar& colour, float contrast, std::uint64_t seed) {
  Random random(seed, 0);
  cv::Mat texture(size, CV_32FC3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < 3; ++c)
        texture.at<cv::Vec3f>(y, x)[c] = static_cast<float>(colour[c]) + random.between(-contrast, contrast);
  cv::GaussianBlur(texture, texture, {}, 1.2);
  return cv::min(cv::max(texture, 0.0), 1.0);
}

/// A disc with an edge that goes from 1 to 0 over `soft` px, CV_32F.
inline cv::Mat made_disc(cv::Size size, cv::Point2f middle, float radius, float soft) {
  cv::Mat alpha(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const float r = std::hypot(static_cast<float>(x) - middle.x, static_cast<float>(y) - middle.y);
      alpha.at<float>(y, x) = std::clamp((radius - r) / soft + 0.5f, 0.0f, 1.0f);
    }
  return alpha;
}

inline cv::Mat made_over(const cv::Mat& front, const cv::Mat& alpha, const cv::Mat& behind) {
  cv::Mat out(alpha.size(), CV_32FC3);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const float a = alpha.at<float>(y, x);
      out.at<cv::Vec3f>(y, x) = front.at<cv::Vec3f>(y, x) * a + behind.at<cv::Vec3f>(y, x) * (1 - a);
    }
  return out;
}

inline cv::Mat made_trimap(const cv::Mat& alpha, int wider) {
  const cv::Mat element = cv::Mat::ones(2 * wider + 1, 2 * wider + 1, CV_8U);
  cv::Mat front, behind, trimap(alpha.size(), CV_8U, cv::Scalar(128));
  cv::erode(alpha >= 1, front, element);
  cv::erode(alpha <= 0, behind, element);
  trimap.setTo(255, front);
  trimap.setTo(0, behind);
  return trimap;
}

}  // namespace freshet::synth::scene
