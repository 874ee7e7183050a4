#include "synth/scene/measured/sway_fit.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include <opencv2/core.hpp>

#include "synth/scene/wind/wind_spectrum.h"

namespace freshet::synth::scene {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kUsualRatio = 0.1;   // of critical damping
constexpr double kDampingFactor = 4;  // deviation of the prior
constexpr double kApart = 2.0 / 3;    // of a Hann window's neighbouring bins: how many tell something new
constexpr double kUnseen =
    0.005;  // of the strongest bin: what is less tells of branches on the branch, and of light

/// Of a series without its mean, through a Hann window: the power density at whole oscillations in its length, and what
/// is to be expected of it.
class Periodogram {
 public:
  Periodogram(int frames, double fps)
      : bins_(static_cast<int>(0.45 * frames)), step_hz_(fps / cv::getOptimalDFTSize(4 * frames)) {
    const int size = cv::getOptimalDFTSize(4 * frames);
    cv::Mat window(1, frames, CV_64F);
    for (int t = 0; t < frames; ++t) window.at<double>(t) = 0.5 - 0.5 * std::cos(kTurn * (t + 0.5) / frames);
    const double whole = cv::sum(window)[0];
    window /= std::sqrt(window.dot(window) * fps / 2);
    weights_.create(bins_, frames, CV_64FC2);
    gains_.create(bins_, size / 2 + 1, CV_64F);
    cv::Mat row(1, size, CV_64FC2, cv::Scalar::all(0)), passes;
    for (int bin = 0; bin < bins_; ++bin) {
      std::complex<double> of_mean = 0;
      std::vector<std::complex<double>> waves;
      for (int t = 0; t < frames; ++t) {
        waves.push_back(std::polar(1.0, -kTurn * (bin + 1) * t / frames));
        of_mean += (0.5 - 0.5 * std::cos(kTurn * (t + 0.5) / frames)) / whole * waves.back();
      }
      for (int t = 0; t < frames; ++t) {
        const auto weight = window.at<double>(t) * (waves[static_cast<std::size_t>(t)] - of_mean);
        weights_.at<cv::Vec2d>(bin, t) = row.at<cv::Vec2d>(t) = {weight.real(), weight.imag()};
      }
      cv::dft(row, passes);
      // Both sides of the spectrum, of which a one-sided density has a half each.
      for (int i = 0; i < gains_.cols; ++i) {
        const cv::Vec2d &right = passes.at<cv::Vec2d>(i), &left = passes.at<cv::Vec2d>((size - i) % size);
        gains_.at<double>(bin, i) = step_hz_ / 2 * (right.dot(right) + (i > 0 ? left.dot(left) : 0));
      }
    }
  }

  /// Units^2 / Hz.
  std::vector<double> of(const std::vector<float>& series) const {
    std::vector<double> power;
    for (int bin = 0; bin < bins_; ++bin) {
      cv::Vec2d sum;
      for (int t = 0; t < weights_.cols; ++t)
        sum += weights_.at<cv::Vec2d>(bin, t) * static_cast<double>(series[static_cast<std::size_t>(t)]);
      power.push_back(sum.dot(sum));
    }
    return power;
  }
  /// Of a one-sided density, which is told f in Hz.
  template <class Density>
  std::vector<double> expected(const Density& density) const {
    cv::Mat densities(gains_.cols, 1, CV_64F), sums;
    for (int i = 0; i < gains_.cols; ++i) densities.at<double>(i) = density(i * step_hz_);
    cv::gemm(gains_, densities, 1, {}, 0, sums);
    return sums;
  }

 private:
  int bins_;
  double step_hz_;
  cv::Mat weights_;  // bins x frames, complex
  cv::Mat gains_;    // bins x frequencies
};

/// Density of noise, as what is faster than plants shows it. A median of powers is ln 2 of their mean.
double noise_of(const std::vector<double>& seen) {
  std::vector<double> fast(seen.begin() + static_cast<std::ptrdiff_t>(2 * seen.size() / 3), seen.end());
  const auto middle = fast.begin() + static_cast<std::ptrdiff_t>(fast.size() / 2);
  std::nth_element(fast.begin(), middle, fast.end());
  return *middle / std::numbers::ln2;
}

/// How much of what is expected is most likely, over a floor, and how unlikely that is (minus the logarithm).
std::pair<double, double> most_likely(const std::vector<double>& seen, const std::vector<double>& expected,
                                      double floor) {
  constexpr int kRounds = 30;
  double level = cv::sum(seen)[0] / cv::sum(expected)[0], unlikely = 0;
  for (int round = 0; round <= kRounds; ++round) {
    double up = 0, down = 0;
    unlikely = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double all = level * expected[i] + floor;
      unlikely += std::log(all) + seen[i] / all;
      up += expected[i] * seen[i] / (all * all);
      down += expected[i] / all;
    }
    if (round < kRounds) level *= up / down;
  }
  return {level, unlikely};
}

}  // namespace

SwayFit fit_sway(std::span<const std::vector<float>> tips, double fps, const Wind& wind, double strength) {
  const auto frames = static_cast<int>(tips[0].size());
  const Periodogram periodogram(frames, fps);
  SwayFit best;
  std::vector<double> seen;
  for (const std::vector<float>& tip : tips) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(tip, mean, deviation);
    best.deviation += deviation[0] / static_cast<double>(tips.size());
    const std::vector<double> power = periodogram.of(tip);
    seen.resize(power.size());
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i] += power[i] / static_cast<double>(tips.size());
  }
  const double noise = noise_of(seen), floor = noise + kUnseen * std::ranges::max(seen);
  best.noise = noise * fps / 2 / std::max(best.deviation * best.deviation, 1e-12);
  const double slowest = fps / frames, fastest = fps / 4;
  double least = std::numeric_limits<double>::infinity();
  const auto attempt = [&](double natural_hz, double ratio) {
    const double damping = 2 * kTurn * natural_hz * ratio;
    const std::vector<double> sway = periodogram.expected([&](double f) {
      const double stiff = kTurn * kTurn * (natural_hz * natural_hz - f * f), slow = kTurn * damping * f;
      return strength * strength * wind_power(wind, f) / (stiff * stiff + slow * slow);
    });
    const auto [level, by_sight] = most_likely(seen, sway, floor);
    const double off = std::log(ratio / kUsualRatio) / std::log(kDampingFactor);
    const double unlikely = kApart * by_sight + off * off / 2;
    if (!(unlikely < least)) return false;
    least = unlikely;
    best.frequency_hz = natural_hz;
    best.damping_per_s = damping;
    best.mass = 1 / std::sqrt(level);
    return true;
  };
  // Everywhere coarsely, then in ever finer steps about the best.
  for (double hz = slowest; hz <= fastest; hz *= 1.1)
    for (const double ratio : {0.04, 0.12, 0.4}) attempt(hz, ratio);
  for (double step = 1.4; step > 1.01; step = std::sqrt(step))
    for (bool better = true; better;) {
      better = false;
      for (const double by : {1 / step, step}) {
        const double hz = best.frequency_hz, ratio = best.damping_per_s / (2 * kTurn * hz);
        better |= attempt(std::clamp(hz * std::pow(by, 0.2), slowest, fastest), ratio);
        better |= attempt(hz, std::clamp(ratio * by, 0.01, 1.0));
      }
    }
  return best;
}

}  // namespace freshet::synth::scene
