// query/mrf/mrf.h — a Markov random field of discrete labels with arbitrary pairwise tables.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "query/mrf/pair_cost.h"

namespace freshet::query {

/// A label per node: its place in the node's own list. Labels of different nodes are unrelated.
using Labels = std::vector<std::uint32_t>;

/// Nodes, each with its own number of labels, and edges, each with a full table of costs. All costs finite,
/// those of pairs >= 0. Memory: 2 bytes per label pair; 500 pieces, 955 edges and 100 labels take 19 MB.
struct Mrf {
  struct Edge {
    std::uint32_t p = 0, q = 0;  // p < q
    std::size_t table = 0;       // where its costs start in `pairwise`
  };
  std::vector<std::uint32_t> label_count;   // >= 1
  std::vector<std::size_t> first_unary{0};  // nodes + 1
  std::vector<float> unary;
  std::vector<Edge> edges;
  std::vector<PairCost> pairwise;  // label_count[p] rows of label_count[q] costs an edge

  std::size_t nodes() const { return label_count.size(); }
  std::span<const float> unary_of(std::size_t node) const {
    return {unary.data() + first_unary[node], label_count[node]};
  }
  const PairCost* table(const Edge& edge) const { return pairwise.data() + edge.table; }
  PairCost* table(const Edge& edge) { return pairwise.data() + edge.table; }

  /// costs   at least one. Returns the node's number.
  std::uint32_t add_node(std::span<const float> costs);
  /// p < q, both added before. The table starts as zeros. Returns the edge's number.
  std::size_t add_edge(std::uint32_t p, std::uint32_t q);
};

/// Eq. 4 of Okabe et al. 2011 (lambda is already inside the tables), summed in double precision.
double energy(const Mrf& mrf, const Labels& labels);

/// The label of minimum unary cost of each node, the smallest on ties.
Labels unary_minimum(const Mrf& mrf);

/// What a minimiser hands back.
struct Solution {
  Labels labels;
  double energy = 0;
  double lower_bound = -std::numeric_limits<double>::infinity();  // no labelling costs less; -inf: not known
  int iterations = 0;
  std::vector<float> margins = {};  // as below; empty: not known
  bool operator==(const Solution&) const = default;
};

/// Edges by node: the edges in which a node is `q` (towards earlier nodes) and those in which it is `p`.
struct Adjacency {
  std::vector<std::uint32_t> first_earlier, earlier;  // first_*: nodes + 1; the others hold edge numbers
  std::vector<std::uint32_t> first_later, later;
  explicit Adjacency(const Mrf& mrf);
  std::span<const std::uint32_t> to_earlier(std::size_t node) const {
    return std::span(earlier).subspan(first_earlier[node], first_earlier[node + 1] - first_earlier[node]);
  }
  std::span<const std::uint32_t> to_later(std::size_t node) const {
    return std::span(later).subspan(first_later[node], first_later[node + 1] - first_later[node]);
  }
};

/// costs[l] += cost of every edge of `node` when it takes label l and its neighbours keep theirs.
void add_neighbour_costs(const Mrf& mrf, const Adjacency& adjacency, std::size_t node, const Labels& labels,
                         std::span<float> costs);

/// How sure each label is: by how much the energy rises at least when a node takes another one and its neighbours keep
/// theirs. Negative where it falls; infinite for nodes of one label.
std::vector<float> margins(const Mrf& mrf, const Labels& labels);

}  // namespace freshet::query
