// synth/scene/water/height_field.h — two tiles of waves that go on for ever (Chuang et al. 2005, Eq. 11-14).
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/cycle.h"
#include "synth/scene/scene.h"
#include "synth/scene/wind/weather.h"

namespace freshet::synth::scene {

/// Waves of one wind on a plane, as the sum of two tiles of unequal side: it repeats where both do, that is nowhere
/// within sight.
///
/// Spectrum   Phillips' (Eq. 11) of a sea under this wind, all lengths divided by `roughness`; waves against the wind
///            `against` times as high. The factor that the paper leaves open is such that amplitude 1 gives the
///            heights of a fully developed sea, of standard deviation .0525 v^2 / g (Pierson and Moskowitz), divided
///            by the roughness too: slopes stay.
/// Time       omega^2 = g k (Eq. 13), k the wave number on the water, after roughness; then the nearest
///            harmonic of the cycle, and the first for waves slower than that.
/// Weather    Where the wind changes, each wave's height follows Eq. 11 under the wind of the moment; its phase goes
///            on. A rising wind adds longer waves to the ripples, which stay; with a turning one waves of the new
///            direction grow while those of the old die away. The factor is the strongest wind's. Where that one's
///            tiles would be too coarse for the calmest's waves, two smaller tiles carry what is short in all winds.
/// Cost       a complex transform of N x N a frame (two for slopes): some 2 ms for N = 256 on two cores; twice that
///            with the smaller tiles.
class HeightField {
 public:
  static constexpr int kTiles = 2, kMaxTiles = 2 * kTiles;
  /// What a frame holds.
  enum class What { kHeights, kSlopes };

  /// seed   of its own; the wind gives speed and direction. v = 0: flat.
  HeightField(const WaterMotion& water, const Wind& wind, const Cycle& cycle, std::uint64_t seed,
              What what = What::kHeights);

  /// Computes the frame.
  void go_to(int frame);
  /// The same as high as the waves of another moment of the weather are.
  void go_to(int frame, double seconds_of_weather);

  /// Planes of go_to()'s frame, N x N, CV_32F, periodic; x to the right, y away from the viewer. Heights: one a tile,
  /// m. Slopes: two a tile, to the right and away.
  int tiles() const { return static_cast<int>(waves_.size()); }
  int planes() const { return what_ == What::kHeights ? tiles() : 2 * tiles(); }
  int tile_of(int plane) const { return what_ == What::kHeights ? plane : plane / 2; }
  const cv::Mat& plane(int i) const { return planes_[static_cast<std::size_t>(i)]; }
  int samples() const { return n_; }
  /// m, of a tile's side on the water.
  double side_m(int tile) const { return side_m_[static_cast<std::size_t>(tile)]; }
  /// Standard deviation that the spectrum has, m; of heights, in the strongest wind.
  double deviation_m() const { return deviation_m_; }

 private:
  /// H0(s) and conj(H0(-s)) of Eq. 14, and the harmonic of omega.
  struct Wave {
    std::complex<float> forth, back;
    std::uint32_t harmonic = 0;
  };
  /// What a wave has of its own, of whose square Eq. 11's exponential and cosine are the wind's.
  struct Growth {
    float inverse_square = 0;  // (1 / k)^2, m^2
    float x = 0, y = 0;        // unit, along k
  };
  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(n_) + static_cast<std::size_t>(y);
  }
  /// At half the sampling rate a wave and its opposite are one: it could not move. The mean is none.
  bool holds_wave(int x, int y) const { return x != n_ / 2 && y != n_ / 2 && (x != 0 || y != 0); }
  /// wave_number   1/m.
  std::uint32_t harmonic(double wave_number) const;
  void fill(int tile, const WaterMotion& water, const Wind& wind, std::uint64_t seed);
  /// Waves without a wind; scale   of the strongest wind's in the first tiles, computed for those.
  void fill_still(int tile, const WaterMotion& water, std::uint64_t seed, std::array<double, kTiles>& scale);
  /// The waves under this wind.
  void grow(const Wind& wind);
  std::complex<float> height(const Wave& wave, std::uint32_t frame) const;
  void transform(int to_plane);

  int n_;
  What what_;
  Cycle cycle_;
  Weather weather_;
  double roughness_, against_;
  double deviation_m_ = 0;
  std::vector<double> side_m_;
  std::vector<std::vector<Wave>> waves_;  // of a tile: [x][y], transposed: the transform turns it
  // Where the wind changes: waves without it, and the wind that the others are under.
  std::vector<std::vector<Wave>> still_;
  std::vector<std::vector<Growth>> growth_;
  double grown_speed_ = -1, grown_direction_ = 0;
  std::vector<std::complex<float>> phasor_;  // exp(2 pi i t / T) at every frame
  cv::Mat spectrum_, half_, turned_, whole_;
  std::vector<cv::Mat> planes_;
};

}  // namespace freshet::synth::scene
