#include "vision/temporal_spectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <Eigen/Core>

#include "freshet/error.h"
#include "vision/flow.h"

namespace freshet::vision {
namespace {

constexpr int kMinFlows = 8;
constexpr int kPanel = 128;  // pixels of one product: 32 flows of them are 16 KB, and stay in the first cache
constexpr int kCellRowsPerTask = 4;  // fixed, so that threads change nothing
constexpr double kLongestWindow_s = 60, kMaxFps = 1000;
using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

int nominal_bins(const SpectrumOptions& o) {
  const double bins = o.window_s * o.max_hz;
  if (!(o.window_s > 0 && o.window_s <= kLongestWindow_s) || !(bins >= 1 && bins < kMaxBands + 1)) {
    throw Error(ErrorKind::kUsage, "spectrum",
                "window " + std::to_string(o.window_s) + " s up to " + std::to_string(o.max_hz) +
                    " Hz; 1 to " + std::to_string(kMaxBands) + " frequencies expected");
  }
  return static_cast<int>(std::floor(bins + 1e-6));
}

// First nominal bin of each band, and one past the last: motion_bands + 1 values.
std::vector<int> band_starts(const SpectrumOptions& options) {
  const int bins = nominal_bins(options), bands = motion_bands(options);
  std::vector<int> starts(static_cast<std::size_t>(bands) + 1);
  starts[0] = 1;
  for (int b = 1; b < bands; ++b) {
    const int rounded = static_cast<int>(std::lround(std::pow(bins + 1.0, static_cast<double>(b) / bands)));
    starts[b] = std::clamp(rounded, starts[b - 1] + 1, bins + 1 - (bands - b));
  }
  starts[bands] = bins + 1;
  return starts;
}

// The nominal bin nearest to a frequency; what is slower than all belongs to the first.
int nominal_bin(double hz, const SpectrumOptions& options) {
  return std::clamp(static_cast<int>(std::floor(hz * options.window_s + 0.5)), 1, nominal_bins(options));
}

int window_length(double fps, const SpectrumOptions& options) {
  return std::max(kMinFlows, static_cast<int>(std::lround(options.window_s * fps)));
}

int last_bin(int length, double fps, const SpectrumOptions& options) {
  return std::min(length / 2, static_cast<int>(std::floor(options.max_hz * length / fps + 1e-6)));
}

// Periodic Hann window, 1/4 of the weight in each neighbouring bin.
double hann(int t, int length) { return 0.5 - 0.5 * std::cos(2 * std::numbers::pi * t / length); }

// |X_k|^2 times this is one-sided power: summed over k it is the series' variance, a^2 / 2 for a sinusoid.
double power_scale(int k, int length) {
  double squares = 0;
  for (int t = 0; t < length; ++t) squares += hann(t, length) * hann(t, length);
  return (2 * k == length ? 1.0 : 2.0) / (length * squares);
}

// A window's transform as one matrix: subtracting the mean, Hann, DFT and scale are all linear.
struct Transform {
  int length = 0;
  Matrix rows;            // 2 * bins x length: real and imaginary part of each bin; flow units to px/s
  std::vector<int> band;  // of each bin

  Transform(int flows, double fps, const SpectrumOptions& options) : length(flows) {
    const int bins = std::max(0, last_bin(length, fps, options));
    const auto starts = band_starts(options);
    rows.resize(2 * bins, length);
    for (int k = 1; k <= bins; ++k) {
      const double scale = std::sqrt(power_scale(k, length)) * fps * kFlowUnit;
      double mean_re = 0, mean_im = 0;
      std::vector<std::complex<double>> wave(length);
      for (int t = 0; t < length; ++t) {
        wave[t] = std::polar(hann(t, length), -2 * std::numbers::pi * k * t / length);
        mean_re += wave[t].real() / length;
        mean_im += wave[t].imag() / length;
      }
      for (int t = 0; t < length; ++t) {
        rows(2 * k - 2, t) = static_cast<float>(scale * (wave[t].real() - mean_re));
        rows(2 * k - 1, t) = static_cast<float>(scale * (wave[t].imag() - mean_im));
      }
      const int n = nominal_bin(k * fps / length, options);
      band.push_back(static_cast<int>(std::upper_bound(starts.begin(), starts.end(), n) - starts.begin()) -
                     1);
    }
  }
};

}  // namespace

int motion_bands(const SpectrumOptions& options) {
  if (options.bands < 0) throw Error(ErrorKind::kUsage, "spectrum", "a number of bands from 0 expected");
  const int bins = nominal_bins(options);
  return options.bands == 0 ? bins : std::min(options.bands, bins);
}

int motion_channels(const SpectrumOptions& options) { return first_channel(motion_bands(options)); }

std::vector<double> band_edges_hz(const SpectrumOptions& options) {
  std::vector<double> edges;
  for (const int start : band_starts(options)) edges.push_back((start - 0.5) / options.window_s);
  return edges;
}

struct MotionAccumulator::Impl {
  SpectrumOptions options;
  double fps;
  int bands;
  cv::Size flow_size;
  int cell_side;  // flow pixels
  Transform transform;
  CellMap cells;                           // sums, until finish()
  std::vector<cv::Mat> ring_u, ring_v;     // the last `length` flows, flow i at i % length
  std::vector<std::int64_t> sum_u, sum_v;  // flow units
  std::vector<float> speed;                // sum of |flow|, flow units
  std::int64_t flows = 0, windows = 0;

  Impl(cv::Size frame, int step, double rate, const SpectrumOptions& o)
      : options(o),
        fps(rate),
        bands(motion_bands(o)),
        flow_size((frame.width + step - 1) / step, (frame.height + step - 1) / step),
        cell_side(o.cell / step),
        transform(window_length(rate, o), rate, o) {
    cells.cell = static_cast<float>(o.cell);
    cells.rows = (frame.height + o.cell - 1) / o.cell;
    cells.columns = (frame.width + o.cell - 1) / o.cell;
    cells.channels = motion_channels(o);
    cells.values.assign(static_cast<std::size_t>(cells.rows) * cells.columns * cells.channels, 0);
    ring_u.resize(transform.length);
    ring_v.resize(transform.length);
    sum_u.assign(static_cast<std::size_t>(flow_size.area()), 0);
    sum_v = sum_u;
    speed.assign(sum_u.size(), 0);
  }

  float* at(int row, int column) {
    return cells.values.data() + (static_cast<std::size_t>(row) * cells.columns + column) * cells.channels;
  }

  void add_means(const cv::Mat& u, const cv::Mat& v) {
    oneapi::tbb::parallel_for(0, flow_size.height, [&](int y) {
      using Shorts = Eigen::Map<const Eigen::Array<short, Eigen::Dynamic, 1>>;
      const int width = flow_size.width;
      const std::size_t first = static_cast<std::size_t>(y) * width;
      const Shorts row_u(u.ptr<short>(y), width), row_v(v.ptr<short>(y), width);
      using Sums = Eigen::Map<Eigen::Array<std::int64_t, Eigen::Dynamic, 1>>;
      Sums(sum_u.data() + first, width) += row_u.cast<std::int64_t>();
      Sums(sum_v.data() + first, width) += row_v.cast<std::int64_t>();
      Eigen::Map<Eigen::ArrayXf>(speed.data() + first, width) +=
          (row_u.cast<float>().square() + row_v.cast<float>().square()).sqrt();
    });
  }

  // Adds the power of the window that begins at flow `first`.
  void add_window(const Transform& dft, std::int64_t first) {
    ++windows;
    const int bins = static_cast<int>(dft.band.size());
    if (bins == 0) return;
    const int tasks = (cells.rows + kCellRowsPerTask - 1) / kCellRowsPerTask;
    oneapi::tbb::parallel_for(0, tasks, [&](int task) {
      // Whole panels, of which the first columns are used: a matrix that Eigen resizes where there is no memory is
      // freed twice.
      Matrix panel_u(dft.length, kPanel), panel_v(dft.length, kPanel);
      Matrix wave_u(dft.rows.rows(), kPanel), wave_v(dft.rows.rows(), kPanel);
      Matrix power(kBandChannels * bands, flow_size.width);  // of u, of v, crossed; of one row of cells
      const int last_row = std::min(cells.rows, (task + 1) * kCellRowsPerTask);
      for (int row = task * kCellRowsPerTask; row < last_row; ++row) {
        power.setZero();
        const int bottom = std::min(flow_size.height, (row + 1) * cell_side);
        for (int y = row * cell_side; y < bottom; ++y) {
          for (int x = 0; x < flow_size.width; x += kPanel) {
            const int width = std::min(kPanel, flow_size.width - x);
            for (int t = 0; t < dft.length; ++t) {
              const std::size_t slot =
                  static_cast<std::size_t>((first + t) % static_cast<std::int64_t>(ring_u.size()));
              const short* u = ring_u[slot].ptr<short>(y) + x;
              const short* v = ring_v[slot].ptr<short>(y) + x;
              float *to_u = &panel_u(t, 0), *to_v = &panel_v(t, 0);
              for (int i = 0; i < width; ++i) to_u[i] = u[i];
              for (int i = 0; i < width; ++i) to_v[i] = v[i];
            }
            wave_u.leftCols(width).noalias() = dft.rows * panel_u.leftCols(width);
            wave_v.leftCols(width).noalias() = dft.rows * panel_v.leftCols(width);
            for (int k = 0; k < bins; ++k) {
              const auto bin = [&](const Matrix& wave, int which) {
                return wave.row(which).head(width).array();
              };
              const auto ur = bin(wave_u, 2 * k), ui = bin(wave_u, 2 * k + 1);
              const auto vr = bin(wave_v, 2 * k), vi = bin(wave_v, 2 * k + 1);
              const int band = kBandChannels * dft.band[k];
              power.row(band).segment(x, width).array() += ur * ur + ui * ui;
              power.row(band + 1).segment(x, width).array() += vr * vr + vi * vi;
              power.row(band + 2).segment(x, width).array() += ur * vr + ui * vi;
            }
          }
        }
        for (int channel = 0; channel < kBandChannels * bands; ++channel) {
          const float* values = &power(channel, 0);
          for (int x = 0; x < flow_size.width; ++x)
            at(row, x / cell_side)[kMeanChannels + channel] += values[x];
        }
      }
    });
  }
};

MotionAccumulator::MotionAccumulator(cv::Size frame, int flow_step, double fps,
                                     const SpectrumOptions& options) {
  if (frame.width < 1 || frame.height < 1 || flow_step < 1 || !(fps > 0 && fps <= kMaxFps)) {
    throw Error(ErrorKind::kInput, "motion",
                "a frame of " + std::to_string(frame.width) + " x " + std::to_string(frame.height) +
                    " px at " + std::to_string(fps) +
                    " frames per second; at least 1 x 1 px and 0..1000 frames per second expected");
  }
  if (options.cell < 1 || options.cell % flow_step != 0) {
    throw Error(ErrorKind::kUsage, "motion",
                "cells of " + std::to_string(options.cell) + " px on a flow step of " +
                    std::to_string(flow_step) + " px",
                "Choose cells that are a multiple of the flow step");
  }
  impl_ = std::make_unique<Impl>(frame, flow_step, fps, options);
}

MotionAccumulator::~MotionAccumulator() = default;

void MotionAccumulator::add(const cv::Mat& u, const cv::Mat& v) {
  Impl& s = *impl_;
  if (u.type() != CV_16SC1 || v.type() != CV_16SC1 || u.size() != s.flow_size || v.size() != s.flow_size) {
    throw Error(ErrorKind::kUsage, "motion",
                "two CV_16S planes of " + std::to_string(s.flow_size.width) + " x " +
                    std::to_string(s.flow_size.height) + " expected");
  }
  const auto slot = static_cast<std::size_t>(s.flows % s.transform.length);
  u.copyTo(s.ring_u[slot]);
  v.copyTo(s.ring_v[slot]);
  s.add_means(u, v);
  ++s.flows;
  const int length = s.transform.length, hop = length / 2;
  if (s.flows >= length && (s.flows - length) % hop == 0) s.add_window(s.transform, s.flows - length);
}

cv::Mat MotionAccumulator::mean_speed_px() const {
  const Impl& s = *impl_;
  cv::Mat mean(s.flow_size, CV_32F);
  const float scale = s.flows ? kFlowUnit / static_cast<float>(s.flows) : 0;
  std::transform(s.speed.begin(), s.speed.end(), mean.begin<float>(), [&](float sum) { return sum * scale; });
  return mean;
}

CellMap MotionAccumulator::finish() {
  Impl& s = *impl_;
  if (s.flows < kMinFlows) {
    throw Error(ErrorKind::kInput, "motion", std::to_string(s.flows) + " flow maps, at least 8 expected",
                "Use a clip of 9 frames or more");
  }
  if (s.windows == 0) s.add_window(Transform(static_cast<int>(s.flows), s.fps, s.options), 0);

  for (int row = 0; row < s.cells.rows; ++row) {
    const int top = row * s.cell_side, bottom = std::min(s.flow_size.height, top + s.cell_side);
    for (int column = 0; column < s.cells.columns; ++column) {
      const int left = column * s.cell_side, right = std::min(s.flow_size.width, left + s.cell_side);
      std::int64_t u = 0, v = 0;
      for (int y = top; y < bottom; ++y) {
        for (int x = left; x < right; ++x) {
          u += s.sum_u[static_cast<std::size_t>(y) * s.flow_size.width + x];
          v += s.sum_v[static_cast<std::size_t>(y) * s.flow_size.width + x];
        }
      }
      const double pixels = static_cast<double>(bottom - top) * (right - left);
      const double px_per_s = s.fps * kFlowUnit / (pixels * static_cast<double>(s.flows));
      float* cell = s.at(row, column);
      cell[0] = static_cast<float>(static_cast<double>(u) * px_per_s);
      cell[1] = static_cast<float>(static_cast<double>(v) * px_per_s);
      const auto fraction = static_cast<float>(1 / (pixels * static_cast<double>(s.windows)));
      for (int channel = 2; channel < s.cells.channels; ++channel) cell[channel] *= fraction;
    }
  }
  return std::move(s.cells);
}

std::vector<double> naive_power(std::span<const double> series, double fps, const SpectrumOptions& options) {
  const int flows = static_cast<int>(series.size());
  const int length = std::min(flows, window_length(fps, options));
  std::vector<double> power(static_cast<std::size_t>(nominal_bins(options)) + 1);
  if (flows < kMinFlows) return power;
  int windows = 0;
  for (int first = 0; first + length <= flows; first += length / 2) ++windows;
  for (int first = 0; first + length <= flows; first += length / 2) {
    double mean = 0;
    for (int t = 0; t < length; ++t) mean += series[first + t] / length;
    for (int k = 1; k <= last_bin(length, fps, options); ++k) {
      std::complex<double> sum = 0;
      for (int t = 0; t < length; ++t) {
        sum +=
            (series[first + t] - mean) * std::polar(hann(t, length), -2 * std::numbers::pi * k * t / length);
      }
      power[nominal_bin(k * fps / length, options)] += std::norm(sum) * power_scale(k, length) / windows;
    }
  }
  return power;
}

}  // namespace freshet::vision
