#include "synth/stills/region_split.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc.hpp>

#include "synth/stills/still_set.h"

namespace freshet::synth::stills {
namespace {

using Pixels = std::vector<cv::Point>;

constexpr int kLeastSkeleton = 8;  // px, of a piece of skeleton

/// Gradient magnitude summed over the stills, CV_32F.
cv::Mat summed_gradient(const std::vector<cv::Mat>& stills) {
  cv::Mat sum(stills[0].size(), CV_32F, cv::Scalar(0)), grey, dx, dy, magnitude;
  for (const cv::Mat& still : stills) {
    cv::cvtColor(still, grey, cv::COLOR_BGR2GRAY);
    cv::GaussianBlur(grey, grey, {}, 1);
    cv::Sobel(grey, dx, CV_32F, 1, 0);
    cv::Sobel(grey, dy, CV_32F, 0, 1);
    cv::magnitude(dx, dy, magnitude);
    sum += magnitude;
  }
  cv::GaussianBlur(sum, sum, {}, 2);
  return sum;
}

cv::Mat calm_area(const cv::Mat& gradient, const cv::Mat& mask, double share) {
  std::vector<float> values;
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask.at<std::uint8_t>(y, x) != 0) values.push_back(gradient.at<float>(y, x));
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return (gradient <= *at) & mask;
}

/// One px wide along the inner side of the mask.
cv::Mat rim_of(const cv::Mat& mask) {
  cv::Mat framed, eroded;
  cv::copyMakeBorder(mask, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::erode(framed, eroded, cv::Mat());
  return mask & ~eroded(cv::Rect(1, 1, mask.cols, mask.rows));
}

int degree(const cv::Mat& skeleton, const cv::Point& p) {
  int count = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const cv::Point q(p.x + dx, p.y + dy);
      if ((dx != 0 || dy != 0) && cv::Rect({}, skeleton.size()).contains(q))
        count += skeleton.at<std::uint8_t>(q) != 0;
    }
  return count;
}

/// The point of `targets` nearest to each pixel, by labels of a distance transform.
struct Nearest {
  cv::Mat distance, labels;
  std::vector<cv::Point> of_label;

  explicit Nearest(const cv::Mat& targets) {
    cv::distanceTransform(targets == 0, distance, labels, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL);
    of_label.resize(targets.total() + 1);
    for (int y = 0; y < targets.rows; ++y)
      for (int x = 0; x < targets.cols; ++x)
        if (targets.at<std::uint8_t>(y, x) != 0) of_label[labels.at<int>(y, x)] = {x, y};
  }
  cv::Point to(const cv::Point& p) const { return of_label[labels.at<int>(p)]; }
};

/// The skeleton in one piece, whose ends reach the rim.
cv::Mat connected_skeleton(const cv::Mat& calm, const cv::Mat& mask) {
  cv::Mat skeleton, labels;
  cv::ximgproc::thinning(calm, skeleton, cv::ximgproc::THINNING_ZHANGSUEN);
  const cv::Mat rim = rim_of(mask);
  if (cv::countNonZero(rim) == 0) return skeleton;
  const Nearest to_rim(rim);
  cv::Mat joined = skeleton.clone();
  for (int y = 0; y < skeleton.rows; ++y)
    for (int x = 0; x < skeleton.cols; ++x)
      if (skeleton.at<std::uint8_t>(y, x) != 0 && degree(skeleton, {x, y}) == 1 &&
          to_rim.distance.at<float>(y, x) < .12 * std::max(mask.cols, mask.rows))
        cv::line(joined, {x, y}, to_rim.to({x, y}), cv::Scalar(255));
  for (int round = 0; round < 64; ++round) {
    const int count = cv::connectedComponents(joined, labels, 8, CV_32S);
    if (count <= 2) break;
    // The smallest piece goes to its nearest neighbour, or away where it is next to nothing.
    std::vector<int> area(static_cast<std::size_t>(count), 0);
    for (int y = 0; y < labels.rows; ++y)
      for (int x = 0; x < labels.cols; ++x) ++area[labels.at<int>(y, x)];
    const int least = static_cast<int>(std::min_element(area.begin() + 1, area.end()) - area.begin());
    if (area[least] < kLeastSkeleton) {
      joined.setTo(0, labels == least);
      continue;
    }
    const Nearest others((joined != 0) & (labels != least));
    cv::Mat away(others.distance.size(), CV_32F, cv::Scalar(1e9));
    others.distance.copyTo(away, labels == least);
    cv::Point from;
    cv::minMaxLoc(away, nullptr, nullptr, &from);
    cv::line(joined, from, others.to(from), cv::Scalar(255));
  }
  cv::ximgproc::thinning(joined, joined, cv::ximgproc::THINNING_ZHANGSUEN);
  return joined & mask;
}

/// Junctions and ends of a skeleton, and the chains between them.
struct JunctionGraph {
  struct Edge {
    int a, b;
    double weight;
    Pixels pixels;
  };
  std::vector<Pixels> nodes;
  std::vector<char> on_border;
  std::vector<Edge> edges;
};

JunctionGraph junctions_of(const cv::Mat& skeleton, const cv::Mat& gradient, const cv::Mat& rim) {
  JunctionGraph graph;
  cv::Mat is_node(skeleton.size(), CV_8U, cv::Scalar(0)), id, near_rim;
  for (int y = 0; y < skeleton.rows; ++y)
    for (int x = 0; x < skeleton.cols; ++x)
      if (skeleton.at<std::uint8_t>(y, x) != 0 && degree(skeleton, {x, y}) != 2)
        is_node.at<std::uint8_t>(y, x) = 255;
  const int count = cv::connectedComponents(is_node, id, 8, CV_32S) - 1;
  graph.nodes.resize(static_cast<std::size_t>(count));
  graph.on_border.resize(static_cast<std::size_t>(count), 0);
  cv::dilate(rim, near_rim, cv::Mat(5, 5, CV_8U, cv::Scalar(1)));
  const cv::Rect whole({}, skeleton.size());
  for (int y = 0; y < skeleton.rows; ++y)
    for (int x = 0; x < skeleton.cols; ++x)
      if (const int node = id.at<int>(y, x) - 1; node >= 0) {
        graph.nodes[node].push_back({x, y});
        graph.on_border[node] |= near_rim.at<std::uint8_t>(y, x) != 0;
      }
  cv::Mat left = skeleton & ~is_node;
  for (int node = 0; node < count; ++node)
    for (const cv::Point& start : graph.nodes[node])
      for (int side = 0; side < 9; ++side) {
        cv::Point p(start.x + side % 3 - 1, start.y + side / 3 - 1);
        if (!whole.contains(p) || left.at<std::uint8_t>(p) == 0) continue;
        JunctionGraph::Edge edge{node, -1, 0, {}};
        for (bool going = true; going;) {
          left.at<std::uint8_t>(p) = 0;
          edge.pixels.push_back(p);
          edge.weight += gradient.at<float>(p);
          going = false;
          cv::Point next = p;
          for (int k = 0; k < 9; ++k) {
            const cv::Point q(p.x + k % 3 - 1, p.y + k / 3 - 1);
            if (!whole.contains(q)) continue;
            const int found = id.at<int>(q) - 1;
            if (found >= 0 && (found != node || edge.pixels.size() > 2)) edge.b = found;
            if (left.at<std::uint8_t>(q) != 0) next = q, going = true;
          }
          if (edge.b >= 0) going = false;
          p = next;
        }
        if (edge.b >= 0 && edge.b != edge.a) graph.edges.push_back(std::move(edge));
      }
  return graph;
}

/// Edges of the minimum spanning tree, by node (Kruskal).
std::vector<std::vector<int>> spanning_tree(const JunctionGraph& graph) {
  std::vector<int> order(graph.edges.size()), leader(graph.nodes.size());
  std::iota(order.begin(), order.end(), 0);
  std::iota(leader.begin(), leader.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return graph.edges[a].weight < graph.edges[b].weight; });
  const auto find = [&](int node) {
    while (leader[node] != node) node = leader[node] = leader[leader[node]];
    return node;
  };
  std::vector<std::vector<int>> tree(graph.nodes.size());
  for (const int each : order) {
    const JunctionGraph::Edge& edge = graph.edges[each];
    if (find(edge.a) == find(edge.b)) continue;
    leader[find(edge.a)] = find(edge.b);
    tree[edge.a].push_back(each);
    tree[edge.b].push_back(each);
  }
  return tree;
}

struct TreePath {
  std::vector<int> nodes;
  Pixels pixels;
};

/// All paths of the tree from one border to another that touch none between, longest first.
std::vector<TreePath> crossing_paths(const JunctionGraph& graph, const std::vector<std::vector<int>>& tree,
                                     const std::vector<char>& border) {
  std::vector<TreePath> found;
  const auto walk = [&](const auto& self, int node, int came_by, TreePath& path) -> void {
    path.nodes.push_back(node);
    const std::size_t before = path.pixels.size();
    path.pixels.insert(path.pixels.end(), graph.nodes[node].begin(), graph.nodes[node].end());
    if (path.nodes.size() > 1 && border[node]) {
      if (path.nodes.front() < node) found.push_back(path);
    } else {
      for (const int each : tree[node]) {
        if (each == came_by) continue;
        const JunctionGraph::Edge& edge = graph.edges[each];
        const std::size_t mark = path.pixels.size();
        path.pixels.insert(path.pixels.end(), edge.pixels.begin(), edge.pixels.end());
        self(self, edge.a == node ? edge.b : edge.a, each, path);
        path.pixels.resize(mark);
      }
    }
    path.pixels.resize(before);
    path.nodes.pop_back();
  };
  for (int node = 0; node < static_cast<int>(graph.nodes.size()); ++node) {
    TreePath path;
    if (border[node]) walk(walk, node, -1, path);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const TreePath& a, const TreePath& b) { return a.pixels.size() > b.pixels.size(); });
  return found;
}

/// Labels 1, 2, ... of what 4-connected areas the cuts leave of the mask; areas below `least` px count for
/// nothing.
int label_parts(const cv::Mat& mask, const cv::Mat& cuts, double least, cv::Mat& labels) {
  cv::Mat stats, centroids, raw;
  const int count = cv::connectedComponentsWithStats(mask & ~cuts, raw, stats, centroids, 4, CV_32S);
  labels = cv::Mat(mask.size(), CV_32S, cv::Scalar(0));
  int parts = 0;
  for (int label = 1; label < count; ++label)
    if (stats.at<int>(label, cv::CC_STAT_AREA) >= least) labels.setTo(++parts, raw == label);
  return parts;
}

/// What no part has goes to the nearest one.
void fill_labels(const cv::Mat& mask, int parts, cv::Mat& labels) {
  cv::Mat best(mask.size(), CV_32F, cv::Scalar(1e9)), away, out(mask.size(), CV_32S, cv::Scalar(0));
  for (int part = 1; part <= parts; ++part) {
    cv::distanceTransform(labels != part, away, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
    const cv::Mat nearer = (away < best) & mask;
    out.setTo(part, nearer);
    away.copyTo(best, nearer);
  }
  labels = out;
}

}  // namespace

std::vector<Region> split_region(const Region& region, const std::vector<cv::Mat>& small,
                                 const SplitOptions& options) {
  const std::vector<cv::Mat> stills = reduced(small, options.side);
  cv::Mat mask;
  cv::resize(region.mask, mask, stills[0].size(), 0, 0, cv::INTER_NEAREST);
  const double area = cv::countNonZero(mask);
  if (area < 400 || options.parts < 2) return {region};
  const cv::Mat gradient = summed_gradient(stills);
  const cv::Mat skeleton = connected_skeleton(calm_area(gradient, mask, options.calm_share), mask);
  const JunctionGraph graph = junctions_of(skeleton, gradient, rim_of(mask));
  const std::vector<std::vector<int>> tree = spanning_tree(graph);
  std::vector<char> border = graph.on_border;
  cv::Mat cuts(mask.size(), CV_8U, cv::Scalar(0)), labels;
  int parts = label_parts(mask, cuts, options.least_part * area, labels);
  for (bool cut = true; cut && parts < options.parts;) {
    cut = false;
    for (const TreePath& path : crossing_paths(graph, tree, border)) {
      cv::Mat with = cuts.clone(), found;
      for (const cv::Point& p : path.pixels) with.at<std::uint8_t>(p) = 255;
      // Ends stop a pixel or two short of the rim.
      for (const int end : {path.nodes.front(), path.nodes.back()})
        cv::circle(with, graph.nodes[end].front(), 3, cv::Scalar(255), cv::FILLED);
      if (label_parts(mask, with, options.least_part * area, found) <= parts) continue;
      parts = label_parts(mask, with, options.least_part * area, labels);
      cuts = with;
      for (const int node : path.nodes) border[node] = 1;
      cut = true;
      break;
    }
  }
  if (parts < 2) return {region};
  fill_labels(mask, parts, labels);
  std::vector<Region> out;
  for (int part = 1; part <= parts; ++part) {
    cv::Mat large;
    cv::resize(cv::Mat(labels == part), large, region.mask.size(), 0, 0, cv::INTER_LINEAR);
    out.push_back({.name = region.name + "." + std::to_string(part),
                   .kind = RegionKind::kIndependent,
                   .mask = (large >= 128) & region.mask,
                   .parent = region.name});
  }
  return out;
}

double common_border(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat grown;
  cv::dilate(b, grown, cv::Mat(5, 5, CV_8U, cv::Scalar(1)));
  return cv::countNonZero(grown & rim_of(a));
}

ProcessingOrder best_processing_order(const std::vector<std::vector<double>>& borders) {
  constexpr int kMost = 8;
  const int n = static_cast<int>(borders.size());
  ProcessingOrder best;
  best.incompatibility = std::numeric_limits<double>::infinity();
  std::vector<int> order(borders.size());
  std::iota(order.begin(), order.end(), 0);
  do {
    std::vector<int> reference(borders.size(), -1);
    double cost = 0;
    for (int k = 1; k < n; ++k) {
      double sum = 0, most = 0;
      for (int before = 0; before < k; ++before) {
        const double border = borders[order[k]][order[before]];
        sum += border;
        if (border > most) most = border, reference[order[k]] = order[before];
      }
      cost += sum - most;
      // A part without any processed neighbour goes by nobody: worse than any border.
      if (most == 0) cost += 1e6;
    }
    if (cost < best.incompatibility) best = {order, reference, cost};
  } while (n <= kMost && std::next_permutation(order.begin(), order.end()));
  return best;
}

}  // namespace freshet::synth::stills
