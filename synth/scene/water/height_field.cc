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
// Of a changing wind: a tile serves lengths L to an eighth of its own strongest's (at that its longest waves are still
// ten samples long), and smaller tiles have an eighth of the side. What lies between is shared out by power.
constexpr double kServes = 8;

/// The wave number of row or column i of n.
double wave_number(int i, int n, double side_m) { return kTurn * (i <= n / 2 ? i : i - n) / side_m; }

/// What a wind is to waves: Eq. 11's L, m, and where it blows, a unit.
struct WindOverWater {
  double length_m;
  cv::Point2d blows;
};
WindOverWater over_water(const Wind& wind, double roughness) {
  const double angle = wind.direction_deg * std::numbers::pi / 180;
  return {wind.speed_m_per_s * wind.speed_m_per_s / kGravity / roughness, {std::cos(angle), std::sin(angle)}};
}

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
    : n_(water.tile),
      what_(what),
      cycle_(cycle),
      weather_(wind, cycle),
      roughness_(water.roughness),
      against_(water.against) {
  const double fastest = weather_.strongest().speed_m_per_s, calmest = weather_.calmest_m_per_s();
  const double length = fastest * fastest / kGravity;
  const double side = water.tile_m.value_or(kUsualSide * std::max(length, 1e-3)) / water.roughness;
  side_m_ = {side, kSecondSide * side};
  if (!water.tile_m && calmest * calmest * kServes < fastest * fastest)
    side_m_.insert(side_m_.end(), {side / kServes, kSecondSide * side / kServes});
  waves_.resize(side_m_.size());
  deviation_m_ = water.amplitude_or_usual() * kSeaHeight * length / water.roughness;
  phasor_.resize(static_cast<std::size_t>(cycle.frames));
  for (int t = 0; t < cycle.frames; ++t)
    phasor_[static_cast<std::size_t>(t)] = std::polar(1.0, kTurn * t / cycle.frames);
  if (weather_.changes()) {
    still_.resize(waves_.size());
    growth_.resize(waves_.size());
    std::array<double, kTiles> scale{};
    for (int tile = 0; tile < tiles(); ++tile) fill_still(tile, water, seed, scale);
  } else {
    for (int tile = 0; tile < tiles(); ++tile) fill(tile, water, wind, seed);
  }
  spectrum_.create(n_, n_, CV_32FC2);
  half_.create(n_, n_, CV_32FC2);
  whole_.create(n_, n_, CV_32FC2);
  planes_.resize(static_cast<std::size_t>(planes()));
  for (cv::Mat& plane : planes_) plane.create(n_, n_, CV_32F);
}

std::uint32_t HeightField::harmonic(double wave_number) const {
  const double omega = std::sqrt(kGravity * wave_number);
  const auto turns = static_cast<std::uint32_t>(std::max(1.0, std::round(omega * cycle_.seconds() / kTurn)));
  return turns % static_cast<std::uint32_t>(cycle_.frames);
}

void HeightField::fill(int tile, const WaterMotion& water, const Wind& wind, std::uint64_t seed) {
  const double side = side_m_[static_cast<std::size_t>(tile)];
  const auto [length, blows] = over_water(wind, water.roughness);
  const Random random(seed, 1000 + static_cast<std::uint64_t>(tile));
  std::vector<Wave>& waves = waves_[static_cast<std::size_t>(tile)];
  waves.assign(static_cast<std::size_t>(n_) * static_cast<std::size_t>(n_), {});
  if (!(length > 0)) return;
  double power = 0;
  for (int x = 0; x < n_; ++x) {
    for (int y = 0; y < n_; ++y) {
      if (!holds_wave(x, y)) continue;
      const cv::Point2d k(wave_number(x, n_, side), wave_number(y, n_, side));
      // exp(i (k q + omega t)) goes against k.
      const double into_wind = k.dot(blows) > 0 ? water.against : 1;
      const double square = phillips(k, length, blows) * into_wind * into_wind;
      power += 2 * square;
      Wave& wave = waves[place(x, y)];
      wave.forth = complex_gaussian(random, place(x, y)) * std::sqrt(square);
      wave.harmonic = harmonic(std::hypot(k.x, k.y));
    }
  }
  // Of the two tiles each has half of the variance.
  const double scale = power > 0 ? deviation_m_ / std::sqrt(2 * power) : 0;
  for (Wave& wave : waves) wave.forth *= static_cast<float>(scale);
  for (int x = 0; x < n_; ++x)
    for (int y = 0; y < n_; ++y)
      waves[place(x, y)].back = std::conj(waves[place((n_ - x) % n_, (n_ - y) % n_)].forth);
}

void HeightField::fill_still(int tile, const WaterMotion& water, std::uint64_t seed,
                             std::array<double, kTiles>& scale) {
  const auto at = static_cast<std::size_t>(tile);
  const double side = side_m_[at];
  const auto [length, blows] = over_water(weather_.strongest(), water.roughness);
  const Random random(seed, 1000 + static_cast<std::uint64_t>(tile));
  const bool first = tile < kTiles;
  const bool shares = tiles() > kTiles;
  const auto samples = static_cast<std::size_t>(n_) * static_cast<std::size_t>(n_);
  std::vector<Wave>& waves = still_[at];
  waves.assign(samples, {});
  growth_[at].assign(samples, {});
  waves_[at].assign(samples, {});
  double power = 0;
  for (int x = 0; x < n_; ++x) {
    for (int y = 0; y < n_; ++y) {
      if (!holds_wave(x, y)) continue;
      const cv::Point2d k(wave_number(x, n_, side), wave_number(y, n_, side));
      const double size = std::hypot(k.x, k.y), into_wind = k.dot(blows) > 0 ? water.against : 1;
      power += 2 * phillips(k, length, blows) * into_wind * into_wind;
      // Of the first tiles' samples four and eight are the wavelengths between which the smaller ones take over.
      const double samples_long = kTurn / size * n_ / side / (first ? 1 : kServes);
      const double u = std::clamp(std::log2(8 / samples_long), 0.0, 1.0), small = u * u * (3 - 2 * u);
      const double share = shares ? std::sqrt(first ? 1 - small : small) : 1;
      Wave& wave = waves[place(x, y)];
      wave.forth = complex_gaussian(random, place(x, y)) * (share / (size * size));
      wave.harmonic = harmonic(size);
      growth_[at][place(x, y)] = {.inverse_square = static_cast<float>(1 / (size * size)),
                                  .x = static_cast<float>(k.x / size),
                                  .y = static_cast<float>(k.y / size)};
    }
  }
  // One density of power for all: a wave stands for as much of it as its tile's wave numbers lie apart.
  double& strength = scale[at % kTiles];
  if (first) strength = power > 0 ? deviation_m_ / std::sqrt(2 * power) : 0;
  for (Wave& wave : waves) wave.forth *= static_cast<float>(strength * (first ? 1 : kServes));
  for (int x = 0; x < n_; ++x)
    for (int y = 0; y < n_; ++y)
      waves[place(x, y)].back = std::conj(waves[place((n_ - x) % n_, (n_ - y) % n_)].forth);
}

void HeightField::grow(const Wind& wind) {
  if (wind.speed_m_per_s == grown_speed_ && wind.direction_deg == grown_direction_) return;
  grown_speed_ = wind.speed_m_per_s, grown_direction_ = wind.direction_deg;
  const auto [length, blows] = over_water(wind, roughness_);
  // In no wind 1 / L^2 is what leaves no wave, and finite.
  const auto falls = static_cast<float>(0.5 / std::max(length * length, 1e-30)),
             right = static_cast<float>(blows.x), away = static_cast<float>(blows.y),
             against = static_cast<float>(against_);
  using oneapi::tbb::blocked_range;
  for (std::size_t tile = 0; tile < waves_.size(); ++tile) {
    const std::vector<Wave>& from = still_[tile];
    const std::vector<Growth>& growth = growth_[tile];
    std::vector<Wave>& to = waves_[tile];
    oneapi::tbb::parallel_for(
        blocked_range<std::size_t>(0, from.size(), 4096), [&](const blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const float along = growth[i].x * right + growth[i].y * away;
            const float gain = std::exp(-growth[i].inverse_square * falls) * std::abs(along);
            to[i].forth = from[i].forth * (gain * (along > 0 ? against : 1));
            to[i].back = from[i].back * (gain * (along < 0 ? against : 1));
            to[i].harmonic = from[i].harmonic;
          }
        });
  }
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

void HeightField::go_to(int frame) { go_to(frame, cycle_.place(frame) / cycle_.fps); }

void HeightField::go_to(int frame, double seconds_of_weather) {
  if (weather_.changes()) grow(weather_.at(seconds_of_weather));
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
    for (int tile = 0; tile < tiles(); tile += kTiles) {
      const std::vector<Wave>&one = waves_[static_cast<std::size_t>(tile)],
            &other = waves_[static_cast<std::size_t>(tile) + 1];
      for_columns([&](int, int, std::size_t i) {
        const std::complex<float> a = height(one[i], at), b = height(other[i], at);
        return std::complex<float>(a.real() - b.imag(), a.imag() + b.real());
      });
      transform(tile);
    }
    return;
  }
  for (int tile = 0; tile < tiles(); ++tile) {
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
