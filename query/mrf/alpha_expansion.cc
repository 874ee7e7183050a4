#include "query/mrf/alpha_expansion.h"

#include <algorithm>

#include "query/mrf/max_flow.h"

namespace freshet::query {
namespace {

// The binary problem of one move: 0 keeps (source side), 1 takes the rank (sink side). keep and take collect
// the unary costs of the two, edges the cost of keeping p while q takes (Kolmogorov and Zabih 2004).
class Move {
 public:
  void expand(const Mrf& mrf, std::uint32_t rank, Labels& labels) {
    const auto nodes = static_cast<std::uint32_t>(mrf.nodes());
    keep_.assign(nodes, 0);
    take_.assign(nodes, 0);
    flow_.clear(nodes);
    const auto moves = [&](std::uint32_t node) {
      return rank < mrf.label_count[node] && labels[node] != rank;
    };
    for (std::uint32_t node = 0; node < nodes; ++node) {
      keep_[node] += mrf.unary_of(node)[labels[node]];
      if (moves(node)) take_[node] += mrf.unary_of(node)[rank];
    }
    for (const Mrf::Edge& edge : mrf.edges) add_term(mrf, edge, rank, labels, moves(edge.p), moves(edge.q));
    for (std::uint32_t node = 0; node < nodes; ++node) {
      if (!moves(node)) continue;
      // A cut through the source's arc puts the node on the sink's side, where it takes the rank.
      const double minimum = std::min(keep_[node], take_[node]);
      flow_.add_terminal(node, take_[node] - minimum, keep_[node] - minimum);
    }
    flow_.solve();
    for (std::uint32_t node = 0; node < nodes; ++node) {
      if (moves(node) && !flow_.on_source_side(node)) labels[node] = rank;
    }
  }

 private:
  void add_term(const Mrf& mrf, const Mrf::Edge& edge, std::uint32_t rank, const Labels& labels, bool p_moves,
                bool q_moves) {
    const PairCost* table = mrf.table(edge);
    const std::size_t columns = mrf.label_count[edge.q];
    const std::size_t p = labels[edge.p], q = labels[edge.q];
    if (!p_moves && !q_moves) return;
    if (!q_moves) {
      keep_[edge.p] += table[p * columns + q];
      take_[edge.p] += table[rank * columns + q];
      return;
    }
    if (!p_moves) {
      keep_[edge.q] += table[p * columns + q];
      take_[edge.q] += table[p * columns + rank];
      return;
    }
    double both_keep = table[p * columns + q];
    const double q_takes = table[p * columns + rank], p_takes = table[rank * columns + q];
    const double both_take = table[rank * columns + rank];
    both_keep = std::min(both_keep, q_takes + p_takes - both_take);  // truncation
    keep_[edge.p] += both_keep;
    take_[edge.p] += p_takes;
    take_[edge.q] += both_take - p_takes;
    flow_.add_edge(edge.p, edge.q, std::max(0.0, q_takes + p_takes - both_keep - both_take), 0);
  }

  MaxFlow flow_;
  std::vector<double> keep_, take_;
};

}  // namespace

Solution alpha_expansion(const Mrf& mrf, const AlphaExpansionOptions& options) {
  Solution solution;
  solution.labels = unary_minimum(mrf);
  solution.energy = energy(mrf, solution.labels);
  if (mrf.nodes() == 0) return solution;
  const std::uint32_t ranks = *std::max_element(mrf.label_count.begin(), mrf.label_count.end());
  Move move;
  Labels labels;
  bool gained = true;
  while (gained && solution.iterations < options.max_cycles) {
    gained = false;
    ++solution.iterations;
    for (std::uint32_t rank = 0; rank < ranks; ++rank) {
      labels = solution.labels;
      move.expand(mrf, rank, labels);
      const double found = energy(mrf, labels);
      if (found >= solution.energy) continue;
      solution.energy = found;
      std::swap(solution.labels, labels);
      gained = true;
    }
  }
  return solution;
}

}  // namespace freshet::query
