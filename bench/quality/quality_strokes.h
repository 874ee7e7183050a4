// quality_strokes.h — the strokes that a person who knew the clip would draw on its still.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "hints/strokes.h"
#include "query/search/motion_guide.h"

namespace freshet::bench {

/// A handful of strokes, 4 to 12 by the matte's area, where the mean motion is strong and far from other
/// strokes. Each is a polyline that follows it for an eighth of the picture's diagonal at most, inside the
/// matte. Motion is smoothed first, over an eightieth of the diagonal: a person draws streams, not eddies.
/// Fewer, or none, where nothing flows at kMinSpeed.
/// motion   CV_32FC2, px/s, x right, y down, of any size: stretched to the matte's.
/// matte    CV_8U; fluid where above 127.
std::vector<hints::Stroke> draw_strokes(const cv::Mat& motion, const cv::Mat& matte);

/// What the strokes, at least one, ask of the picture's motion (hints::interpolate): directions, and speeds
/// where with_speed.
void guide_by(const std::vector<hints::Stroke>& strokes, cv::Size picture, bool with_speed,
              query::MotionGuide& guide);

}  // namespace freshet::bench
