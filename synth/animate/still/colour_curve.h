// synth/animate/still/colour_curve.h — how a fluid's colour changes with its luminance, over the whole picture.
#pragma once

#include <array>
#include <cstdint>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// Colour less luma as a function of luma: means over the fluid's pixels, smooth. A flame is dark red, then orange,
/// then yellow, wherever it is. What is carried and gets another luminance there follows the curve. A straight line
/// that is fitted nearby (ColourModel) fails it: a bright flame that goes over a gap took the gap's purple with it, and
/// turned grey.
class ColourCurve {
 public:
  /// No colour changes with luminance.
  ColourCurve() = default;
  /// bgr    CV_32FC3, luma and matte CV_32F of its size; the matte 0..1. Luminances that the fluid does not have take
  ///        the nearest one's colour. A matte without fluid: as without a picture.
  /// Cost   one reading of the picture.
  ColourCurve(const cv::Mat& bgr, const cv::Mat& luma, const cv::Mat& matte);

  /// Adds to blue less luma and to red less luma what they change by when luma does; n values each.
  /// from  1 / CarriedFrame::kOne. to: 1 is white; beyond black and white the ends count. Safe from many threads.
  void follow(const std::int16_t* from, const float* to, int n, float* blue, float* red) const;

 private:
  static constexpr int kSteps = 64;
  std::array<std::array<float, kSteps + 2>, 2> chroma_{};  // blue, red; at the steps' ends, and one beyond
};

}  // namespace freshet::synth::animate
