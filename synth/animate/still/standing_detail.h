// synth/animate/still/standing_detail.h — what of the picture stays in its place while the fluid goes by.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/still/carried_base.h"

namespace freshet::synth::animate {

/// Not all that is seen of a fluid goes with it: the light and dark of a fall lie on its rock, a fire is bright
/// at its foot. Of the variance of the footage's bands of some 4, 8, 16, 32 px the flow leaves behind (medians
/// of 46 clips by class) 11, 9, 7, 9 % of clouds, 6, 7, 15, 21 of fire, 2, 2, 6, 11 of smoke, 2, 5, 14, 33 of
/// water; of a fall in dusk 16, 35, 63, 86. A still does not tell apart what stands and what goes, but of a
/// band X of which a share s of the variance stands, s X is the best guess (of least squares) of what does, and
/// the root of s has its variance. So each level shows its share of X where it lies, and what is carried by as
/// much less that the contrast stays the picture's.
class StandingDetail {
 public:
  /// planes, matte  as CarriedBase takes them.
  /// shares   by level of luma, finest first, then the low-pass rest, 0..1 (standing_shares).
  /// Memory   12 bytes a pixel.
  StandingDetail(const FluidPlanes& planes, const cv::Mat& matte, std::vector<double> shares);

  int levels() const { return static_cast<int>(shares_.size()) - 1; }
  double share(int level) const { return shares_[static_cast<std::size_t>(level)]; }
  /// The picture's band, CV_32F (vision::laplacian_pyramid); beyond the matte the fluid's own values go on.
  const cv::Mat& band(int level) const { return bands_[static_cast<std::size_t>(level)]; }
  /// What a band is multiplied by to bring it to `kept` of the picture's mean magnitude over the whole matte, at most
  /// 1.4 or as much less than 1: mixed, stretched and renewed it neither gains nor loses. Magnitudes, not squares: an
  /// edge that is spread into grain has as much power, and looks like more.
  /// strength: the power of that factor, 0..1.
  float match(const cv::Mat& band, int level, double kept, double strength) const;

 private:
  std::vector<double> shares_;
  std::vector<cv::Mat> bands_, within_;  // within: the matte by level, CV_32F
  std::vector<double> magnitude_;        // of the bands, summed over the matte
};

}  // namespace freshet::synth::animate
