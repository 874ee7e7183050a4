// synth/animate/frames/enlarge.h — the moving field of a reduced picture laid on the picture itself.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// Adds the merged differences of all pieces to a frame's luminance.
///
/// field    CV_32F, of the canvas: px of the picture reduced by `scale` (query/search/picture_scale.h).
/// canvas   its place on the reduced picture; it overhangs.
/// luma     CV_32F, the picture's size; changed in place. Where no piece lies nothing is added.
/// At scale 1 pixels are added as they are. Above it the field is enlarged bicubically: the reduced picture's
/// finest detail is then 2 * scale px, and what is finer comes from the base alone (carried_base.h carries
/// the picture's own along).
/// Cost     one field of the picture's size.
void add_enlarged(const cv::Mat& field, const cv::Rect& canvas, double scale, cv::Mat& luma);

}  // namespace freshet::synth::animate
