#include "synth/scene/water/height_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include "synth/scene/wind/gaussian.h"

namespace freshet::synth::scene {
namespace {

constexpr double kGravity = 9.81, kTurn = 2 * std::numbers::pi;
constexpr double kSeaHeight = 0.0525;  // standard deviation of a developed sea's heights, of v^2 / g
constexpr double kUsualSide = 25;      // of a tile, in L: three of the longest waves that matter
constexpr double kSecondSide = 0.618;  // of the second tile, in the first's: no small ratio of whole numbers
constexpr int kRowsAtOnce = 32;

/// The wave number of row or column i of n.
double wave_number(int i, int n, double side_m) { return kTurn * (i <= n / 2 ? i : i - n) / side_m; }

/// Eq. 11 with Eq. 12's direction, without its factor. k   1/m on the water.
double phillips(cv::Point2d k, double length_m, cv::Point2d wind) {
  const double square = k.x * k.x + k.y * k.y;
  if (!(square > 0)) return 0;
  const double along = k.x * wind.x + k.y * wind.y;
  return std::exp(-1 / (square * length_m * length_m)) / (square * square) * along * along / square;
}

}  // namespace

HeightField::HeightField(const WaterMotion& water, const Wind& wind, const Cycle& cycle, std::uint64_t seed,
                         What what)
    : n_(water.tile), what_(what), cycle_(cycle) {
  const double length = wind.speed_m_per_s * wind.speed_m_per_s / kGravity;
  const double side = water.tile_m.value_or(kUsualSide * std::max(length, 1e-3)) / water.roughness;
  side_m_ = {side, kSecondSide * side};
  deviation_m_ = water.amplitude_or_usual() * kSeaHeight * length / water.roughness;
  phasor_.resize(static_cast<std::size_t>(cycle.frames));
  for (int t = 0; t < cycle.frames; ++t)
    phasor_[static_cast<std::size_t>(t)] = std::polar(1.0, kTurn * t / cycle.frames);
  for (int tile = 0; tile < kTiles; ++tile) fill(tile, water, wind, seed);
  spectrum_.create(n_, n_, CV_32FC2);
  half_.create(n_, n_, CV_32FC2);
  whole_.create(n_, n_, CV_32FC2);
  planes_.resize(static_cast<std::size_t>(planes()));
  for (cv::Mat& plane : planes_) plane.create(n_, n_, CV_32F);
}

void HeightField::fill(int tile, const WaterMotion& water, const Wind& wind, std::uint64_t seed) {
  const double side = side_m_[static_cast<std::size_t>(tile)];
  const double length = wind.speed_m_per_s * wind.speed_m_per_s / kGravity / water.roughness;
  const double angle = wind.direction_deg * std::numbers::pi / 180;
  const cv::Point2d blows(std::cos(angle), std::sin(angle));
  const Random random(seed, 1000 + static_cast<std::uint64_t>(tile));
  std::vector<Wave>& waves = waves_[static_cast<std::size_t>(tile)];
  waves.assign(static_cast<std::size_t>(n_) * static_cast<std::size_t>(n_), {});
  if (!(length > 0)) return;
  const auto place = [this](int x, int y) {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(n_) + static_cast<std::size_t>(y);
  };
  double power = 0;
  for (int x = 0; x < n_; ++x) {
    for (int y = 0; y < n_; ++y) {
      // At half the sampling rate a wave and its opposite are one: it could not move.
      if (x == n_ / 2 || y == n_ / 2 || (x == 0 && y == 0)) continue;
      const cv::Point2d k(wave_number(x, n_, side), wave_number(y, n_, side));
      // exp(i (k q + omega t)) goes against k.
      const double into_wind = k.dot(blows) > 0 ? water.against : 1;
      const double square = phillips(k, length, blows) * into_wind * into_wind;
      power += 2 * square;
      Wave& wave = waves[place(x, y)];
      wave.forth = complex_gaussian(random, place(x, y)) * std::sqrt(square);
      const double omega = std::sqrt(kGravity * std::hypot(k.x, k.y));
      wave.harmonic = static_cast<std::uint32_t>(std::max(1.0, std::round(omega * cycle_.seconds() / kTurn)));
      wave.harmonic %= static_cast<std::uint32_t>(cycle_.frames);
    }
  }
  // Of the two tiles each has half of the variance.
  const double scale = power > 0 ? deviation_m_ / std::sqrt(2 * power) : 0;
  for (Wave& wave : waves) wave.forth *= static_cast<float>(scale);
  for (int x = 0; x < n_; ++x)
    for (int y = 0; y < n_; ++y)
      waves[place(x, y)].back = std::conj(waves[place((n_ - x) % n_, (n_ - y) % n_)].forth);
}

std::complex<float> HeightField::height(const Wave& wave, std::uint32_t frame) const {
  const auto place =
      static_cast<std::uint64_t>(wave.harmonic) * frame % static_cast<std::uint64_t>(cycle_.frames);
  const std::complex<float> turn = phasor_[place];
  // Written out: std::complex's product asks for not-a-numbers.
  return {wave.forth.real() * turn.real() - wave.forth.imag() * turn.imag() + wave.back.real() * turn.real() +
              wave.back.imag() * turn.imag(),
          wave.forth.real() * turn.imag() + wave.forth.imag() * turn.real() - wave.back.real() * turn.imag() +
              wave.back.imag() * turn.real()};
}

/// Two real fields come out of one complex transform: real parts to `to_plane`, imaginary ones to the next.
void HeightField::transform(int to_plane) {
  using oneapi::tbb::blocked_range;
  const auto rows_of = [this](const cv::Mat& from, cv::Mat& to) {
    oneapi::tbb::parallel_for(blocked_range<int>(0, n_, kRowsAtOnce), [&](const blocked_range<int>& rows) {
      cv::Mat part = to.rowRange(rows.begin(), rows.end());
      cv::dft(from.rowRange(rows.begin(), rows.end()), part, cv::DFT_INVERSE | cv::DFT_ROWS);
    });
  };
  rows_of(spectrum_, half_);
  cv::transpose(half_, turned_);
  rows_of(turned_, whole_);
  cv::Mat pair[] = {planes_[static_cast<std::size_t>(to_plane)],
                    planes_[static_cast<std::size_t>(to_plane) + 1]};
  cv::split(whole_, pair);
}

void HeightField::go_to(int frame) {
  const auto at = static_cast<std::uint32_t>(cycle_.place(frame));
  using oneapi::tbb::blocked_range;
  const auto for_columns = [this](auto&& value) {
    oneapi::tbb::parallel_for(blocked_range<int>(0, n_, kRowsAtOnce), [&](const blocked_range<int>& columns) {
      for (int x = columns.begin(); x < columns.end(); ++x) {
        auto* out = spectrum_.ptr<cv::Vec2f>(x);
        for (int y = 0; y < n_; ++y) {
          const std::complex<float> v = value(x, y, static_cast<std::size_t>(x) * n_ + y);
          out[y] = {v.real(), v.imag()};
        }
      }
    });
  };
  if (what_ == What::kHeights) {
    for_columns([&](int, int, std::size_t i) {
      const std::complex<float> a = height(waves_[0][i], at), b = height(waves_[1][i], at);
      return std::complex<float>(a.real() - b.imag(), a.imag() + b.real());
    });
    transform(0);
    return;
  }
  for (int tile = 0; tile < kTiles; ++tile) {
    const double side = side_m(tile);
    for_columns([&](int x, int y, std::size_t i) {
      const std::complex<float> h = height(waves_[static_cast<std::size_t>(tile)][i], at);
      const auto kx = static_cast<float>(wave_number(x, n_, side)),
                 ky = static_cast<float>(wave_number(y, n_, side));
      // i kx h + i (i ky h).
      return std::complex<float>(-kx * h.imag() - ky * h.real(), kx * h.real() - ky * h.imag());
    });
    transform(2 * tile);
  }
}

}  // namespace freshet::synth::scene
