// vision/pyramid.h — Laplacian pyramids of pictures (Burt and Adelson 1983).
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::vision {

/// levels band-pass pictures, finest first, then the low-pass rest: levels + 1, CV_32F, halved each time.
void laplacian_pyramid(const cv::Mat& picture, int levels, std::vector<cv::Mat>& bands);
/// At most `wanted`, and so many that the rest has four samples across and down; 0 for a picture that has not itself.
int levels_within(cv::Size picture, int wanted);
/// The picture whose pyramid it is; exact up to rounding.
cv::Mat collapse(const std::vector<cv::Mat>& bands);
/// The same in the memory of the finest band: the pyramid is used up.
/// gains   by level, finest first: what the bands are multiplied by; beyond its end 1.
cv::Mat collapse(std::vector<cv::Mat>&& bands, std::span<const float> gains = {});

}  // namespace freshet::vision
