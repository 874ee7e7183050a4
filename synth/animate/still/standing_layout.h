// synth/animate/still/standing_layout.h — a still parted into a layout that stands and a texture that the flow carries.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/still/fluid_planes.h"

namespace freshet::synth::animate {

/// How the fluid goes in the still, sampled as the copies' maps.
struct LayoutMotion {
  cv::Mat direction;  // CV_32FC2: unit vectors of the mean motion, (0, 0) where nothing moves
  cv::Mat travel;     // CV_32F, px: how far a place's fluid goes while one copy of the texture shows
  int step = 4;       // px of the picture between samples
};

/// In a fall the light, the brink and the ledges stand, and only texture falls. Detail that is carried as it is takes
/// them along: ledges march, and a bright fall darkens where it carries its pool. So each Laplacian band X of luma is
/// parted, X = S + M T:
///
/// - S, the standing component: what is drawn out along the flow (the mean of X along it, in the share of the variance
///   that stands in the clips); what stands out of its surroundings; edges that lie across the flow (brinks, ledges,
///   rims); and what the fluid does not leave while a copy shows;
/// - T, the texture, of unit local variance: the copies carry it;
/// - M, the local magnitude: it belongs to the place. Texture takes the magnitude of the place where it arrives.
///
/// The low-pass rest stands, and so does colour: nothing drifts.
/// Source: none in Okabe et al. 2011, who add differences to a standing exposure; here the still's own texture goes.
class StandingLayout {
 public:
  /// planes, matte  as CarriedBase takes them.
  /// shares   by level of luma, finest first: of a band's variance, how much stands, 0..1 (in the clips:
  ///          standing_shares). Their number is that of the bands.
  /// Cost     a line integral of 24 samples at each level, once a picture. All threads.
  /// Memory   20 bytes a pixel.
  StandingLayout(const FluidPlanes& planes, const cv::Mat& matte, const LayoutMotion& motion,
                 std::span<const double> shares);

  int levels() const { return static_cast<int>(stands_.size()) - 1; }
  /// CV_32F, the picture's size, mean 0: all bands of T together, each times its mean magnitude. It takes the place of
  /// luma in what is carried.
  const cv::Mat& texture() const { return texture_; }
  /// CV_32F, sampled as the motion, 0..1: where an edge across the flow stands, which no copy may bring.
  const cv::Mat& edges() const { return edges_; }
  /// S of a level, then the low-pass rest. CV_32F.
  const cv::Mat& stands(int level) const { return stands_[static_cast<std::size_t>(level)]; }
  /// Lays a level's texture, of its place's magnitude already, over what stands. It brings no level: where the fluid is
  /// narrower than a wavelength, a band would make it lighter or darker as a whole. Changed in place.
  void lay(cv::Mat& texture, int level) const;
  /// M of a level over its mean: what the texture's band is multiplied by. CV_32F.
  const cv::Mat& magnitude(int level) const { return magnitude_[static_cast<std::size_t>(level)]; }

 private:
  cv::Mat texture_, edges_;
  std::vector<cv::Mat> stands_, magnitude_, inside_;  // inside: the matte by level
};

}  // namespace freshet::synth::animate
