#include "query/trw_s.h"

#include <algorithm>
#include <cmath>

#include "query/min_sum.h"

namespace freshet::query {
namespace {

constexpr int kPatience = 5;  // iterations over which the gap must shrink

float subtract_minimum(std::span<float> values) {
  const float least = *std::min_element(values.begin(), values.end());
  for (float& value : values) value -= least;
  return least;
}

class Passes {
 public:
  explicit Passes(const Mrf& mrf)
      : mrf_(mrf), adjacency_(mrf), message_of_(mrf.edges.size()), weight_(mrf.nodes()) {
    std::size_t length = 0, most_labels = 1;
    for (std::size_t e = 0; e < mrf.edges.size(); ++e) {
      message_of_[e] = length;
      length += std::max(mrf.label_count[mrf.edges[e].p], mrf.label_count[mrf.edges[e].q]);
    }
    for (std::size_t node = 0; node < mrf.nodes(); ++node) {
      most_labels = std::max<std::size_t>(most_labels, mrf.label_count[node]);
      const std::size_t chains =
          std::max(adjacency_.to_earlier(node).size(), adjacency_.to_later(node).size());
      weight_[node] = chains == 0 ? 1.0f : 1.0f / static_cast<float>(chains);
    }
    messages_.resize(length);
    belief_.resize(most_labels);
    outgoing_.resize(most_labels);
  }

  void forward() {
    for (std::size_t node = 0; node < mrf_.nodes(); ++node) {
      const auto belief = gather(node);
      for (const std::uint32_t e : adjacency_.to_later(node)) {
        const Mrf::Edge& edge = mrf_.edges[e];
        prepare(node, belief, e);
        const std::span<float> message(messages_.data() + message_of_[e], mrf_.label_count[edge.q]);
        min_over_rows(mrf_.table(edge), belief.size(), message.size(), outgoing_.data(), message.data());
        subtract_minimum(message);
      }
    }
  }

  /// Returns the lower bound.
  double backward() {
    double bound = 0;
    for (std::size_t node = mrf_.nodes(); node-- > 0;) {
      const auto belief = gather(node);
      bound += subtract_minimum(belief);
      for (const std::uint32_t e : adjacency_.to_earlier(node)) {
        const Mrf::Edge& edge = mrf_.edges[e];
        prepare(node, belief, e);
        const std::span<float> message(messages_.data() + message_of_[e], mrf_.label_count[edge.p]);
        min_over_columns(mrf_.table(edge), message.size(), belief.size(), outgoing_.data(), message.data());
        bound += subtract_minimum(message);
      }
    }
    return bound;
  }

  /// After a backward pass: earlier neighbours speak by their labels, later ones by their messages.
  void read_labels(Labels& labels) {
    for (std::size_t node = 0; node < mrf_.nodes(); ++node) {
      const std::span<float> cost(belief_.data(), mrf_.label_count[node]);
      const auto unary = mrf_.unary_of(node);
      std::copy(unary.begin(), unary.end(), cost.begin());
      for (const std::uint32_t e : adjacency_.to_earlier(node)) {
        const Mrf::Edge& edge = mrf_.edges[e];
        const float* row = mrf_.table(edge) + std::size_t{labels[edge.p]} * cost.size();
        for (std::size_t l = 0; l < cost.size(); ++l) cost[l] += row[l];
      }
      for (const std::uint32_t e : adjacency_.to_later(node)) add_message(e, cost);
      labels[node] = static_cast<std::uint32_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    }
  }

 private:
  void add_message(std::uint32_t e, std::span<float> to) const {
    const float* message = messages_.data() + message_of_[e];
    for (std::size_t l = 0; l < to.size(); ++l) to[l] += message[l];
  }

  std::span<float> gather(std::size_t node) {
    const std::span<float> belief(belief_.data(), mrf_.label_count[node]);
    const auto unary = mrf_.unary_of(node);
    std::copy(unary.begin(), unary.end(), belief.begin());
    for (const std::uint32_t e : adjacency_.to_earlier(node)) add_message(e, belief);
    for (const std::uint32_t e : adjacency_.to_later(node)) add_message(e, belief);
    return belief;
  }

  // What the node says along edge e: its share of its belief, less what the other end told it.
  void prepare(std::size_t node, std::span<const float> belief, std::uint32_t e) {
    const float* message = messages_.data() + message_of_[e];
    for (std::size_t l = 0; l < belief.size(); ++l) outgoing_[l] = weight_[node] * belief[l] - message[l];
  }

  const Mrf& mrf_;
  Adjacency adjacency_;
  std::vector<std::size_t> message_of_;
  std::vector<float> weight_;
  std::vector<float> messages_, belief_, outgoing_;
};

}  // namespace

Solution trw_s(const Mrf& mrf, const TrwsOptions& options) {
  Solution best;
  best.labels = unary_minimum(mrf);
  best.energy = energy(mrf, best.labels);
  if (mrf.edges.empty()) {
    best.lower_bound = best.energy;
    return best;
  }
  Passes passes(mrf);
  Labels labels(mrf.nodes());
  std::vector<double> gaps;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    passes.forward();
    best.lower_bound = std::max(best.lower_bound, passes.backward());
    passes.read_labels(labels);
    if (const double found = energy(mrf, labels); found < best.energy) {
      best.energy = found;
      best.labels = labels;
    }
    best.iterations = iteration + 1;
    gaps.push_back((best.energy - best.lower_bound) / std::max(std::abs(best.lower_bound), 1e-30));
    if (gaps.back() <= 0) break;
    if (iteration >= kPatience && gaps[iteration - kPatience] - gaps.back() < options.min_gap_decrease) break;
  }
  // The bound's own rounding must not let it pass an energy that a labelling reaches.
  best.lower_bound = std::min(best.lower_bound, best.energy);
  return best;
}

}  // namespace freshet::query
