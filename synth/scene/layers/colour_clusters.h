// synth/scene/layers/colour_clusters.h — colours of a neighbourhood as a few Gaussians.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::scene {

struct WeighedColour {
  cv::Vec3f colour;  // 0..1
  float weight;      // above 0
};

struct ColourCluster {
  cv::Vec3f mean;
  cv::Matx33f covariance;  // symmetric, positive definite: the least variance is added on its diagonal
  float weight;            // of all of its colours together
};

struct ClusterOptions {
  int max_clusters = 4;
  float min_split = 0.0008f;  // variance along its longest axis (of 0..1) below which a cluster stays whole
  float least_sigma =
      0.012f;  // of a cluster in every direction: a camera's noise, and the rounding to 8 bits
};

constexpr int kMaxClusters = 8;

/// Splits colours into clusters, along the longest axis of the one that varies most, again and again.
///
/// colours   at least one; their order changes.
/// clusters  overwritten; nothing is allocated where there was room for kMaxClusters.
/// Cost      O(colours x clusters). The same for the same order of colours.
/// Source    Orchard and Bouman 1991, Sec. III, as Ruzon and Tomasi 2000 and Chuang et al. 2001 (Sec. 3) use it;
///           the axis is found by powers of the covariance, from the axis of largest variance.
void cluster_colours(std::span<WeighedColour> colours, const ClusterOptions& options,
                     std::vector<ColourCluster>& clusters);

}  // namespace freshet::synth::scene
