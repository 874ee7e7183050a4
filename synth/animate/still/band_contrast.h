// synth/animate/still/band_contrast.h — detail given a share of a picture's contrast, band by band and place by place.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// How much contrast a picture has in each band, place by place: mean squares over neighbourhoods of some pieces.
class BandContrast {
 public:
  /// luma    CV_32F, 0..1.
  /// levels  band-pass levels, detail up to 2^levels px; fewer in a small picture.
  /// reach   sigma of the neighbourhoods, px.
  /// where   CV_32F, luma's size: what its variance counts there, 0..1. Empty: 1.
  BandContrast(const cv::Mat& luma, int levels, double reach, const cv::Mat& where = {});

  /// Gives each band of `detail` (CV_32F, the picture's size, changed in place) its share of the picture's variance
  /// there; what lies below the bands goes. Nothing is amplified by more than max_gain, nor what is below `noise`.
  /// shares  by level, finest first, 0..1. Cost: a Laplacian pyramid. Safe from many threads.
  void take_share(cv::Mat& detail, std::span<const double> shares, double max_gain, double noise) const;
  int levels() const { return static_cast<int>(power_.size()); }

 private:
  cv::Mat power_of(const cv::Mat& band, int level) const;

  double reach_ = 48;
  std::vector<cv::Mat> power_;  // by level, CV_32F, sampled as power_of
};

}  // namespace freshet::synth::animate
