// vision/temporal_spectrum.h — how a clip moves, place by place: mean motion, and power by frequency.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "vision/cell_map.h"

namespace freshet::vision {

struct SpectrumOptions {
  int cell = 4;   // source px, side of a cell; 1 is the paper's exact form (with flow step 1)
  int bands = 8;  // logarithmic bands, at most one for each frequency; 0 keeps every frequency
  /// Welch window (Hann, half overlapping): clips of any length and rate share its bins, which stand every
  /// 1 / window_s hertz.
  double window_s = 1.28;
  double max_hz = 12.5;  // frequencies above are left out
};

/// The values of one cell: mean u, mean v, then for each band its BandPower.
inline constexpr int kMeanChannels = 2, kBandChannels = 3;
/// (px/s)^2. cross is the real part of U conj(V), without which power could not be turned with a rotated variant.
struct BandPower {
  float u, v, cross;
};
constexpr int first_channel(int band) { return kMeanChannels + kBandChannels * band; }
/// cell   the values of one.
inline BandPower band_power(const float* cell, int band) {
  const float* at = cell + first_channel(band);
  return {at[0], at[1], at[2]};
}
inline void set_band_power(float* cell, int band, const BandPower& power) {
  float* at = cell + first_channel(band);
  at[0] = power.u, at[1] = power.v, at[2] = power.cross;
}
int motion_channels(const SpectrumOptions& options);
/// The inverse of it.
constexpr int bands_of(int motion_channels) { return (motion_channels - kMeanChannels) / kBandChannels; }

/// The number of bands, the same for every clip. Throws Error{kUsage} unless 1 <= N <= kMaxBands and
/// 0 < window_s <= 60.
///
/// Nominal bins n = 1..N stand at n / window_s hertz, N = floor(window_s * max_hz). Of B bands, band 0 starts
/// at bin 1 and band b at round((N + 1)^(b / B)), moved as little as gives every band a bin: with the
/// defaults, bins 1, 2, 3, 4, 5, 6-7, 8-11 and 12-16 of 0.78 Hz each. A clip's own
/// frequency belongs to the nominal bin nearest to it in hertz. Bands above a slow clip's Nyquist frequency
/// stay zero; so do bands between the frequencies of a clip shorter than a window.
int motion_bands(const SpectrumOptions& options);
inline constexpr int kMaxBands = 512;
/// Where the bands meet: motion_bands + 1 values, Hz.
std::vector<double> band_edges_hz(const SpectrumOptions& options);

/// Takes flow frame by frame and ends with the clip's motion cells: motion in px/s, power in (px/s)^2.
///
/// A band's power is the sum over its frequencies of |X_k|^2, scaled so that a sinusoid of amplitude a inside
/// it contributes a^2 / 2. Hann's window leaves 2/3 of it in the sinusoid's own bin and 1/6 in each neighbour
/// (the lowest bin loses its share at 0 Hz). Each pixel's mean over the window is taken away first. Flows
/// after the last whole window count for the mean alone. Clips shorter than a window use one window of their
/// own length (>= 8 flows).
///
/// Memory  one window of flow, whatever the clip's length.
/// Cost    0.45 s of CPU for 150 frames of 1280 x 720 at flow step 2, cell 4.
/// Source  Okabe et al. 2011, Eq. 2; DC is kept apart and signed, because power loses the direction that the
///         paper says it carries.
class MotionAccumulator {
 public:
  /// frame   size of the source in px; flow maps may be smaller by `flow_step`: ceil(side / flow_step).
  ///         options.cell must be a multiple of flow_step (Error{kUsage}).
  MotionAccumulator(cv::Size frame, int flow_step, double fps, const SpectrumOptions& options);
  ~MotionAccumulator();
  /// u, v    CV_16S planes as quantize_flow made them. All threads; the same result for any number.
  void add(const cv::Mat& u, const cv::Mat& v);
  /// Mean over all frames of |flow|, px per frame at source scale, at flow resolution: CV_32F. What tells
  /// fluid from what stands still.
  cv::Mat mean_speed_px() const;
  /// Cells at the right and bottom edge may be partial: they average what there is. Once; the accumulator is
  /// spent. Throws Error{kInput} after fewer than 8 flows.
  CellMap finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Power of one series (px/s), the slow and obvious way, for tests: power[n] of nominal bin n, 1..N;
/// power[0] is 0.
std::vector<double> naive_power(std::span<const double> series, double fps, const SpectrumOptions& options);

}  // namespace freshet::vision
