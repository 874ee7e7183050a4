// tests/synth/stills/made_stills.h — stills whose truth is known: discs that swing to and fro on a textured ground.
#pragma once

#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::stills {

inline cv::Mat made_ground(cv::Size size, int seed = 5) {
  cv::Mat ground(size, CV_8UC3);
  cv::RNG random(static_cast<std::uint64_t>(seed));
  random.fill(ground, cv::RNG::UNIFORM, 20, 120);
  cv::GaussianBlur(ground, ground, {}, 2);
  return ground;
}

/// A bright disc whose middle lies `phase` of the way from left to right of the box.
inline void draw_pendulum(cv::Mat& picture, const cv::Rect& box, double phase) {
  const double radius = box.height * .3, x = box.x + radius + phase * (box.width - 2 * radius);
  const double y = box.y + box.height * .5;
  cv::circle(picture, cv::Point(cvRound(x * 16), cvRound(y * 16)), cvRound(radius * 16),
             cv::Scalar(210, 230, 250), cv::FILLED, cv::LINE_AA, 4);
}

/// One still for each phase.
inline std::vector<cv::Mat> made_pendulum(const std::vector<double>& phases, cv::Size size = {160, 96}) {
  std::vector<cv::Mat> stills;
  const cv::Mat ground = made_ground(size);
  for (const double phase : phases) {
    stills.push_back(ground.clone());
    draw_pendulum(stills.back(), {20, 24, size.width - 40, 48}, phase);
  }
  return stills;
}

}  // namespace freshet::synth::stills
