// synth/animate/still/standing_colour.h — light and colour that stay the still's while the fluid goes.
#pragma once

#include <array>

#include <opencv2/core.hpp>

#include "synth/animate/still/carried_base.h"

namespace freshet::synth::animate {

/// Copies bring what lies elsewhere in the picture: over a quarter of the picture a sea turned from green to pink, and
/// the pool under a fall to white and back. Light and colour of a place that large are the scene's, not the fluid's:
/// the mean over the fluid around each place, weighed by a Gaussian of a twelfth of the longer side, stays the still's.
/// What a frame departs from it by is taken away, smooth, and all that is smaller stays as it was carried.
/// Source: none in Okabe et al. 2011, whose differences have no mean.
class StandingColour {
 public:
  /// planes   of the picture (fluid_planes); matte as they were made with: the fluid that is compared.
  /// Memory   8 bytes a pixel.
  StandingColour(const FluidPlanes& planes, const cv::Mat& matte);

  /// Holds the means of luma (CV_32F, the picture's size) and, of a frame that brings its colour, of that.
  /// frame    or null. Cost: two passes. Safe from many threads.
  /// share    of what they departed by, 0..1.
  void hold(cv::Mat& luma, CarriedFrame* frame, double share = 1) const;

 private:
  void hold_mean(const cv::Mat& own, const cv::Mat& weight, int passes, double share, cv::Mat& plane) const;

  cv::Mat luma_;                               // CV_32F: the still's
  std::array<cv::Mat, 2> colour_;              // blue and red less luma, as CarriedFrame has them
  cv::Mat matte_, half_matte_, cells_, mass_;  // the matte; its means over cells; those around each cell
};

}  // namespace freshet::synth::animate
