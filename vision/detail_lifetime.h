// vision/detail_lifetime.h — how long a clip's detail lives while the flow carries it, place by place, band by band.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "vision/flow_outliers.h"
#include "vision/temporal_spectrum.h"

namespace freshet::vision {

inline constexpr int kLifeBands = 4;         // Laplacian bands, finest first: of some 4, 8, 16, 32 px
inline constexpr int kLifeCell = 32;         // px of the frame, side of a cell
inline constexpr double kLongestLife_s = 6;  // what lives longer is not told apart
inline constexpr double kDetailNoise =
    0.003;  // luma: coding noise has at most this standard deviation in a band

inline constexpr int kLifeChannels = 2 * kLifeBands;
inline constexpr int kStandingChannels = kLifeBands;
inline constexpr int kLayoutChannels = 2 * kLifeBands;

/// Half-lives in seconds: > 0, <= kLongestLife_s; 0 stands for "not known".
struct DetailLifetimes {
  /// Cells of kLifeCell px, kLifeChannels values each: half-lives by band, pooled as below; then the root mean square
  /// of each band (luma in 0..1) where the cell was followed, 0 where it was not: how much of what is seen the cell
  /// speaks for.
  CellMap cells;
  std::array<float, kLifeBands> clip{};  // of all cells together, each by its power
  /// The same cells, kStandingChannels values each: of a band's variance, how much stays where it is while the flow
  /// goes by, 0..1.
  CellMap standing;
  std::array<float, kLifeBands> clip_standing{};  // of all cells together, each by its power
  /// The same cells, kLayoutChannels values each: how much of a band's local contrast stays where it is while the flow
  /// goes by, by band; then how much goes along. 0..1.
  CellMap layout;
  std::vector<FlowOutlier> flow_outliers;  // by flow frame
};

/// The time after which a band of luma (vision::laplacian_pyramid at the frame's own size), followed along the flow,
/// keeps half of its correlation with itself.
///
/// Every 8th frame is a beginning. What moves in it (at least .2 px a frame at 25 frames per second) is followed from
/// every 4th pixel of every 4th row, shifted from one beginning to the next, through the flow as it is kept (its
/// reduction and its 1/64 px included), for up to 32 frames; at lags of 1, 2, 4, 8, 12, 16, 24 and 32 frames its bands
/// are compared with those it began with. Where the correlation crosses a half between two lags, exponentially; where
/// it does not, its fall up to the last lag goes on as an exponential.
///
/// Outliers: a track ends at a fast flow frame (flow_outliers of the last 256 frames), so that a cut or a flash does
/// not shorten lives; no track begins at a repeated frame.
///
/// Noise: independent noise lowers the correlation at all lags by one factor, and not that at lag 0: a nugget. It is
/// estimated as the gap between 1 and C(1)^2 / C(2), where an exponential through lags 1 and 2 meets lag 0, and the
/// curve is divided by what is left. But a mixture of short- and long-lived detail looks the same: so the gap is taken
/// for noise only as far as noise of kDetailNoise explains it in the power found. A band that is not above such noise
/// says nothing.
///
/// Pooling: a cell's correlations are means of its own, weighted by its independent samples (a sample in an area of
/// (2, 4, 8, 16 px)^2 by band) less its share of noise, of its 8 neighbours' with a weight of 50 samples, and therein
/// of the whole clip's (cells by their power, as the eye weighs them) with 50. So a cell that stands still, is flat,
/// or is left at once takes its neighbourhood's life; 0 in all cells when nothing of the clip can be followed.
///
/// What stands: the light and dark of a fall's rock, the hot foot of a fire. Of a band's detail from whose place the
/// flow has gone by its wavelength at least, what is found at the old place correlates with it, at all lags together.
/// What is mere texture does not. Pooled as the lives; a band that is never carried so far has what the next finer one
/// has.
///
/// Where contrast stands: over the rock of a fall new water is rough where the old one was, while a sea's roughness
/// goes with its crests. Local contrast is the logarithm of a band's magnitude over some three of its wavelengths, less
/// that over some ten. Of places that the flow has left by two wavelengths, what is found there later, and what is
/// found where the flow has gone, correlates with it. Pooled as what stands. Of the band of 8 px, stays / goes: a brook
/// .83 / .63, a fall at dusk .50 / .24, rapids .19 / .23, a dark sea 0 / .46, a shore's foam 0 / .19, clouds .08 to .10
/// / .80 to .86.
///
/// Memory  5 beginnings in hand, whatever the clip's length: 62 bytes a track (one in 16 px) and 1.7 KB a cell.
/// Cost    CPU per frame of 640 x 360 in which all moves: 1.2 to 1.4 ms; without what stands 1.1 to 1.2. One thread;
///         memory is taken for each of the first beginnings, and used again.
class DetailLifetimeAccumulator {
 public:
  /// Throws Error{kUsage} for flow steps below 1 and frames or rates that MotionAccumulator refuses.
  DetailLifetimeAccumulator(cv::Size frame, int flow_step, double fps);
  ~DetailLifetimeAccumulator();
  /// The first frame: CV_8U.
  void begin(const cv::Mat& luma);
  /// Each further frame, with the flow that led to it from the one before: CV_16S planes as quantize_flow made them.
  void add(const cv::Mat& u, const cv::Mat& v, const cv::Mat& luma);
  /// moving   CV_8U, the frame's size, 255 where the clip moves: cells of which less than a quarter does are taken
  ///          to have no samples of their own (flow drags still scenery along beside a jet).
  /// Once; the accumulator is spent.
  DetailLifetimes finish(const cv::Mat& moving);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::vision
