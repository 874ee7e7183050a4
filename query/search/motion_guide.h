// query/search/motion_guide.h — where and how fast a person wants the fluid of a picture to go.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/motion.h"
#include "query/index/motion_window.h"
#include "query/search/target.h"

namespace freshet::query {

using freshet::MotionGuide;

/// What a direction or a speed that is asked does to the search.
enum class HintSearch {
  /// It forbids no patch: who does not move so pays for it (GuideCosts). The animation turns a patch's motion to
  /// what is asked, and scales it, so that looks may choose: a window on the speed of a mountain stream left three
  /// clips of 46.
  kWide,
  /// Only patches that move about so are candidates, as in the paper, which shows patches as they are.
  kNarrow,
};
HintSearch parse_hint_search(const std::string& name);  // "wide", "narrow"; Error{kUsage}

/// Throws   Error{kUsage} when a map has another size or type than the picture's, or a number is out of range
///          (tolerance 0..180 degrees, ratio at least 1).
void check_guide(const MotionGuide& guide, cv::Size picture);

/// The guide with tolerances that admit any motion.
MotionGuide widened(MotionGuide guide);

/// What a guide asks of each piece: the mean direction and the geometric mean of the speeds over its fluid.
struct PieceMotion {
  cv::Vec2f direction{0, 0};  // unit vector; (0, 0): none asked
  float speed = -1;           // px/s; negative: none asked
};

/// A row per piece.
/// matte    CV_8U, the picture's size. The guide is read where it is above 127; in a piece that has no such
///          pixel, everywhere.
/// Throws   as check_guide.
std::vector<PieceMotion> asked_motion(const MotionGuide& guide, const Target& target, const cv::Mat& matte);

/// What is asked in steps of 5 degrees and a tenth of an octave: what is chosen by it stays as it is where a stroke
/// bends the directions of the whole picture a little.
PieceMotion in_steps(const PieceMotion& asked);

/// The window of a piece whose tolerances were opened `steps` times. Each step takes half as much again of
/// the angle and of the ratio's logarithm; at 180 degrees and a ratio of 16 nothing of the condition is left.
///
/// A window's middle moves in steps of a sixth of the tolerances (5 degrees of 30). A stroke bends the
/// directions of the whole picture a little: most windows should stay as they are, and with them what was
/// found in them (labelling_memo.h). The price of not moving quite as asked (GuideCosts) knows no steps.
MotionWindow window_of(const PieceMotion& asked, const MotionGuide& guide, int steps);

}  // namespace freshet::query
