// synth/transfer/pixel_grid.h — pictures as the method computes with them, halved, blurred and turned.
#pragma once

#include <opencv2/core.hpp>

#include "synth/field/grid.h"

namespace freshet::synth::transfer {

/// Blue, green, red, alpha, 0..1, colours premultiplied. The paper compares colours and alpha side by side
/// and says nothing of the colour of transparent pixels, which straight pictures leave to chance;
/// premultiplied it is 0, and averages of patches are averages of what is seen.
struct alignas(16) Pixel {
  float c[4] = {0, 0, 0, 0};
};
using PixelGrid = GridOf<Pixel>;

/// bgra  CV_8UC4, CV_16UC4 or CV_32FC4, straight. Values are clamped to 0..1, not-a-number to 0.
PixelGrid premultiplied(const cv::Mat& bgra);
/// CV_32FC4; 0 where alpha is below 1/4096, where a quotient of rounding errors would be seen as colour.
cv::Mat straight(const PixelGrid& picture);

/// alpha  CV_8U or CV_32F. As above.
Grid grid_of(const cv::Mat& alpha);
/// flow  CV_32FC2.
VectorGrid vectors_of(const cv::Mat& flow);
Grid alpha_of(const PixelGrid& picture);

/// Mean of blocks of 2 x 2; sizes are rounded up, what a block lacks is repeated from its own edge.
PixelGrid halved(const PixelGrid& picture);
Grid halved(const Grid& grid);

/// Gaussian of standard deviation sigma px, cut at 3 sigma, edges repeated. Own loops: OpenCV's differ in the
/// last bit from machine to machine, and a threshold follows.
Grid blurred(const Grid& grid, double sigma);

/// How the outline bends, by pixel, -1..1. It is 1 where the outline is that of a round blob of fluid of radius `scale`
/// px, and as much below 0 where it is that of a round hole. It is 0 where the outline is straight. It is 0 away from
/// the outline too, where blurred alpha is level.
///
/// blurred_alpha  by at least 2 px.
Grid curvature(const Grid& blurred_alpha, double scale);

/// Growth of area along a flow, 5 times its share a frame: 1 where a frame makes six of five px. -1..1.
///
/// flow   px a frame; what has alpha 0 counts for nothing.
/// sigma  px, of the blur over which it is taken: motion that is found by optical flow is rough.
Grid divergence(const VectorGrid& flow, const Grid& alpha, double sigma);

/// Anticlockwise, turns 0..3.
template <typename T>
GridOf<T> quarter_turned(const GridOf<T>& grid, int turns) {
  if (turns == 0) return grid;
  const GridOf<T> before = quarter_turned(grid, turns - 1);
  GridOf<T> out(before.height, before.width);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) out(x, y) = before(before.width - 1 - y, x);
  return out;
}

}  // namespace freshet::synth::transfer
