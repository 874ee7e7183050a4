#include "bench/harness/features_of_patches.h"

#include <algorithm>

namespace freshet::bench {

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

}  // namespace freshet::bench
