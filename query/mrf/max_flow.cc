#include "query/mrf/max_flow.h"

#include <algorithm>
#include <limits>

namespace freshet::query {

void MaxFlow::clear(std::uint32_t nodes) {
  arcs_.clear();
  source_ = nodes;
  sink_ = nodes + 1;
  first_.assign(nodes + 2, -1);
  level_.assign(nodes + 2, -1);
}

void MaxFlow::add_edge(std::uint32_t from, std::uint32_t to, double capacity, double reverse_capacity) {
  arcs_.push_back({to, first_[from], capacity});
  first_[from] = static_cast<std::int32_t>(arcs_.size() - 1);
  arcs_.push_back({from, first_[to], reverse_capacity});
  first_[to] = static_cast<std::int32_t>(arcs_.size() - 1);
}

void MaxFlow::add_terminal(std::uint32_t node, double from_source, double to_sink) {
  if (from_source > 0) add_edge(source_, node, from_source, 0);
  if (to_sink > 0) add_edge(node, sink_, to_sink, 0);
}

bool MaxFlow::reach() {
  std::fill(level_.begin(), level_.end(), -1);
  queue_.assign(1, source_);
  level_[source_] = 0;
  for (std::size_t at = 0; at < queue_.size(); ++at) {
    for (std::int32_t a = first_[queue_[at]]; a >= 0; a = arcs_[a].next) {
      if (arcs_[a].left <= 0 || level_[arcs_[a].to] >= 0) continue;
      level_[arcs_[a].to] = level_[queue_[at]] + 1;
      queue_.push_back(arcs_[a].to);
    }
  }
  return level_[sink_] >= 0;
}

// Depth is at most the sink's level, a few dozen on pictures of thousands of pieces.
double MaxFlow::push(std::uint32_t node, double limit) {
  if (node == sink_) return limit;
  double pushed = 0;
  for (std::int32_t& a = current_[node]; a >= 0; a = arcs_[a].next) {
    Arc& arc = arcs_[a];
    if (arc.left <= 0 || level_[arc.to] != level_[node] + 1) continue;
    const double flow = push(arc.to, std::min(limit - pushed, arc.left));
    if (flow <= 0) continue;
    arc.left -= flow;  // the tightest arc becomes exactly zero
    arcs_[a ^ 1].left += flow;
    pushed += flow;
    if (pushed >= limit) return pushed;
  }
  return pushed;
}

double MaxFlow::solve() {
  double total = 0;
  while (reach()) {
    current_ = first_;
    const double flow = push(source_, std::numeric_limits<double>::infinity());
    if (flow <= 0) break;
    total += flow;
  }
  return total;
}

}  // namespace freshet::query
