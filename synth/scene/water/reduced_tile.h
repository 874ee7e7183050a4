// synth/scene/water/reduced_tile.h — a periodic tile at all resolutions, to each side apart from the other.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::scene {

/// Towards the horizon a pixel covers much more water away from the viewer than to the side: a pyramid of squares would
/// either glitter or lose what can still be seen. Here x and y are halved apart (a rip map), each time by the binomial
/// filter 1 3 3 1.
class ReducedTile {
 public:
  /// n   samples a side, a power of 2.
  explicit ReducedTile(int n);

  int levels() const { return levels_; }  // 0..levels() - 1, the last one sample wide
  /// Says that level (x, y) will be asked; before the first set().
  void need(int x, int y);
  /// Computes what is needed of this tile, N x N, CV_32F; kept by reference until the next.
  void set(const cv::Mat& tile);
  /// Sample i stands at (i + .5) 2^level - .5 of the tile.
  const cv::Mat& level(int x, int y) const { return of_[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y * levels_ + x); }

  int levels_;
  std::vector<cv::Mat> of_;
  std::vector<char> needed_;
};

/// Periodic rows at a resolution of their own, joined: `n` values at the tile's full resolution along x, at the
/// place `y` (samples of the tile, any value), for a pixel that covers covers_x by covers_y samples. Waves shorter than
/// some four pixels are gone, and the change from level to level is gradual.
/// scratch   2 n floats.
void sample_row(const ReducedTile& tile, double y, double covers_x, double covers_y, int n, float* out,
                float* scratch);
/// The levels that this will ask for.
void need_row(ReducedTile& tile, double covers_x, double covers_y);

}  // namespace freshet::synth::scene
