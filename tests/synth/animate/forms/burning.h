// tests/synth/animate/forms/burning.h — fires that a test knows all of: in clips and in pictures.
#pragma once

#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/synth/animate/flowing_clip.h"
#include "vision/settings.h"
#include "vision/temporal_spectrum.h"

namespace freshet::synth::animate {

/// A flame as a triangle, soft at its sides: how much of each pixel is flame, CV_32F 0..1.
inline cv::Mat flame(cv::Size size, cv::Point bed, int width, int height, double lean = 0) {
  cv::Mat out = cv::Mat::zeros(size, CV_32F);
  const std::vector<cv::Point> corners{{bed.x - width / 2, bed.y},
                                       {bed.x + width / 2, bed.y},
                                       {bed.x + static_cast<int>(std::lround(lean)), bed.y - height}};
  cv::fillConvexPoly(out, corners, cv::Scalar(1));
  cv::GaussianBlur(out, out, {}, 1.5);
  return out;
}

/// A fire that sways and leaps before a dark wall.
struct BurningClip {
  cv::Size size{160, 120};
  cv::Point bed{80, 100};
  int width = 30, height = 60, frames = 40;

  cv::Mat frame(int i) const {
    const cv::Mat burns = flame(size, bed, width, cvRound(height * (0.85 + 0.15 * std::sin(1.3 * i))),
                                0.3 * width * std::sin(0.9 * i));
    cv::Mat out;
    cv::Mat(20 + 230 * burns).convertTo(out, CV_8U);
    return out;
  }
  FlowingClip clip() const {
    const int rows = (size.height + 3) / 4, columns = (size.width + 3) / 4;
    const int channels = vision::motion_channels(vision::Settings{}.spectrum);
    const vision::CellMap motion{
        .rows = rows,
        .columns = columns,
        .channels = channels,
        .cell = 4,
        .values = std::vector<float>(static_cast<std::size_t>(rows) * columns * channels)};
    return {.size = size,
            .frames = frames,
            .varying = 0,
            .drawn = [own = *this](int i) { return own.frame(i); },
            .class_name = "fire",
            .motion = motion};
  }
};

/// A picture of a fire, CV_8UC3: orange, yellow within, on a bluish ground; and where it burns.
struct BurningPicture {
  cv::Size size{200, 160};
  cv::Point bed{110, 130};
  int width = 68, height = 80;

  cv::Mat draw() const {
    const cv::Mat outer = flame(size, bed, width, height), inner = flame(size, bed, width / 2, height / 2);
    cv::Mat out(size, CV_8UC3);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const float a = outer.at<float>(y, x), b = inner.at<float>(y, x);
        cv::Vec3f colour(34, 28, 24);
        colour += a * (cv::Vec3f(30, 130, 240) - colour);
        colour += b * (cv::Vec3f(120, 230, 255) - colour);
        out.at<cv::Vec3b>(y, x) = colour;
      }
    return out;
  }
  cv::Mat units() const {
    cv::Mat out;
    draw().convertTo(out, CV_32F, 1.0 / 255);
    return out;
  }
};

}  // namespace freshet::synth::animate
