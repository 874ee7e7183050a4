#include "query/index/dense_histogram.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cstdlib>

#include "platform/vectors.h"

namespace freshet::query {

PieceQuery whole_query(const vision::WordMap& words) {
  PieceQuery query{words, {}};
  query.mask.fill(1);
  return query;
}

void fill_histogram(const PieceQuery& query, int word_count, std::span<unsigned char> histogram) {
  assert(histogram.size() == histogram_bins(word_count));
  std::fill(histogram.begin(), histogram.end(), static_cast<unsigned char>(0));
  for (int point = 0; point < vision::kGridSide * vision::kGridSide; ++point) {
    if (query.mask[point] == 0 || query.words[point] >= word_count) continue;
    const auto cells = vision::cells_of(point % vision::kGridSide, point / vision::kGridSide);
    for (int level = 0; level < 3; ++level) {
      unsigned char& bin =
          histogram[static_cast<std::size_t>(cells[level] * word_count + query.words[point])];
      bin = static_cast<unsigned char>(bin + vision::kLevelWeights[level]);
    }
  }
}

std::vector<unsigned char> dense_histograms(vision::WordMaps words, int word_count) {
  const std::size_t bins = histogram_bins(word_count);
  std::vector<unsigned char> histograms(words.size() * bins);
  oneapi::tbb::parallel_for(std::size_t{0}, words.size(), [&](std::size_t row) {
    fill_histogram(whole_query(words[row]), word_count, std::span(histograms).subspan(row * bins, bins));
  });
  return histograms;
}

FRESHET_WIDE std::uint32_t l1_distance(const unsigned char* a, const unsigned char* b, std::size_t bins) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < bins; ++i) sum += static_cast<std::uint32_t>(std::abs(int{a[i]} - int{b[i]}));
  return sum;
}

std::uint32_t score_of(int query_max_score, std::uint32_t distance) {
  constexpr int kPatchMaxScore =
      vision::kGridSide * vision::kGridSide *
      (vision::kLevelWeights[0] + vision::kLevelWeights[1] + vision::kLevelWeights[2]);
  return (static_cast<std::uint32_t>(query_max_score + kPatchMaxScore) - distance) / 2;
}

}  // namespace freshet::query
