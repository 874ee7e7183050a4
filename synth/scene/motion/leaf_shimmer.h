// synth/scene/motion/leaf_shimmer.h — the leaves' own small motion inside a tree.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/cycle.h"
#include "synth/scene/scene.h"
#include "synth/scene/wind/gusts.h"

namespace freshet::synth::scene {

/// A turbulent field (Chuang et al. 2005 name it as future work, Sec. 5): at the nodes of a lattice
/// the wind's own series, heard through a leaf of some hertz, and cubic between them. Nothing when shimmer_px is 0.
/// Where the wind changes, they are those of the strongest, each moment as much less as its wind is slower.
class LeafShimmer {
 public:
  LeafShimmer(const TreeMotion& tree, const Gusts& gusts, const Cycle& cycle, std::uint64_t seed,
              const cv::Rect& region);
  void go_to(int place_in_cycle);
  float reach() const { return reach_; }
  /// Adds its displacement, px.
  void add_row(int x, int y, int n, float* dx, float* dy) const;

 private:
  static constexpr int kSeries = 24;  // nodes share these, each with a delay of its own

  double size_px_ = 0;
  int frames_ = 1;
  cv::Rect region_;
  std::vector<float> series_[kSeries];
  std::vector<float> share_;  // of the strongest wind, at every frame of the cycle; empty: all
  cv::Mat nodes_;             // CV_32FC2, at the lattice, one node before the region
  std::uint64_t seed_ = 0;
  float reach_ = 0;
};

}  // namespace freshet::synth::scene
