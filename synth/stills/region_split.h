// synth/stills/region_split.h — a large region cut into parts that move half by themselves.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/stills/region.h"

namespace freshet::synth::stills {

struct SplitOptions {
  int parts = 5;  // theirs; more lose the whole's look
  double calm_share =
      0.35;  // of the region, that counts as of low frequency: what has least detail in all stills
  double least_part = 0.05;  // of the region: no smaller part is cut off
  int side = 320;            // px, longer side of the copies that are looked at
};

/// The parts, named NAME.1, NAME.2, ...; the region itself where it cannot be cut.
/// small    the stills at work size, CV_8UC3.
/// Source   Lin et al. 2007, Sec. 4.1.1: the area of low frequency common to all stills, its skeleton
///          (thinned after
///          Zhang and Suen), a graph of its junctions weighed by the gradients along it, that graph's
///          minimum spanning
///          tree, and the longest path inside a part again and again. Ours: the region's border joins the
///          skeleton as a
///          ring without weight, so that a path can end there, as theirs do in their figure 5d.
std::vector<Region> split_region(const Region& region, const std::vector<cv::Mat>& small,
                                 const SplitOptions& options = {});

/// Length, px, of the border that two masks share.
double common_border(const cv::Mat& a, const cv::Mat& b);

/// In which order parts are best processed, and which processed neighbour each goes by.
struct ProcessingOrder {
  std::vector<int> order;      // of parts
  std::vector<int> reference;  // by part; -1: none, of the first
  double incompatibility = 0;  // px of border with processed neighbours that are not the reference
};
/// borders   n x n, symmetric. All orders are tried, at most 8 parts.
/// Source    Lin et al. 2007, Sec. 4.1.2.
ProcessingOrder best_processing_order(const std::vector<std::vector<double>>& borders);

}  // namespace freshet::synth::stills
