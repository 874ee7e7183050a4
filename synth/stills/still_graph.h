// synth/stills/still_graph.h — which stills are alike: a graph with a distance between any two.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::stills {

/// A symmetric table, or one of hops, n x n row by row.
template <class T>
struct Square {
  int n = 0;
  std::vector<T> values;

  explicit Square(int side = 0, T value = {})
      : n(side), values(static_cast<std::size_t>(side) * side, value) {}
  T& operator()(int i, int j) { return values[static_cast<std::size_t>(i) * n + j]; }
  const T& operator()(int i, int j) const { return values[static_cast<std::size_t>(i) * n + j]; }
};

/// Root mean square difference between stills, of 255, all channels, where the mask is.
///
/// stills   CV_8UC3 of one size. mask   CV_8U: above 0 counts; empty: all counts.
/// Before it the stills are blurred within the mask, by .3, 1, 2, 3, 6 and 10 % of its longer side: fine
/// detail moves on by more than its own size between two stills, and broad blurs tell no small thing apart.
/// The six distances, each beside its own mean, are added, and nine tenths of the least taken off by squares;
/// the result has the level of their means.
/// sigma    px; where above 0 this blur and no other.
/// Cost     O(stills^2 pixels).
Square<double> still_distances(std::span<const cv::Mat> stills, const cv::Mat& mask, double sigma = 0);

struct GraphOptions {
  /// A step weighs its distance to this power. Lin et al. 2007, Sec. 3.1 take the L2 norm itself (1). That
  /// is a metric: no way over other stills is ever shorter than the direct step, Floyd's algorithm changes
  /// nothing while that step is there, and paths have two stills (in 26 of 28 sets of frames from real
  /// clips). From 2 on a way of small steps is shorter than one leap, the more the higher the power
  /// (power-weighted shortest paths follow where the stills lie densely): docs/stills.md.
  double power = 8;
  /// Steps above so many times the mean weight are no edges (theirs: 2).
  double cut_above = 2;
  bool floyd = true;                           // false: edges' own weights alone, for measuring
  std::vector<std::pair<int, int>> cut = {};   // edges that a person takes out
  std::vector<std::pair<int, int>> join = {};  // edges that a person puts in, as light as the lightest
};

struct StillGraph {
  Square<double> weight;       // of the direct step, 0 on the diagonal
  Square<double> distance;     // over edges; infinity between parts of the graph
  Square<int> next;            // the first still on the shortest way; -1: there is none
  Square<unsigned char> edge;  // 1: the step is one
  std::vector<int> part = {};  // of each still, 0 is the largest
  double mean_edge_weight = 0;

  int count() const { return weight.n; }
  int parts() const;
  std::vector<int> way(int from, int to) const;  // both ends included; empty: there is none
};

/// rms   as still_distances gives them.
/// Source   Lin et al. 2007, Sec. 3.1. Cost   O(n^3).
StillGraph make_graph(const Square<double>& rms, const GraphOptions& options = {});

}  // namespace freshet::synth::stills
