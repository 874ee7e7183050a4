// query/mrf/max_flow.h — the smallest cut of a small graph.
#pragma once

#include <cstdint>
#include <vector>

namespace freshet::query {

/// A graph with a source and a sink. Cleared and used again without allocation.
/// Source: Dinic 1970. For the few hundred nodes of an expansion move (0.1 ms) a specialised
/// Boykov-Kolmogorov would gain nothing that can be felt.
class MaxFlow {
 public:
  void clear(std::uint32_t nodes);
  /// Capacities >= 0.
  void add_edge(std::uint32_t from, std::uint32_t to, double capacity, double reverse_capacity);
  void add_terminal(std::uint32_t node, double from_source, double to_sink);
  /// Returns the value of the smallest cut.
  double solve();
  /// After solve(): true when the node lies on the source's side.
  bool on_source_side(std::uint32_t node) const { return level_[node] >= 0; }

 private:
  struct Arc {
    std::uint32_t to;
    std::int32_t next;  // of the same node, -1 ends
    double left;        // capacity that is left
  };
  bool reach();
  double push(std::uint32_t node, double limit);
  std::vector<Arc> arcs_;  // arc i and i ^ 1 are each other's reverse
  std::vector<std::int32_t> first_, current_, level_;
  std::vector<std::uint32_t> queue_;
  std::uint32_t source_ = 0, sink_ = 0;
};

}  // namespace freshet::query
