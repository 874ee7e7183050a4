// synth/transfer/files/ground.h — a fluid taken off the black or white that it was filmed on, and light put on others.
#pragma once

#include <opencv2/core.hpp>

#include "media/frame/filmed_ground.h"

namespace freshet::synth::transfer {

using media::Ground;

inline constexpr double kBodyBegins = 0.6;

/// Gives bgra, CV_16UC4, the alpha of what stands on a ground, and straight colours. In place. One with an alpha of
/// its own is laid on the ground first.
///
/// White: alpha is the darkest channel's negative.
/// Black: colours times alpha stay the light that is seen. Alpha is the body that the light comes from, gaps between
/// filaments included, and fades with the glow around it. (With the brightest channel for alpha, all but the hottest
/// places would count as rim: a fluid would get them for its whole inside.)
/// mask   empty, or CV_16U: the body as it is known. Alpha is at least the brightest channel nevertheless.
/// body_begins  brightness from which on a body found here is whole, 0.1 to 1.
void take_off_ground(cv::Mat& bgra, Ground ground, const cv::Mat& mask = {},
                     double body_begins = kBodyBegins);

/// Of light within its body the light alone: alpha is the brightest channel, colours times alpha are what they were.
/// bgra  CV_32FC4, 0..1, straight.
cv::Mat light_alone(const cv::Mat& bgra);

}  // namespace freshet::synth::transfer
