#include "synth/animate/blend/blend.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"
#include "synth/animate/placement/piece_values.h"
#include "synth/sampling/square_pyramid.h"
#include "vision/dot.h"
#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

/// One level: adds its band, leaves the next one's square in `low`.
FRESHET_WIDE void add_level(const float* current, const float* weight, int n, float* line, float* low,
                            float* wide, float* sum, std::ptrdiff_t stride) {
  sampling::reduce_square(current, n, line, low);
  sampling::widen_square(low, n, line, wide);
  sampling::add_band(current, wide, weight, n, sum, stride);
}

FRESHET_WIDE void scale_weights(const float* weight, float gain, int n, float* to) {
  for (int i = 0; i < n; ++i) to[i] = gain * weight[i];
}

FRESHET_WIDE void add_rest(const float* current, const float* weight, int n, float* sum,
                           std::ptrdiff_t stride) {
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) sum[y * stride + x] += current[y * n + x] * weight[y * n + x];
}

FRESHET_WIDE void column_sums(const float* from, std::ptrdiff_t stride, int n, float* sums) {
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) sums[x] += from[y * stride + x];
}

FRESHET_WIDE void take_off(const float* from, std::ptrdiff_t stride, float mean, int n, float* to) {
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) to[y * n + x] = from[y * stride + x] - mean;
}

/// The weight of a piece at one level: its own square, softened over the level's wavelength. Never zero, so
/// that a piece without neighbours still covers all of its side.
cv::Mat level_weight(int side, int stride, int level) {
  const double centre = (side - 1) / 2.0;
  // At full resolution the transition is some 4, 8, 16 px wide at levels 0, 1, 2 and the whole overlap below.
  const double sigma = std::min(1.2 * (1 << level), stride / 3.5);
  const int step = 1 << level, size = side / step;
  const auto profile = [&](int i) {
    const double x = std::abs(i * step - centre) - stride / 2.0;  // px outside the own square
    const double tent = 1 - std::abs(i * step - centre) / (side / 2.0 + 1);
    return 0.5 * std::erfc(x / (sigma * std::sqrt(2.0))) + 1e-4 * std::max(tent, 0.0);
  };
  cv::Mat weight(size, size, CV_32F);
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column)
      weight.at<float>(row, column) = static_cast<float>(profile(row) * profile(column));
  return weight;
}

float mean_of(const cv::Mat& window, std::vector<float>& line) {
  CV_Assert(window.type() == CV_32F && window.rows == window.cols);
  line.assign(static_cast<std::size_t>(window.cols), 0.0f);
  column_sums(window.ptr<float>(), static_cast<std::ptrdiff_t>(window.step1()), window.cols, line.data());
  double sum = 0;
  for (int x = 0; x < window.cols; ++x) sum += line[x];
  return static_cast<float>(sum / window.cols / window.cols);
}

}  // namespace

struct Blender::Impl {
  Placement placement;
  BlendOptions options;
  cv::Rect canvas;
  std::vector<cv::Mat> weight;              // by level, side / 2^level
  std::vector<cv::Mat> gain;                // by level, canvas / 2^level
  std::vector<std::vector<cv::Mat>> bands;  // by frame, level
  std::vector<float> scales;                // by patch, level; empty: 1
  std::optional<PieceValues> lattice;       // of the placement
  std::vector<cv::Mat> mean_luma_of_piece;  // by frame, on the lattice

  struct Scratch {
    std::vector<float> current, low, wide, line, weight;
  };
  oneapi::tbb::enumerable_thread_specific<Scratch> scratch;

  void add(int frame, std::size_t patch, const cv::Mat& difference, float mean);
  cv::Rect at_level(std::size_t patch, int level) const {
    const cv::Point corner = placement.patches[patch].piece - canvas.tl();
    const int side = placement.side >> level;
    return {corner.x >> level, corner.y >> level, side, side};
  }

  /// 1 / sum of weights, or 1 / sqrt(w' C w) with C = 1 inside a coherent group and 0 between groups.
  cv::Mat gain_of_level(int level) const {
    const cv::Size size(canvas.width >> level, canvas.height >> level);
    // Pieces of one lattice parity do not overlap: with a stride of half the side four planes hold every
    // pixel's pieces.
    const int overlap = (placement.side + placement.stride - 1) / placement.stride;
    std::vector<cv::Mat> owner(overlap * overlap), fraction(overlap * overlap);
    for (cv::Mat& plane : owner) plane = cv::Mat(size, CV_32S, cv::Scalar(-1));
    for (cv::Mat& plane : fraction) plane = cv::Mat::zeros(size, CV_32F);
    for (std::size_t p = 0; p < placement.patches.size(); ++p) {
      const cv::Point at = lattice->at(p);
      const int parity = (at.y % overlap) * overlap + at.x % overlap;
      owner[parity](at_level(p, level)).setTo(static_cast<int>(p));
      weight[level].copyTo(fraction[parity](at_level(p, level)));
    }
    cv::Mat out = cv::Mat::zeros(size, CV_32F);
    std::vector<int> who(owner.size());
    std::vector<double> w(owner.size());
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        std::size_t n = 0;
        double sum = 0;
        for (std::size_t k = 0; k < owner.size(); ++k) {
          const int p = owner[k].at<int>(y, x);
          if (p < 0) continue;
          who[n] = p;
          w[n] = fraction[k].at<float>(y, x);
          sum += w[n++];
        }
        if (n == 0) continue;
        double norm = sum;
        if (options.weights == BlendWeights::kVariance) {
          double squares = 0;
          for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j)
              if (i == j || coherent(placement.patches[who[i]], placement.patches[who[j]]))
                squares += w[i] * w[j];
          norm = std::sqrt(squares);
        }
        out.at<float>(y, x) = static_cast<float>(1 / norm);
      }
    return out;
  }
};

Blender::Blender(const Placement& placement, int frames, const BlendOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->placement = placement;
  impl_->options = options;
  // A level whose samples fall between the lattice's would lay the pieces beside their places.
  const auto step = static_cast<unsigned>(common_step(placement, 1 << options.levels));
  int levels = std::countr_zero(step);
  while (levels > 0 && placement.side >> (levels - 1) < sampling::kMinSquare) --levels;
  impl_->options.levels = levels;
  impl_->canvas = canvas_of(placement);
  impl_->lattice.emplace(placement);
  for (int level = 0; level <= levels; ++level)
    impl_->weight.push_back(level_weight(placement.side, placement.stride, level));
  for (int level = 0; level <= levels; ++level) impl_->gain.push_back(impl_->gain_of_level(level));
  impl_->bands.resize(frames);
  impl_->mean_luma_of_piece.resize(frames);
}

Blender::~Blender() = default;

void Blender::add(int frame, std::size_t patch, const cv::Mat& difference) {
  const bool keep = impl_->options.low_band == LowBand::kKeep;
  impl_->add(frame, patch, difference, keep ? 0 : mean_of(difference, impl_->scratch.local().line));
}

/// A piece's bands, less its mean; and that, its level.
void Blender::Impl::add(int frame, std::size_t patch, const cv::Mat& difference, float mean) {
  Impl& self = *this;
  std::vector<cv::Mat>& sums = self.bands[frame];
  const int levels = self.options.levels;
  // Anew, or over what was not taken of the frame before.
  if (sums.empty() || self.mean_luma_of_piece[frame].empty()) {
    sums.clear();
    for (int level = 0; level <= levels; ++level)
      sums.push_back(cv::Mat::zeros(self.canvas.height >> level, self.canvas.width >> level, CV_32F));
    self.mean_luma_of_piece[frame] = self.lattice->none();
  }
  Impl::Scratch& s = self.scratch.local();
  const int side = self.placement.side, area = side * side;
  s.current.resize(area);
  s.low.resize(area);
  s.wide.resize(area);
  s.line.resize(side + 4);
  s.weight.resize(area);
  self.mean_luma_of_piece[frame].at<float>(self.lattice->at(patch)) = mean;
  const auto* values = difference.ptr<float>();
  const auto row = static_cast<std::ptrdiff_t>(difference.step1());
  take_off(values, row, mean, side, s.current.data());
  for (int level = 0; level <= levels; ++level) {
    const cv::Rect at = self.at_level(patch, level);
    float* sum = sums[level].ptr<float>(at.y) + at.x;
    const auto stride = static_cast<std::ptrdiff_t>(sums[level].step1());
    const auto* weights = self.weight[level].ptr<float>();
    if (!self.scales.empty()) {
      scale_weights(weights, self.scales[patch * (levels + 1) + level], at.area(), s.weight.data());
      weights = s.weight.data();
    }
    if (level == levels) {
      add_rest(s.current.data(), weights, at.width, sum, stride);
    } else {
      add_level(s.current.data(), weights, at.width, s.line.data(), s.low.data(), s.wide.data(), sum, stride);
      std::swap(s.current, s.low);
    }
  }
}

int Blender::levels() const { return impl_->options.levels + 1; }

void Blender::scale(std::size_t patch, std::span<const float> gains) {
  const auto levels = static_cast<std::size_t>(this->levels());
  CV_Assert(gains.size() == levels);
  impl_->scales.resize(impl_->placement.patches.size() * levels, 1.0f);
  std::copy(gains.begin(), gains.end(), impl_->scales.begin() + static_cast<std::ptrdiff_t>(patch * levels));
}

std::vector<double> Blender::band_power(const cv::Mat& window) {
  std::vector<double> power;
  cv::Mat current = window - cv::mean(window)[0], low, wide;
  for (int level = 0; level < levels(); ++level) {
    const bool last = level + 1 == levels();
    if (!last) {
      cv::pyrDown(current, low);
      cv::pyrUp(low, wide, current.size());
    }
    const cv::Mat band = last ? current : cv::Mat(current - wide);
    power.push_back(vision::dot(band, band) / static_cast<double>(band.total()));
    std::swap(current, low);
  }
  return power;
}

cv::Mat Blender::take_detail(int frame) {
  Impl& self = *impl_;
  std::vector<cv::Mat>& bands = self.bands[frame];
  if (bands.empty()) return cv::Mat::zeros(self.canvas.size(), CV_32F);
  for (std::size_t level = 0; level < bands.size(); ++level)
    cv::multiply(bands[level], self.gain[level], bands[level]);
  return vision::collapse(std::exchange(bands, {}));
}

cv::Mat Blender::take_level(int frame) {
  Impl& self = *impl_;
  if (self.options.low_band != LowBand::kShared || self.mean_luma_of_piece[frame].empty())
    return cv::Mat::zeros(self.canvas.size(), CV_32F);
  cv::Mat field = self.lattice->over_canvas(self.mean_luma_of_piece[frame], self.options.low_band_reach);
  self.mean_luma_of_piece[frame].release();
  return field;
}

void Blender::drop(int frame) {
  impl_->bands[frame].clear();
  impl_->mean_luma_of_piece[frame].release();
}

}  // namespace freshet::synth::animate
