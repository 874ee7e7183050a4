// query/search/motion_guide.h — where and how fast a person wants the fluid of a picture to go.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/motion.h"
#include "query/index/motion_window.h"
#include "query/search/target.h"

namespace freshet::query {

using freshet::MotionGuide;

/// What a guide asks of each piece: the mean direction and the geometric mean of the speeds over its fluid.
struct PieceMotion {
  cv::Vec2f direction{0, 0};  // unit vector; (0, 0): none asked
  float speed = -1;           // px/s; negative: none asked
};

/// A row per piece.
/// matte    CV_8U, the picture's size. The guide is read where it is above 127; in a piece that has no such
///          pixel, everywhere.
/// Throws   Error{kUsage} when a map has another size or type than the picture's, or a number is out of range
///          (tolerance 0..180 degrees, ratio at least 1).
std::vector<PieceMotion> asked_motion(const MotionGuide& guide, const Target& target, const cv::Mat& matte);

/// The window of a piece whose tolerances were opened `steps` times. Each step takes half as much again of
/// the angle and of the ratio's logarithm; at 180 degrees and a ratio of 16 nothing of the condition is left.
///
/// A window's middle moves in steps of a sixth of the tolerances (5 degrees of 30). A stroke bends the
/// directions of the whole picture a little: most windows should stay as they are, and with them what was
/// found in them (labelling_memo.h). The price of not moving quite as asked (GuideCosts) knows no steps.
MotionWindow window_of(const PieceMotion& asked, const MotionGuide& guide, int steps);

}  // namespace freshet::query
