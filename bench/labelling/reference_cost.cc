#include "bench/labelling/reference_cost.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "bench/harness/machine.h"
#include "query/costs/pairwise.h"

namespace freshet::bench {
namespace {

constexpr std::size_t kCheckedEdges = 10;

double square(double value) { return value * value; }

/// What a cell's value counts as, channel by channel, before weights.
std::vector<double> log_features(const query::FeatureShape& shape, query::CostForm form, const float* cell) {
  std::vector<double> values(cell, cell + shape.channels());
  const int first_level = 2 + 2 * shape.bands;
  if (form == query::CostForm::kPower) {
    for (int c = 0; c < 2; ++c) values[c] /= 25;
    for (int c = 2; c < first_level; ++c) values[c] /= 25 * 25;
    return values;
  }
  const double speed = std::hypot(values[0], values[1]);
  for (int c = 0; c < 2; ++c) values[c] *= speed > 0 ? std::log1p(speed / 2.5) / speed : 0;
  for (int c = 2; c < first_level; ++c) values[c] = 0.5 * std::log1p(std::max(0.0, values[c]));
  for (int c = first_level; c < shape.channels(); ++c) values[c] = std::log1p(512 * std::max(0.0, values[c]));
  return values;
}

/// All features of patches, shape.values() each, as vision::patch_features lays them out.
std::vector<float> features_of_patches(const query::FeatureSource& source, const query::FeatureShape& shape,
                                       std::span<const stored::Row> rows) {
  const auto across = static_cast<std::size_t>(shape.squares()),
             side = static_cast<std::size_t>(shape.square());
  std::vector<query::Square> squares(rows.size() * across * across);
  for (std::size_t i = 0; i < rows.size(); ++i)
    source.squares(rows[i], std::span(squares).subspan(i * across * across, across * across));
  std::vector<query::Square> distinct = squares;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  std::vector<float> of_squares(distinct.size() * shape.square_values());
  source.read(distinct, [&](std::size_t place, std::span<const float> values) {
    std::copy(values.begin(), values.end(), of_squares.data() + place * shape.square_values());
  });
  std::vector<float> features(rows.size() * shape.values());
  const std::size_t line = side * static_cast<std::size_t>(shape.channels());
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const auto place = std::lower_bound(distinct.begin(), distinct.end(), squares[i]) - distinct.begin();
    const float* from = of_squares.data() + static_cast<std::size_t>(place) * shape.square_values();
    const std::size_t k = i % (across * across), corner = k / across * side * across + k % across;
    float* to = features.data() + i / (across * across) * shape.values() + corner * line;
    for (std::size_t y = 0; y < side; ++y) std::copy_n(from + y * line, line, to + y * across * line);
  }
  return features;
}

/// Eq. 2, 3 and 6 for two patches: b beside a, or below it.
class ReferenceCost {
 public:
  ReferenceCost(const query::FeatureShape& shape, const query::PairwiseOptions& options)
      : shape_(shape), options_(options) {}
  using Patch = std::vector<std::vector<double>>;  // log features of its cells, row-major
  std::vector<Patch> patches(const query::FeatureSource& source, std::span<const stored::Row> rows) const {
    const std::vector<float> features = features_of_patches(source, shape_, rows);
    const float* from = features.data();
    std::vector<Patch> patches(rows.size());
    for (Patch& patch : patches) {
      for (int cell = 0; cell < shape_.cells * shape_.cells; ++cell, from += shape_.channels())
        patch.push_back(log_features(shape_, options_.form, from));
    }
    return patches;
  }
  double operator()(const Patch& a, const Patch& b, bool beside) const {
    const int rest = shape_.cells - shape_.overlap;
    const int rows = beside ? shape_.cells : shape_.overlap, columns = beside ? shape_.overlap : shape_.cells;
    double motion = 0, power = 0, texture = 0;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const auto& of_a = a[(row + (beside ? 0 : rest)) * shape_.cells + column + (beside ? rest : 0)];
        const auto& of_b = b[row * shape_.cells + column];
        const int first_level = 2 + 2 * shape_.bands;
        for (int c = 0; c < 2; ++c) motion += square(of_a[c] - of_b[c]);
        for (int c = 2; c < first_level; ++c) power += square(of_a[c] - of_b[c]);
        for (int c = first_level; c < shape_.channels(); ++c) texture += square(of_a[c] - of_b[c]);
      }
    }
    return options_.lambda * (motion + options_.sigma * power + options_.rho * texture) / (rows * columns);
  }

 private:
  query::FeatureShape shape_;
  query::PairwiseOptions options_;
};

}  // namespace

TableError check_tables(const query::Mrf& mrf, const query::CandidateSearch& search,
                        const query::FeatureShape& shape, const query::PairwiseOptions& options,
                        const query::FeatureSource& source) {
  const ReferenceCost cost(shape, options);
  TableError error;
  error.edges = std::min(kCheckedEdges, mrf.edges.size());
  for (std::size_t e = 0; e < error.edges; ++e) {
    const query::Mrf::Edge& edge = mrf.edges[e * mrf.edges.size() / error.edges];
    const auto rows_p = search.candidates.rows_of(edge.p), rows_q = search.candidates.rows_of(edge.q);
    const auto patches_p = cost.patches(source, rows_p), patches_q = cost.patches(source, rows_q);
    const bool beside = search.target.corners[edge.p].y == search.target.corners[edge.q].y;
    const double start = thread_seconds();
    std::vector<double> expected;
    for (const auto& p : patches_p)
      for (const auto& q : patches_q) expected.push_back(cost(p, q, beside));
    error.loop_seconds += thread_seconds() - start;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double difference = std::abs(mrf.table(edge)[i] - expected[i]);
      error.absolute = std::max(error.absolute, difference);
      error.relative = std::max(error.relative, difference / std::max(expected[i], kCostThatMatters));
    }
    error.pairs += expected.size();
  }
  return error;
}

}  // namespace freshet::bench
