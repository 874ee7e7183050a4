// synth/animate/still/appearance.h — contrast and levels matched, place by place, to the picture's.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

struct AppearanceOptions {
  int levels = 5;      // band-pass levels matched, up to detail of 32 px; then the picture itself
  int region_px = 64;  // distance between the middles of neighbouring regions
  /// A band is not amplified beyond this. At 3, the grain of an old photograph brought out the block noise of
  /// the smoke laid on it.
  double max_gain = 2;
  /// Nor are the picture's own levels. With more, the few dark pixels of a rock at the matte's edge turned
  /// into dark specks that swim in the fall.
  double max_level_gain = 1.5;
};

/// Maps of values to values by region, one set per band, fitted once to the whole animation and then applied
/// to each frame. Fitted frame by frame they would make it pump. A grid of separate regions would show: so a
/// pixel's value is the bilinear mixture of what its four nearest regions make of it.
///
/// Source   Okabe et al. 2011, Sec. 6, "Appearance Matching"; Heeger and Bergen 1995 (with a Laplacian
///          pyramid, and one pass: bands, then the picture); the mixture after Zuiderveld 1994 (CLAHE).
class AppearanceModel {
 public:
  /// target   CV_32F luma of the picture, 0..1.
  /// matte    CV_32F weight of each pixel in the histograms.
  /// samples  frames of the animation's luma, CV_32F, evenly spread over it.
  AppearanceModel(const cv::Mat& target, const cv::Mat& matte, std::span<const cv::Mat> samples,
                  const AppearanceOptions& options);
  /// One frame. Safe from many threads.
  cv::Mat apply(const cv::Mat& luma) const;

 private:
  /// Maps of one band.
  struct Band {
    float reach = 0;  // values lie in low .. low + reach
    float low = 0;
    int columns = 0, rows = 0;  // regions
    // By region, at kBins + 1 equal steps over the range, four values together: of the region, the next in
    // its row, and the two below them. What mixes at a pixel is read at once.
    std::vector<float> map;
  };
  static Band fit(const cv::Mat& target, const cv::Mat& weight, std::span<const cv::Mat> samples,
                  double region, double max_gain, bool around_zero);
  static void apply_band(const Band& band, cv::Mat& values);

  int levels_ = 0;
  std::vector<Band> bands_;
  Band picture_;
};

}  // namespace freshet::synth::animate
