// synth/judging/asked_motion.h — how the film moves against what was asked of it.
#pragma once

#include <string_view>

#include <opencv2/core.hpp>

#include "synth/judging/evidence.h"
#include "synth/judging/film_motion.h"
#include "synth/judging/reading.h"

namespace freshet::synth::judging {

/// What a person asked of the motion. Of the picture's size; either may be empty.
struct Asked {
  cv::Mat direction;  // CV_32FC2, unit vectors, (0, 0) where nothing was asked
  cv::Mat speed;      // CV_32F, px/s; negative where nothing was asked
};

/// Angle between the film's mean motion and the direction asked, degrees, mean over the fluid where the film moves by a
/// third of its own mean speed. NaN without a direction.
/// kind  of fluid. Water that is thrown up comes down again: where up was asked, down is no angle if some of it rises.
Reading motion_angle(const Evidence& film, const FilmMotion& motion, const Asked& asked,
                     std::string_view kind);

/// How far the length of the film's mean motion is from the speed asked, octaves, both means over the fluid where a
/// speed was asked. NaN without a speed; without a map.
Reading speed_ratio(const Evidence& film, const FilmMotion& motion, const Asked& asked);

/// The film's mean speed, px of the picture per second: eddies count. Its map is by cell.
Reading mean_speed(const Evidence& film, const FilmMotion& motion);

}  // namespace freshet::synth::judging
