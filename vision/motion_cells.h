// vision/motion_cells.h — how a clip moves, place by place: signed mean motion and power by temporal frequency.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::vision {

struct SpectrumOptions {
  int cell = 4;             // source px, side of a cell; 1 is the paper's exact form (with flow step 1)
  int bands = 8;            // logarithmic bands; 0 keeps every frequency
  double window_s = 1.28;   // Welch window (Hann, half overlapping): clips of any length and rate share its bins,
                            // which stand every 1 / window_s hertz
  double max_hz = 12.5;     // frequencies above are left out
};

/// Number of values of one cell: mean u, mean v, then for each band: power of u, power of v, cross power
/// (the real part of U conj(V), without which power could not be turned with a rotated variant).
int motion_channels(const SpectrumOptions& options);
int motion_bands(const SpectrumOptions& options);

/// A map of cells over a clip's source frame: cells.rows * cells.cols records of `channels` floats.
struct CellMap {
  int rows = 0, columns = 0, channels = 0;
  float cell = 4;               // source px, side of a cell
  std::vector<float> values;    // row-major, channel fastest
  std::span<const float> at(int row, int column) const {
    return {values.data() + (static_cast<std::size_t>(row) * columns + column) * channels,
            static_cast<std::size_t>(channels)};
  }
};

/// Takes flow frame by frame and ends with the clip's motion cells. Memory: one window of flow, whatever the
/// clip's length; clips shorter than a window use one window of their own length (>= 8 flows).
/// Motion in px/s and power in (px/s)^2: a band's power is the sum over its frequencies of |X_k|^2 scaled so that
/// a sinusoid of amplitude a inside it contributes a^2 / 2.
/// Source: Okabe et al. 2011, Eq. 2; DC is kept apart and signed, because power loses the direction that the
/// paper says it carries.
class MotionAccumulator {
 public:
  /// frame   size of the source in px; flow maps may be smaller by `flow_step`.
  MotionAccumulator(cv::Size frame, int flow_step, double fps, const SpectrumOptions& options);
  ~MotionAccumulator();
  /// u, v    CV_16S planes as quantize_flow made them. Work is shared by all threads; same result for any number.
  void add(const cv::Mat& u, const cv::Mat& v);
  /// Mean over all frames of |flow|, px a frame at source scale, at flow resolution: CV_32F. What tells fluid
  /// from what stands still.
  cv::Mat mean_speed_px() const;
  CellMap finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Power of one series, the slow and obvious way, for tests: power[k] of frequency k / window_s.
std::vector<double> naive_power(std::span<const double> series, double fps, const SpectrumOptions& options);

}  // namespace freshet::vision
