// quality_strokes.h — the strokes that a person who knew the clip would draw on its still.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "query/motion_guide.h"

namespace freshet::bench {

struct DrawnStroke {
  std::vector<cv::Point2f> points;  // px of the picture, in the order of the motion
  double speed_px_per_s = 0;        // along the stroke, to the next step of 20 %: nobody knows it better
};

/// A handful of strokes, 4 to 12 by the matte's area, where the mean motion is strong and far from other
/// strokes: each a polyline that follows it for an eighth of the picture's diagonal at most, inside the
/// matte. Motion is smoothed first, over an eightieth of the diagonal: a person draws streams, not eddies.
/// motion   CV_32FC2, px/s, x right, y down, of any size: stretched to the matte's.
/// matte    CV_8U; fluid where above 127.
/// Fewer, or none, where nothing flows at kLeastSpeed.
std::vector<DrawnStroke> draw_strokes(const cv::Mat& motion, const cv::Mat& matte);

/// What the strokes ask of the picture's motion: directions, and speeds where with_speed.
void guide_by(const std::vector<DrawnStroke>& strokes, cv::Size picture, bool with_speed,
              query::MotionGuide& guide);

}  // namespace freshet::bench
