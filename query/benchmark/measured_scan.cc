// A whole index for freshet query bench: every patch's histogram beside the query's, byte by byte. It is
// exact, knows conditions, and is what every cleverer index must beat.

#include <algorithm>

#include "query/benchmark/measured_indexes.h"
#include "query/index/dense_histogram.h"

namespace freshet::query {
namespace {

class Scan final : public CandidateIndex {
 public:
  explicit Scan(const SearchSpace& space)
      : word_count_(space.word_count),
        rows_(space.words.size()),
        histograms_(dense_histograms(space.words, space.word_count)) {}

  std::size_t rows() const override { return rows_; }

  std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t k,
                                               const SearchFilter& search_filter) const override {
    return search_each(queries, [&](const PieceQuery& query, std::size_t number) {
      const std::size_t bins = histogram_bins(word_count_);
      std::vector<unsigned char> asked(bins);
      fill_histogram(query, word_count_, asked);
      std::vector<ScoredPatch> scored_patches;
      for (std::size_t row = 0; row < rows_; ++row) {
        if (!search_filter.admits(number, row)) continue;
        const std::uint32_t distance = l1_distance(asked.data(), histograms_.data() + row * bins, bins);
        scored_patches.push_back({static_cast<stored::Row>(row), score_of(max_score(query), distance)});
      }
      const std::size_t kept = std::min(k, scored_patches.size());
      std::partial_sort(scored_patches.begin(), scored_patches.begin() + static_cast<std::ptrdiff_t>(kept),
                        scored_patches.end(), better);
      scored_patches.resize(kept);
      return scored_patches;
    });
  }

 private:
  int word_count_;
  std::size_t rows_;
  std::vector<unsigned char> histograms_;
};

}  // namespace

MeasuredIndex measured_scan() {
  return {.name = "scan",
          .what = "every patch, dense bytes, L1",
          .is_exact = true,
          .build = [](const SearchSpace& space) -> BuiltIndex {
            return {std::make_shared<Scan>(space), {{"all rows", [] {}}}};
          }};
}

}  // namespace freshet::query
