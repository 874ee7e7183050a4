// tests/synth/judging/made_film.h — a made fluid: grain that drifts and comes anew, and stays as the still is.
#pragma once

#include <cstdint>
#include <functional>

#include <opencv2/core.hpp>

#include "synth/judging/evidence.h"

namespace freshet::synth::judging {

inline const cv::Size kMadeSize(160, 120);

/// Grain of some 3 px about 128, CV_8UC3 of a colour.
cv::Mat made_grain(std::uint64_t seed, cv::Size size = kMadeSize);

/// Changes a frame: what is wrong with the film.
using Fault = std::function<void(cv::Mat& frame, int number)>;

/// 48 frames at 25 a second: a wide grain drifts right by 1 px a frame, half of it new every 4 frames at the same
/// contrast. Frame 0 is the still. The matte is all but a border of 8 px.
Evidence made_film(const Fault& fault = {}, int frames = 48);

}  // namespace freshet::synth::judging
