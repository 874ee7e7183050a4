// tests/query/mrf/random_mrf.h — small random fields whose true minimum can be found by trying everything.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "query/mrf/mrf.h"

namespace freshet::query {

struct RandomMrfOptions {
  std::uint32_t width = 3, height = 3;
  std::uint32_t labels = 3;
  bool uneven_labels = false;  // each node has 1..labels of them
  bool tree = false;           // keeps only the first column and all rows: a comb
  bool submodular = false;     // tables of two labels with equal labels cheaper than different ones
  std::uint64_t seed = 1;
};

inline Mrf random_mrf(const RandomMrfOptions& options) {
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<float> cost(0, 1);
  Mrf mrf;
  std::vector<float> costs;
  for (std::uint32_t node = 0; node < options.width * options.height; ++node) {
    costs.resize(options.uneven_labels ? 1 + random() % options.labels : options.labels);
    for (float& value : costs) value = cost(random);
    mrf.add_node(costs);
  }
  const auto connect = [&](std::uint32_t p, std::uint32_t q) {
    const Mrf::Edge edge = mrf.edges[mrf.add_edge(p, q)];
    const std::size_t columns = mrf.label_count[q];
    for (std::uint32_t i = 0; i < mrf.label_count[p]; ++i) {
      for (std::uint32_t j = 0; j < columns; ++j) {
        const float value = cost(random);
        mrf.table(edge)[i * columns + j] = options.submodular && i != j ? 1 + value : value * value;
      }
    }
  };
  for (std::uint32_t y = 0; y < options.height; ++y) {
    for (std::uint32_t x = 0; x < options.width; ++x) {
      const std::uint32_t node = y * options.width + x;
      if (x + 1 < options.width) connect(node, node + 1);
      if (y + 1 < options.height && (!options.tree || x == 0)) connect(node, node + options.width);
    }
  }
  return mrf;
}

inline double exhaustive_minimum(const Mrf& mrf) {
  Labels labels(mrf.nodes());
  double best = energy(mrf, labels);
  for (;;) {
    std::size_t node = 0;
    while (node < mrf.nodes() && ++labels[node] == mrf.label_count[node]) labels[node++] = 0;
    if (node == mrf.nodes()) return best;
    best = std::min(best, energy(mrf, labels));
  }
}

/// A field as large as a picture's, with heavy-tailed tables and a weak data term.
inline Mrf picture_sized_mrf(std::uint64_t seed, std::uint32_t width = 25, std::uint32_t height = 20,
                             std::uint32_t labels = 100) {
  std::mt19937_64 random(seed);
  std::normal_distribution<float> normal(0, 1);
  std::uniform_real_distribution<float> uniform(0, 0.3f);
  // Every label is a point of a few dimensions; a table holds squared distances, as the real ones do.
  constexpr int kDimensions = 6;
  Mrf mrf;
  std::vector<float> points(std::size_t{width} * height * labels * kDimensions);
  for (float& value : points) value = std::exp(0.8f * normal(random));
  std::vector<float> costs(labels);
  for (std::uint32_t node = 0; node < width * height; ++node) {
    for (float& value : costs) value = uniform(random);
    mrf.add_node(costs);
  }
  const auto connect = [&](std::uint32_t p, std::uint32_t q) {
    const Mrf::Edge edge = mrf.edges[mrf.add_edge(p, q)];
    for (std::uint32_t i = 0; i < labels; ++i) {
      for (std::uint32_t j = 0; j < labels; ++j) {
        float sum = 0;
        for (int d = 0; d < kDimensions; ++d) {
          const float difference = points[(std::size_t{p} * labels + i) * kDimensions + d] -
                                   points[(std::size_t{q} * labels + j) * kDimensions + d];
          sum += difference * difference;
        }
        mrf.table(edge)[i * labels + j] = sum;
      }
    }
  };
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::uint32_t node = y * width + x;
      if (x + 1 < width) connect(node, node + 1);
      if (y + 1 < height) connect(node, node + width);
    }
  }
  return mrf;
}

}  // namespace freshet::query
