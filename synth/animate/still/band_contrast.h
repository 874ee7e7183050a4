// synth/animate/still/band_contrast.h — detail given a share of a picture's contrast, band by band and place by place.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// Over which powers are measured: Gaussian neighbourhoods.
enum class Neighbourhood {
  kWide,   // 24 px at every level, some pieces
  kClose,  // as wide as a level's own detail: where there is an edge, and where it is smooth beside it
};

/// How much contrast a picture has in each band, place by place.
class BandContrast {
 public:
  /// luma    CV_32F, 0..1.
  /// levels  band-pass levels, detail up to 2^levels px; fewer in a small picture.
  /// counts  by level, what its variance counts, 0..1 (counts_of). Empty: 1.
  BandContrast(const cv::Mat& luma, int levels, Neighbourhood neighbourhood,
               std::span<const cv::Mat> counts = {});
  /// where   CV_32F, a picture's shape: what its variance counts there; for all pictures of this shape.
  static std::vector<cv::Mat> counts_of(const cv::Mat& where, int levels, Neighbourhood neighbourhood);

  /// Gives each band of `detail` (CV_32F, the picture's size, changed in place) its share of the picture's variance
  /// there; what lies below the bands goes. Nothing is amplified by more than max_gain, nor what is below `noise`.
  /// The detail's own power is measured widely: it stays as restless as it is.
  /// shares  by level, finest first, 0..1. Cost: a Laplacian pyramid. Safe from many threads.
  void take_share(cv::Mat& detail, std::span<const double> shares, double max_gain, double noise) const;
  int levels() const { return static_cast<int>(amplitude_.size()); }

 private:
  std::vector<cv::Mat> amplitude_;  // by level, CV_32F, in cells of its neighbourhoods
};

}  // namespace freshet::synth::animate
