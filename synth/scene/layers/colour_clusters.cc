#include "synth/scene/layers/colour_clusters.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace freshet::synth::scene {
namespace {

// A run of the colours, and what decides whether it is split.
struct Run {
  std::size_t first = 0, end = 0;
  ColourCluster cluster;
  cv::Vec3f axis;
  float scatter = 0;   // weight x variance along the axis: what splitting can save
  float variance = 0;  // along the axis
};

// Sixteen steps bring the axis to within a per cent where the two largest eigenvalues differ by a third; where
// they differ less, either axis splits as well.
void find_axis(Run& run) {
  const cv::Matx33f& m = run.cluster.covariance;
  int longest = 0;
  for (int i = 1; i < 3; ++i)
    if (m(i, i) > m(longest, longest)) longest = i;
  cv::Vec3f axis(m(0, longest), m(1, longest), m(2, longest));
  run.variance = run.scatter = 0;
  if (m(longest, longest) <= 0) return;
  float length = 0;
  for (int step = 0; step < 16; ++step) {
    length = std::sqrt(axis.dot(axis));
    if (length <= 0) return;
    run.axis = axis * (1 / length);
    axis = m * run.axis;
  }
  run.variance = axis.dot(run.axis);
  run.scatter = run.variance * run.cluster.weight;
}

Run measured(std::span<const WeighedColour> colours, std::size_t first, std::size_t end) {
  Run run{.first = first, .end = end, .cluster = {}, .axis = {}};
  float weight = 0;
  cv::Vec3f sum(0, 0, 0);
  for (std::size_t i = first; i < end; ++i) {
    weight += colours[i].weight;
    sum += colours[i].colour * colours[i].weight;
  }
  const cv::Vec3f mean = sum * (1 / weight);
  std::array<float, 6> s{};
  for (std::size_t i = first; i < end; ++i) {
    const cv::Vec3f d = colours[i].colour - mean;
    const float w = colours[i].weight;
    s[0] += w * d[0] * d[0], s[1] += w * d[0] * d[1], s[2] += w * d[0] * d[2];
    s[3] += w * d[1] * d[1], s[4] += w * d[1] * d[2], s[5] += w * d[2] * d[2];
  }
  for (float& each : s) each /= weight;
  run.cluster = {.mean = mean,
                 .covariance = cv::Matx33f(s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]),
                 .weight = weight};
  find_axis(run);
  return run;
}

}  // namespace

void cluster_colours(std::span<WeighedColour> colours, const ClusterOptions& options,
                     std::vector<ColourCluster>& clusters) {
  std::array<Run, kMaxClusters> runs;
  std::size_t count = 1;
  runs[0] = measured(colours, 0, colours.size());
  const auto most = static_cast<std::size_t>(std::clamp(options.max_clusters, 1, kMaxClusters));
  while (count < most) {
    Run* worst = nullptr;
    for (std::size_t i = 0; i < count; ++i)
      if (runs[i].variance > options.min_split && (worst == nullptr || runs[i].scatter > worst->scatter))
        worst = &runs[i];
    if (worst == nullptr) break;
    const float middle = worst->axis.dot(worst->cluster.mean);
    const auto begin = colours.begin();
    const auto at = std::partition(
        begin + static_cast<std::ptrdiff_t>(worst->first), begin + static_cast<std::ptrdiff_t>(worst->end),
        [&](const WeighedColour& each) { return worst->axis.dot(each.colour) <= middle; });
    const auto split = static_cast<std::size_t>(at - begin);
    if (split == worst->first || split == worst->end) {  // rounding alone tells them apart
      worst->variance = 0;
      continue;
    }
    runs[count++] = measured(colours, split, worst->end);
    *worst = measured(colours, worst->first, split);
  }
  clusters.clear();
  const float least = options.least_sigma * options.least_sigma;
  for (std::size_t i = 0; i < count; ++i) {
    clusters.push_back(runs[i].cluster);
    for (int c = 0; c < 3; ++c) clusters.back().covariance(c, c) += least;
  }
}

}  // namespace freshet::synth::scene
