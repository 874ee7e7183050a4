#include "bench/labelling/fusion_moves.h"

#include <algorithm>

namespace freshet::bench {

using query::Labels;
using query::Mrf;

// Node i stands for "i takes" and node n + i for "i keeps": each is on the sink's side when it is true. A
// term goes in twice, once by the nodes and once by their negations, so that a cut which gives both the same
// answer is one of the true problem.
std::span<const Fusion::Choice> Fusion::choose(const Labels& labels, const Labels& proposal) {
  const auto nodes = static_cast<std::uint32_t>(mrf_.nodes());
  keep_.resize(nodes);
  take_.resize(nodes);
  choices_.assign(nodes, Choice::kOpen);
  flow_.clear(2 * nodes);
  for (std::uint32_t node = 0; node < nodes; ++node) {
    keep_[node] = mrf_.unary_of(node)[labels[node]];
    take_[node] = mrf_.unary_of(node)[proposal[node]];
  }
  for (const Mrf::Edge& edge : mrf_.edges) add_term(edge, labels, proposal);
  for (std::uint32_t node = 0; node < nodes; ++node) {
    const double minimum = std::min(keep_[node], take_[node]);
    flow_.add_terminal(node, take_[node] - minimum, keep_[node] - minimum);
    flow_.add_terminal(nodes + node, keep_[node] - minimum, take_[node] - minimum);
  }
  flow_.solve();
  for (std::uint32_t node = 0; node < nodes; ++node) {
    const bool may_take = !flow_.on_source_side(node), may_keep = !flow_.on_source_side(nodes + node);
    if (may_take != may_keep) choices_[node] = may_take ? Choice::kTake : Choice::kKeep;
  }
  return choices_;
}

void Fusion::add_term(const Mrf::Edge& edge, const Labels& labels, const Labels& proposal) {
  const auto nodes = static_cast<std::uint32_t>(mrf_.nodes());
  const query::PairCost* table = mrf_.table(edge);
  const std::size_t columns = mrf_.label_count[edge.q];
  const auto cost = [&](const Labels& of_p, const Labels& of_q) {
    return double{table[of_p[edge.p] * columns + of_q[edge.q]]};
  };
  const double both_keep = cost(labels, labels), q_takes = cost(labels, proposal),
               p_takes = cost(proposal, labels), both_take = cost(proposal, proposal);
  const double excess = q_takes + p_takes - both_keep - both_take;
  if (excess >= 0) {  // of p keeping while q takes
    keep_[edge.p] += both_keep;
    take_[edge.p] += p_takes;
    take_[edge.q] += both_take - p_takes;
    flow_.add_edge(edge.p, edge.q, excess, 0);
    flow_.add_edge(nodes + edge.q, nodes + edge.p, excess, 0);
  } else {  // of both keeping
    keep_[edge.p] += q_takes;
    take_[edge.p] += both_take;
    keep_[edge.q] += p_takes - both_take;
    flow_.add_edge(edge.p, nodes + edge.q, -excess, 0);
    flow_.add_edge(edge.q, nodes + edge.p, -excess, 0);
  }
}

void fusion_moves(const Mrf& mrf, query::Solution& solution, const FusionOptions& options) {
  if (mrf.nodes() == 0) return;
  const query::Adjacency adjacency(mrf);
  Fusion fusion(mrf);
  Labels proposal(mrf.nodes()), fused;
  std::vector<float> costs;
  const auto fuse = [&] {
    const auto choices = fusion.choose(solution.labels, proposal);
    fused = solution.labels;
    for (std::size_t node = 0; node < fused.size(); ++node)
      if (choices[node] == Fusion::Choice::kTake) fused[node] = proposal[node];
    const double found = query::energy(mrf, fused);
    if (found >= solution.energy) return false;
    solution.energy = found;
    std::swap(solution.labels, fused);
    return true;
  };
  const auto propose_best_beside = [&] {
    for (std::size_t node = 0; node < proposal.size(); ++node) {
      const auto unary = mrf.unary_of(node);
      costs.assign(unary.begin(), unary.end());
      query::add_neighbour_costs(mrf, adjacency, node, solution.labels, costs);
      proposal[node] =
          static_cast<std::uint32_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
    }
  };
  const std::uint32_t ranks = *std::max_element(mrf.label_count.begin(), mrf.label_count.end());
  bool gained = true;
  for (int cycle = 0; gained && cycle < options.max_cycles; ++cycle) {
    gained = false;
    for (std::uint32_t rank = 0; rank < ranks; ++rank) {
      for (std::size_t node = 0; node < proposal.size(); ++node)
        proposal[node] = rank < mrf.label_count[node] ? rank : solution.labels[node];
      gained = fuse() || gained;
      if (rank % 8 != 0) continue;
      propose_best_beside();
      gained = fuse() || gained;
    }
    ++solution.iterations;
  }
}

}  // namespace freshet::bench
