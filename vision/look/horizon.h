// vision/look/horizon.h — a plane of water that ends in a horizon: where, and how speeds shrink towards it.
#pragma once

#include <optional>
#include <string_view>

#include <opencv2/core.hpp>

#include "freshet/motion.h"

namespace freshet::vision {

/// The horizon that a matte's straight upper border is: a line that the highest fluid of most columns lies on, within
/// 1 px, over at least half of the picture's width, level within 4 degrees. None: a bank, a rim, or fluid up to the
/// picture's edge.
/// matte   CV_8U, fluid above 127.
std::optional<Horizon> horizon_of(const cv::Mat& matte);
/// The same of what is water, by its class or, where that is none of kFluidKinds, by its look; none where a black bar
/// ends (within_bars).
/// picture   CV_8UC3, of the matte's size.
std::optional<Horizon> horizon_of_water(const cv::Mat& picture, const cv::Mat& matte,
                                        std::string_view class_name);

/// px below the horizon, straight down; negative above it.
float below(const Horizon& horizon, cv::Point2f place);

/// How fast a plane that goes everywhere at one speed along `way` is seen to go at a place: to the side as
/// 1 / distance, away and towards the viewer as its square. In one unit for the whole picture; 0 from the horizon up.
/// way      unit vector of the picture; (0, 0): as to the side.
/// Source   a pinhole above a plane, its focal length as long as the picture is wide (53 degrees).
float seen_speed(const Horizon& horizon, cv::Point2f place, cv::Vec2f way, cv::Size picture);

/// The same of each pixel: CV_32F of `picture`'s size.
/// direction   CV_32FC2, of that size; empty: as to the side everywhere.
cv::Mat seen_speeds(const Horizon& horizon, const cv::Mat& direction, cv::Size picture);

}  // namespace freshet::vision
