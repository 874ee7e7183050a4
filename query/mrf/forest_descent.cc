#include "query/mrf/forest_descent.h"

#include <algorithm>
#include <numeric>

#include "platform/random.h"
#include "query/mrf/min_sum.h"

namespace freshet::query {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

class Forests {
 public:
  explicit Forests(const Mrf& mrf)
      : mrf_(mrf), adjacency_(mrf), component_(mrf.nodes()), parent_edge_(mrf.nodes()) {
    const auto labels =
        mrf.label_count.empty() ? 0u : *std::max_element(mrf.label_count.begin(), mrf.label_count.end());
    message_.resize(labels);
    belief_.resize(mrf.unary.size());
  }

  /// Chooses the forest's nodes: each in turn, unless it would close a cycle.
  void grow(std::span<const std::uint32_t> offered) {
    std::fill(component_.begin(), component_.end(), kNone);
    for (const std::uint32_t node : offered) {
      roots_.clear();
      for_each_neighbour(node, [&](std::uint32_t, std::uint32_t other) {
        if (component_[other] != kNone) roots_.push_back(find(other));
      });
      std::sort(roots_.begin(), roots_.end());
      if (std::adjacent_find(roots_.begin(), roots_.end()) != roots_.end()) continue;
      component_[node] = node;
      for (const std::uint32_t root : roots_) component_[root] = node;
    }
    // Breadth first from each tree's first node: parents come before their children.
    order_.clear();
    std::fill(parent_edge_.begin(), parent_edge_.end(), kNone);
    std::vector<bool> seen(mrf_.nodes());
    for (const std::uint32_t root : offered) {
      if (component_[root] == kNone || seen[root]) continue;
      seen[root] = true;
      order_.push_back(root);
      for (std::size_t at = order_.size() - 1; at < order_.size(); ++at) {
        for_each_neighbour(order_[at], [&](std::uint32_t e, std::uint32_t other) {
          if (component_[other] == kNone || seen[other]) return;
          seen[other] = true;
          parent_edge_[other] = e;
          order_.push_back(other);
        });
      }
    }
  }

  bool contains(std::uint32_t node) const { return component_[node] != kNone; }

  /// labels of the forest's nodes become the best that there are, given the others.
  void minimize(Labels& labels) {
    for (const std::uint32_t node : order_) {
      const auto unary = mrf_.unary_of(node);
      std::copy(unary.begin(), unary.end(), belief(node).begin());
      for_each_neighbour(node, [&](std::uint32_t e, std::uint32_t other) {
        if (!contains(other)) add_edge_costs(e, node, labels[other]);
      });
    }
    for (auto at = order_.rbegin(); at != order_.rend(); ++at) {
      if (parent_edge_[*at] == kNone) continue;
      const Mrf::Edge& edge = mrf_.edges[parent_edge_[*at]];
      const std::uint32_t rows = mrf_.label_count[edge.p], columns = mrf_.label_count[edge.q];
      const bool upward = edge.q == *at;  // the child is q
      (upward ? min_over_columns : min_over_rows)(mrf_.table(edge), rows, columns, belief(*at).data(),
                                                  message_.data());
      const auto to = belief(upward ? edge.p : edge.q);
      for (std::size_t l = 0; l < to.size(); ++l) to[l] += message_[l];
    }
    for (const std::uint32_t node : order_) {
      if (const std::uint32_t e = parent_edge_[node]; e != kNone) {
        const Mrf::Edge& edge = mrf_.edges[e];
        add_edge_costs(e, node, labels[edge.p == node ? edge.q : edge.p]);
      }
      const auto costs = belief(node);
      labels[node] = static_cast<std::uint32_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
    }
  }

 private:
  std::uint32_t find(std::uint32_t node) {
    while (component_[node] != node) node = component_[node] = component_[component_[node]];
    return node;
  }

  template <class Visit>
  void for_each_neighbour(std::uint32_t node, Visit&& visit) const {
    for (const std::uint32_t e : adjacency_.to_earlier(node)) visit(e, mrf_.edges[e].p);
    for (const std::uint32_t e : adjacency_.to_later(node)) visit(e, mrf_.edges[e].q);
  }

  std::span<float> belief(std::size_t node) {
    return {belief_.data() + mrf_.first_unary[node], mrf_.label_count[node]};
  }

  void add_edge_costs(std::uint32_t e, std::uint32_t node, std::uint32_t label_of_other) {
    const Mrf::Edge& edge = mrf_.edges[e];
    const auto costs = belief(node);
    const std::size_t columns = mrf_.label_count[edge.q];
    const bool is_q = edge.q == node;
    const PairCost* from = mrf_.table(edge) + (is_q ? label_of_other * columns : label_of_other);
    const std::size_t step = is_q ? 1 : columns;
    for (std::size_t l = 0; l < costs.size(); ++l) costs[l] += from[l * step];
  }

  const Mrf& mrf_;
  Adjacency adjacency_;
  std::vector<std::uint32_t> component_;  // a union-find forest over the chosen nodes; kNone: not chosen
  std::vector<std::uint32_t> parent_edge_, order_, roots_;
  std::vector<float> belief_, message_;
};

}  // namespace

void forest_descent(const Mrf& mrf, Solution& solution, const ForestDescentOptions& options) {
  if (mrf.nodes() == 0) return;
  Forests forests(mrf);
  std::vector<std::uint32_t> offered(mrf.nodes());
  std::vector<std::uint64_t> rank(mrf.nodes());
  std::vector<bool> covered(mrf.nodes());
  std::uint64_t forest = 0;
  for (int cycle = 0; cycle < options.max_cycles; ++cycle) {
    bool gained = false;
    std::fill(covered.begin(), covered.end(), false);
    std::size_t left = mrf.nodes();
    while (left > 0) {
      // Nodes that no forest of this cycle has held come first. The first forests grow in node order and
      // back, which on a grid gives combs of long rows; later ones in random order.
      for (std::size_t node = 0; node < mrf.nodes(); ++node) {
        std::uint64_t key = scramble(options.seed + forest * mrf.nodes() + node) >> 1;
        if (forest == 0) key = node;
        if (forest == 1) key = mrf.nodes() - node;
        rank[node] = key | (covered[node] ? std::uint64_t{1} << 63 : 0);
      }
      std::iota(offered.begin(), offered.end(), 0u);
      std::sort(offered.begin(), offered.end(), [&](std::uint32_t a, std::uint32_t b) {
        return rank[a] != rank[b] ? rank[a] < rank[b] : a < b;
      });
      ++forest;
      forests.grow(offered);
      for (std::uint32_t node = 0; node < mrf.nodes(); ++node) {
        if (!forests.contains(node) || covered[node]) continue;
        covered[node] = true;
        --left;
      }
      Labels labels = solution.labels;
      forests.minimize(labels);
      if (const double found = energy(mrf, labels); found < solution.energy) {
        solution.energy = found;
        solution.labels = std::move(labels);
        gained = true;
      }
    }
    if (!gained) return;
  }
}

}  // namespace freshet::query
