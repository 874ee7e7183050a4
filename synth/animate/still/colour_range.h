// synth/animate/still/colour_range.h — the colours that a fluid has at each luminance, beyond which none is made.
#pragma once

#include <array>
#include <cstdint>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// A place's colour is a sum: what stands there, what the copies bring, what a line that was fitted nearby
/// (ColourModel) says of a luminance that it never had. The sum of two colours is often a third: the yellow by which a
/// cloud differs from its blue sky made orange rims on other clouds, wet sand beside a green sea glowed orange, and a
/// blue mountain in mist turned pink. So nothing that is carried has a colour that the picture's fluid has not at that
/// luminance: blue less luma and red less luma end at the least and the most of the fluid's pixels. A place may always
/// keep the colour that it has in the picture, and what is rare in it stays rare, but is not lost.
class ColourRange {
 public:
  /// No limit.
  ColourRange() = default;
  /// bgr    CV_32FC3, luma and matte CV_32F of its size; the matte 0..1: all above 0 counts. Luminances that the fluid
  ///        does not have are limited as the next below and above together. A matte without fluid: no limit.
  /// Cost   one reading of the picture.
  ColourRange(const cv::Mat& bgr, const cv::Mat& luma, const cv::Mat& matte);

  /// Limits blue less luma and red less luma of n pixels.
  /// luma   1 is white; beyond black and white the ends count.
  /// still  what lies in a place's own way there (the picture; with a moving outline what is behind the fluid): blue,
  ///        green and red, in any unit: white is `white`, and lighter counts as white. Safe from many threads.
  void limit(const float* luma, const std::array<const std::uint16_t*, 3>& still, float white, int n,
             float* blue, float* red) const;

 private:
  static constexpr int kSteps = 32;
  struct Ends {  // at the steps' ends, and one beyond
    std::array<float, kSteps + 2> least{}, most{};
  };
  bool limits_ = false;
  std::array<Ends, 2> ends_;  // of blue, of red
};

}  // namespace freshet::synth::animate
