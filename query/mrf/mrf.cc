#include "query/mrf/mrf.h"

#include <algorithm>
#include <cassert>

namespace freshet::query {

std::uint32_t Mrf::add_node(std::span<const float> costs) {
  assert(!costs.empty());
  label_count.push_back(static_cast<std::uint32_t>(costs.size()));
  unary.insert(unary.end(), costs.begin(), costs.end());
  first_unary.push_back(unary.size());
  return static_cast<std::uint32_t>(label_count.size() - 1);
}

std::size_t Mrf::add_edge(std::uint32_t p, std::uint32_t q) {
  assert(p < q && q < nodes());
  edges.push_back({p, q, pairwise.size()});
  pairwise.resize(pairwise.size() + std::size_t{label_count[p]} * label_count[q]);
  return edges.size() - 1;
}

double energy(const Mrf& mrf, const Labels& labels) {
  assert(labels.size() == mrf.nodes());
  double sum = 0;
  for (std::size_t node = 0; node < mrf.nodes(); ++node) sum += mrf.unary_of(node)[labels[node]];
  for (const Mrf::Edge& edge : mrf.edges) {
    sum += mrf.table(edge)[std::size_t{labels[edge.p]} * mrf.label_count[edge.q] + labels[edge.q]];
  }
  return sum;
}

Labels unary_minimum(const Mrf& mrf) {
  Labels labels(mrf.nodes());
  for (std::size_t node = 0; node < mrf.nodes(); ++node) {
    const auto costs = mrf.unary_of(node);
    labels[node] = static_cast<std::uint32_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  }
  return labels;
}

Adjacency::Adjacency(const Mrf& mrf)
    : first_earlier(mrf.nodes() + 1),
      earlier(mrf.edges.size()),
      first_later(mrf.nodes() + 1),
      later(mrf.edges.size()) {
  for (const Mrf::Edge& edge : mrf.edges) {
    ++first_earlier[edge.q + 1];
    ++first_later[edge.p + 1];
  }
  for (std::size_t node = 0; node < mrf.nodes(); ++node) {
    first_earlier[node + 1] += first_earlier[node];
    first_later[node + 1] += first_later[node];
  }
  std::vector<std::uint32_t> next_earlier(first_earlier), next_later(first_later);
  for (std::uint32_t e = 0; e < mrf.edges.size(); ++e) {
    earlier[next_earlier[mrf.edges[e].q]++] = e;
    later[next_later[mrf.edges[e].p]++] = e;
  }
}

void add_neighbour_costs(const Mrf& mrf, const Adjacency& adjacency, std::size_t node, const Labels& labels,
                         std::span<float> costs) {
  for (const std::uint32_t e : adjacency.to_earlier(node)) {
    const Mrf::Edge& edge = mrf.edges[e];
    const PairCost* row = mrf.table(edge) + std::size_t{labels[edge.p]} * mrf.label_count[node];
    for (std::size_t l = 0; l < costs.size(); ++l) costs[l] += row[l];
  }
  for (const std::uint32_t e : adjacency.to_later(node)) {
    const Mrf::Edge& edge = mrf.edges[e];
    const std::size_t columns = mrf.label_count[edge.q];
    const PairCost* column = mrf.table(edge) + labels[edge.q];
    for (std::size_t l = 0; l < costs.size(); ++l) costs[l] += column[l * columns];
  }
}

std::vector<float> margins(const Mrf& mrf, const Labels& labels) {
  const Adjacency adjacency(mrf);
  std::vector<float> rises(mrf.nodes(), std::numeric_limits<float>::infinity()), costs;
  for (std::size_t node = 0; node < mrf.nodes(); ++node) {
    const auto unary = mrf.unary_of(node);
    costs.assign(unary.begin(), unary.end());
    add_neighbour_costs(mrf, adjacency, node, labels, costs);
    for (std::size_t label = 0; label < costs.size(); ++label)
      if (label != labels[node]) rises[node] = std::min(rises[node], costs[label] - costs[labels[node]]);
  }
  return rises;
}

}  // namespace freshet::query
