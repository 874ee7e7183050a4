#include "bench/scale/store_realism.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "freshet/error.h"
#include "query/index/dense_histogram.h"

namespace freshet::bench {

std::vector<double> word_fractions(std::span<const vision::WordMap> words, int word_count) {
  std::vector<double> fractions(static_cast<std::size_t>(word_count), 0);
  for (const vision::WordMap& map : words) {
    for (const std::uint8_t word : map) ++fractions[word];
  }
  const double points = static_cast<double>(words.size()) * std::tuple_size_v<vision::WordMap>;
  for (double& fraction : fractions) fraction /= points;
  return fractions;
}

double total_variation(std::span<const double> p, std::span<const double> q) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += std::abs(p[i] - q[i]);
  return sum / 2;
}

double divergence_bits(std::span<const double> p, std::span<const double> q) {
  constexpr double kMin = 1e-6;
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p[i] > 0) sum += p[i] * std::log2(p[i] / std::max(q[i], kMin));
  }
  return sum;
}

double mean_bins(std::span<const vision::WordMap> words, int word_count) {
  std::vector<unsigned char> histogram(query::histogram_bins(word_count));
  double sum = 0;
  for (const vision::WordMap& map : words) {
    query::fill_histogram(query::whole_query(map), word_count, histogram);
    sum += static_cast<double>(histogram.size() - std::ranges::count(histogram, 0));
  }
  return sum / static_cast<double>(words.size());
}

NeighbourScores neighbour_scores(const query::CandidateIndex& index,
                                 std::span<const query::PieceQuery> queries) {
  constexpr std::size_t kRanks = 100;
  NeighbourScores scores;
  const auto answers = index.search(queries, kRanks);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (answers[i].size() < kRanks)
      throw Error(ErrorKind::kUsage, "neighbours",
                  std::to_string(index.rows()) + " patches have no hundredth");
    const double whole = query::max_score(queries[i]) * static_cast<double>(queries.size());
    scores.first += answers[i][0].score / whole;
    scores.tenth += answers[i][9].score / whole;
    scores.hundredth += answers[i][99].score / whole;
  }
  return scores;
}

std::vector<double> best_scores(const query::CandidateIndex& index,
                                std::span<const query::PieceQuery> queries, const query::RowFilter& allowed) {
  std::vector<double> best;
  const auto answers = index.search(queries, 1, {.rows = &allowed});
  for (std::size_t i = 0; i < queries.size(); ++i)
    best.push_back(
        answers[i].empty() ? 0 : answers[i][0].score / static_cast<double>(query::max_score(queries[i])));
  return best;
}

query::PieceQuery query_of(const vision::WordMap& words) {
  query::PieceQuery query{words, {}};
  query.mask.fill(1);
  return query;
}

}  // namespace freshet::bench
