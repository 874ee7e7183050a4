#include "synth/animate/still/appearance.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"
#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

constexpr int kBins = 512;
constexpr double kPrior = 24;  // pixels' worth of "leave it as it is" in each region

/// The regions around a sample and their weights.
struct Mixture {
  int first = 0, second = 0;
  float fraction = 0;  // of the second
};

std::vector<Mixture> mixtures(int samples, double region, int regions) {
  std::vector<Mixture> out(samples);
  for (int i = 0; i < samples; ++i) {
    const double at = std::clamp((i + 0.5) / region - 0.5, 0.0, static_cast<double>(regions - 1));
    out[i].first = std::min(static_cast<int>(at), regions - 1);
    out[i].second = std::min(out[i].first + 1, regions - 1);
    out[i].fraction = static_cast<float>(at - out[i].first);
  }
  return out;
}

/// How far along the bins each value lies.
FRESHET_WIDE void find_bins(const float* values, float low, float scale, int n, std::int32_t* bin,
                            float* bin_fraction) {
  for (int i = 0; i < n; ++i) {
    const float at = std::min(std::max((values[i] - low) * scale, 0.0f), kBins - 1e-3f);
    bin[i] = static_cast<std::int32_t>(at);
    bin_fraction[i] = at - static_cast<float>(bin[i]);
  }
}

/// A run of pixels that lie between the same four regions: their maps' values, mixed.
FRESHET_WIDE void map_run(const float* map, const std::int32_t* bin, const float* bin_fraction,
                          const float* across, float down, int n, float* out) {
  typedef float Quad __attribute__((vector_size(16)));
  typedef float UnalignedQuad __attribute__((vector_size(16), aligned(4), may_alias));
  constexpr int kRun = 64;
  alignas(64) float found[4 * kRun];
  for (int first = 0; first < n; first += kRun) {
    const int count = std::min(kRun, n - first);
    for (int i = 0; i < count; ++i) {
      const auto* at = reinterpret_cast<const UnalignedQuad*>(map) + bin[first + i];
      *reinterpret_cast<Quad*>(found + 4 * i) = at[0] + bin_fraction[first + i] * (at[1] - at[0]);
    }
    for (int i = 0; i < count; ++i) {
      const float *f = found + 4 * i, h = across[first + i];
      out[first + i] = (1 - down) * ((1 - h) * f[0] + h * f[1]) + down * ((1 - h) * f[2] + h * f[3]);
    }
  }
}

/// Adds a picture's values to the histograms of the regions that mix at each sample.
void accumulate(const cv::Mat& values, const cv::Mat& weight, float low, float reach,
                const std::vector<Mixture>& across, const std::vector<Mixture>& down, int columns,
                std::vector<double>& histograms) {
  const float scale = kBins / reach;
  for (int y = 0; y < values.rows; ++y) {
    const float* value = values.ptr<float>(y);
    const float* w = weight.ptr<float>(y);
    for (int x = 0; x < values.cols; ++x) {
      if (w[x] <= 0) continue;
      const int bin = std::clamp(static_cast<int>((value[x] - low) * scale), 0, kBins - 1);
      const Mixture &h = across[x], &v = down[y];
      const auto add = [&](int row, int column, float fraction) {
        histograms[(static_cast<std::size_t>(row) * columns + column) * kBins + bin] += fraction * w[x];
      };
      add(v.first, h.first, (1 - v.fraction) * (1 - h.fraction));
      add(v.first, h.second, (1 - v.fraction) * h.fraction);
      add(v.second, h.first, v.fraction * (1 - h.fraction));
      add(v.second, h.second, v.fraction * h.fraction);
    }
  }
}

struct Bins {
  double low, step;
};

/// The map of one region: for each edge of a bin, the value below which the target holds the same fraction.
/// map   kBins + 1 values
void match_quantiles(const double* found, const double* wanted, const Bins& bins, double max_gain,
                     bool around_zero, float* map) {
  double found_mass = 0, wanted_mass = 0;
  for (int i = 0; i < kBins; ++i) found_mass += found[i], wanted_mass += wanted[i];
  const auto median = [&](const double* histogram, double mass) {
    double sum = 0;
    int i = 0;
    while (i < kBins - 1 && sum + histogram[i] < mass / 2) sum += histogram[i++];
    return bins.low + (i + 0.5) * bins.step;
  };
  const double found_middle = around_zero ? 0 : median(found, found_mass);
  const double wanted_middle = around_zero ? 0 : median(wanted, wanted_mass);
  const double trust = wanted_mass / (wanted_mass + kPrior);
  double below = 0, target_below = 0;
  int j = 0;
  for (int i = 0; i <= kBins; ++i) {
    const double identity = bins.low + i * bins.step;
    double value = identity;
    if (found_mass > 0 && wanted_mass > 0) {
      const double fraction = below / found_mass * wanted_mass;
      while (j < kBins - 1 && target_below + wanted[j] < fraction) target_below += wanted[j++];
      value = bins.low +
              (j + (wanted[j] > 0 ? std::clamp((fraction - target_below) / wanted[j], 0.0, 1.0) : 0.0)) *
                  bins.step;
      // No further from the middle than the gain allows; the middle of a band is zero.
      const double maximum = std::abs(identity - found_middle) * max_gain + bins.step;
      value = std::clamp(value, wanted_middle - maximum, wanted_middle + maximum);
      value = identity + trust * (value - identity);
    }
    map[i] = static_cast<float>(value);
    if (i < kBins) below += found[i];
  }
  if (around_zero) {
    // What is zero stays zero: else a still place would gain a pattern.
    const float at_zero = map[kBins / 2];
    for (int i = 0; i <= kBins; ++i) map[i] -= at_zero;
  }
}

/// Of each region its own map and those right of it, below it and both, value by value.
std::vector<float> interleaved(const std::vector<float>& maps, int rows, int columns) {
  std::vector<float> out(4 * maps.size());
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      for (int k = 0; k < 4; ++k) {
        const int near_row = std::min(row + k / 2, rows - 1),
                  near_column = std::min(column + k % 2, columns - 1);
        const float* from = maps.data() + (near_row * columns + near_column) * (kBins + 1);
        float* to = out.data() + 4 * (row * columns + column) * (kBins + 1) + k;
        for (int i = 0; i <= kBins; ++i) to[4 * i] = from[i];
      }
  return out;
}

}  // namespace

AppearanceModel::Band AppearanceModel::fit(const cv::Mat& target, const cv::Mat& weight,
                                           std::span<const cv::Mat> samples, double region, double max_gain,
                                           bool around_zero) {
  Band band;
  // The range that holds every value, symmetrical for bands.
  double low = 0, high = 0;
  cv::minMaxLoc(target, &low, &high);
  for (const cv::Mat& sample : samples) {
    double a = 0, b = 0;
    cv::minMaxLoc(sample, &a, &b);
    low = std::min(low, a);
    high = std::max(high, b);
  }
  if (around_zero) high = std::max(std::abs(low), std::abs(high)), low = -high;
  band.low = static_cast<float>(low);
  band.reach = static_cast<float>(std::max(high - low, 1e-4));
  band.columns = std::max(1, static_cast<int>(std::lround(target.cols / region)));
  band.rows = std::max(1, static_cast<int>(std::lround(target.rows / region)));

  const std::vector<Mixture> across =
      mixtures(target.cols, static_cast<double>(target.cols) / band.columns, band.columns);
  const std::vector<Mixture> down =
      mixtures(target.rows, static_cast<double>(target.rows) / band.rows, band.rows);
  const std::size_t regions = static_cast<std::size_t>(band.columns) * band.rows;
  // The last is the target's. Each by itself and summed in order: the same for any number of threads.
  std::vector<std::vector<double>> histograms(samples.size() + 1);
  oneapi::tbb::parallel_for(std::size_t{0}, histograms.size(), [&](std::size_t i) {
    histograms[i].assign(regions * kBins, 0.0);
    accumulate(i < samples.size() ? samples[i] : target, weight, band.low, band.reach, across, down,
               band.columns, histograms[i]);
  });
  const std::vector<double> wanted = std::move(histograms.back());
  histograms.pop_back();
  std::vector<double> found(regions * kBins, 0.0);
  for (const std::vector<double>& own : histograms)
    for (std::size_t i = 0; i < own.size(); ++i) found[i] += own[i];

  std::vector<float> maps(regions * (kBins + 1));
  oneapi::tbb::parallel_for(std::size_t{0}, regions, [&](std::size_t r) {
    match_quantiles(found.data() + r * kBins, wanted.data() + r * kBins, {band.low, band.reach / kBins},
                    max_gain, around_zero, maps.data() + r * (kBins + 1));
  });
  band.map = interleaved(maps, band.rows, band.columns);
  return band;
}

void AppearanceModel::apply_band(const Band& band, cv::Mat& values) {
  const std::vector<Mixture> across =
      mixtures(values.cols, static_cast<double>(values.cols) / band.columns, band.columns);
  const std::vector<Mixture> down =
      mixtures(values.rows, static_cast<double>(values.rows) / band.rows, band.rows);
  std::vector<float> fraction(across.size()), bin_fraction(across.size());
  for (std::size_t x = 0; x < across.size(); ++x) fraction[x] = across[x].fraction;
  std::vector<std::int32_t> bin(across.size());
  const float scale = kBins / band.reach;
  for (int y = 0; y < values.rows; ++y) {
    float* value = values.ptr<float>(y);
    find_bins(value, band.low, scale, values.cols, bin.data(), bin_fraction.data());
    const float* row =
        band.map.data() + static_cast<std::size_t>(down[y].first) * band.columns * 4 * (kBins + 1);
    for (int begin = 0, end = 0; begin < values.cols; begin = end) {
      while (end < values.cols && across[end].first == across[begin].first) ++end;
      map_run(row + static_cast<std::size_t>(across[begin].first) * 4 * (kBins + 1), bin.data() + begin,
              bin_fraction.data() + begin, fraction.data() + begin, down[y].fraction, end - begin,
              value + begin);
    }
  }
}

AppearanceModel::AppearanceModel(const cv::Mat& target, const cv::Mat& matte,
                                 std::span<const cv::Mat> samples, const AppearanceOptions& options) {
  // Small pictures have fewer levels: the coarsest band must keep a few samples.
  while (levels_ < options.levels && (std::min(target.cols, target.rows) >> (levels_ + 1)) >= 8) ++levels_;
  std::vector<cv::Mat> target_bands;
  vision::laplacian_pyramid(target, levels_, target_bands);
  std::vector<std::vector<cv::Mat>> sample_bands(samples.size());
  oneapi::tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
    vision::laplacian_pyramid(samples[i], levels_, sample_bands[i]);
  });
  for (int level = 0; level < levels_; ++level) {
    cv::Mat weight;
    cv::resize(matte, weight, target_bands[level].size(), 0, 0, cv::INTER_AREA);
    std::vector<cv::Mat> found;
    for (const auto& bands : sample_bands) found.push_back(bands[level]);
    // Coarser bands have fewer samples, so their regions grow, though slower than the samples spread.
    const double region = options.region_px * std::pow(1.3, level) / (1 << level);
    bands_.push_back(fit(target_bands[level], weight, found, region, options.max_gain, true));
  }
  std::vector<cv::Mat> matched(samples.size());
  oneapi::tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
    for (int level = 0; level < levels_; ++level) apply_band(bands_[level], sample_bands[i][level]);
    matched[i] = vision::collapse(std::move(sample_bands[i]));
  });
  picture_ = fit(target, matte, matched, options.region_px * 1.5, options.max_level_gain, false);
}

cv::Mat AppearanceModel::apply(const cv::Mat& luma) const {
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(luma, levels_, bands);
  for (int level = 0; level < levels_; ++level) apply_band(bands_[level], bands[level]);
  cv::Mat out = vision::collapse(std::move(bands));
  apply_band(picture_, out);
  return out;
}

}  // namespace freshet::synth::animate
