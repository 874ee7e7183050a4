#include "query/exact_index.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>

namespace freshet::query {
namespace {

constexpr std::size_t kBlockRows = 32768;
constexpr int kPoints = vision::kGridSide * vision::kGridSide;

// Where a grid point's three bins lie among the lists. A cell's bins have as many lists as it has points.
struct Layout {
  std::array<std::array<int, 3>, kPoints> cells;
  std::array<std::uint32_t, vision::kPyramidCells> first_list;  // of a cell, in units of words
  std::array<std::uint32_t, vision::kPyramidCells> capacity{};  // points in a cell

  Layout() {
    for (int point = 0; point < kPoints; ++point) {
      cells[point] = vision::cells_of(point % vision::kGridSide, point / vision::kGridSide);
      for (const int cell : cells[point]) ++capacity[cell];
    }
    std::uint32_t lists = 0;
    for (int cell = 0; cell < vision::kPyramidCells; ++cell) {
      first_list[cell] = lists;
      lists += capacity[cell];
    }
  }
  std::uint32_t list(int cell, std::uint32_t word, std::uint32_t words, std::uint32_t occurrence) const {
    return first_list[cell] * words + word * capacity[cell] + occurrence;
  }
};

const Layout& layout() {
  static const Layout the_layout;
  return the_layout;
}

// How often each word has been met in each cell; emptied by walking the same points again.
class Occurrences {
 public:
  explicit Occurrences(std::uint32_t words) : words_(words), counts_(vision::kPyramidCells * words) {}
  std::uint32_t next(int cell, std::uint32_t word) { return counts_[cell * words_ + word]++; }
  void clear(const vision::WordMap& map) {
    for (int point = 0; point < kPoints; ++point) {
      for (const int cell : layout().cells[point]) counts_[cell * words_ + map[point]] = 0;
    }
  }

 private:
  std::uint32_t words_;
  std::vector<std::uint8_t> counts_;
};

template <class Visit>
void for_each_list(const vision::WordMap& map, std::uint32_t words, Occurrences& occurrences, Visit&& visit) {
  for (int point = 0; point < kPoints; ++point) {
    for (const int cell : layout().cells[point]) {
      visit(layout().list(cell, map[point], words, occurrences.next(cell, map[point])));
    }
  }
  occurrences.clear(map);
}

// The k best seen so far. Rows arrive in rising order, so that of equal scores the first k stay.
class Best {
 public:
  Best(std::size_t k, std::vector<Hit>& hits) : k_(k), hits_(hits) { hits_.clear(); }
  /// Only scores of at least this can still matter.
  std::uint32_t threshold() const { return threshold_; }
  void offer(Row row, std::uint32_t score) {
    hits_.push_back({row, score});
    if (hits_.size() >= 2 * k_ + 64) shrink();
  }
  void finish() {
    shrink();
    std::sort(hits_.begin(), hits_.end(), better);
  }

 private:
  void shrink() {
    if (hits_.size() < k_) return;
    const auto last = hits_.begin() + static_cast<std::ptrdiff_t>(k_ - 1);
    std::nth_element(hits_.begin(), last, hits_.end(), better);
    threshold_ = last->score + 1;
    hits_.resize(k_);
  }
  std::size_t k_;
  std::vector<Hit>& hits_;
  std::uint32_t threshold_ = 0;
};

}  // namespace

ExactIndex::ExactIndex(std::span<const vision::WordMap> words, int word_count)
    : rows_(words.size()), word_count_(word_count), blocks_((words.size() + kBlockRows - 1) / kBlockRows) {
  check_words(words, word_count);
  const auto count = static_cast<std::uint32_t>(word_count);
  const std::uint32_t lists = 3 * kPoints * count;
  oneapi::tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t b) {
    const auto maps = words.subspan(b * kBlockRows, std::min(kBlockRows, words.size() - b * kBlockRows));
    Block& block = blocks_[b];
    Occurrences occurrences(count);
    block.first.assign(lists + 1, 0);
    for (const vision::WordMap& map : maps) {
      for_each_list(map, count, occurrences, [&](std::uint32_t list) { ++block.first[list + 1]; });
    }
    for (std::uint32_t list = 0; list < lists; ++list) block.first[list + 1] += block.first[list];
    block.rows.resize(block.first.back());
    std::vector<std::uint32_t> next(block.first.begin(), block.first.end() - 1);
    for (std::size_t row = 0; row < maps.size(); ++row) {
      for_each_list(maps[row], count, occurrences,
                    [&](std::uint32_t list) { block.rows[next[list]++] = static_cast<std::uint16_t>(row); });
    }
  });
}

void ExactIndex::search_one(const PieceQuery& query, std::size_t k, const Admission& admission,
                            std::size_t number, std::span<std::uint16_t> sums, std::vector<Hit>& hits) const {
  const auto words = static_cast<std::uint32_t>(word_count_);
  // The lists of a bin lie side by side: one stretch a bin, from its first list to its count.
  struct Stretch {
    std::uint32_t first, last;  // lists
    std::uint16_t weight;
  };
  std::vector<Stretch> stretches;
  Occurrences occurrences(words);
  for (int point = 0; point < kPoints; ++point) {
    const std::uint32_t word = query.words[point];
    if (query.mask[point] == 0 || word >= words) continue;
    for (int level = 0; level < 3; ++level) {
      const int cell = layout().cells[point][level];
      const std::uint32_t occurrence = occurrences.next(cell, word);
      const std::uint32_t first = layout().list(cell, word, words, 0);
      const auto weight = static_cast<std::uint16_t>(vision::kLevelWeights[level]);
      stretches.push_back({first, first + occurrence + 1, weight});
    }
  }
  // Of the stretches of one bin, the longest holds the others.
  std::sort(stretches.begin(), stretches.end(), [](const Stretch& a, const Stretch& b) {
    return a.first != b.first ? a.first < b.first : a.last > b.last;
  });
  stretches.erase(std::unique(stretches.begin(), stretches.end(),
                              [](const Stretch& a, const Stretch& b) { return a.first == b.first; }),
                  stretches.end());

  Best best(k, hits);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const std::size_t first_row = b * kBlockRows, rows = std::min(kBlockRows, rows_ - first_row);
    if (admission.rows != nullptr && admission.rows->empty(first_row, rows)) continue;
    const Block& block = blocks_[b];
    std::fill(sums.begin(), sums.end(), std::uint16_t{0});
    for (const Stretch& stretch : stretches) {
      const std::uint16_t* row = block.rows.data() + block.first[stretch.first];
      const std::uint16_t* const end = block.rows.data() + block.first[stretch.last];
      for (; row != end; ++row) sums[*row] = static_cast<std::uint16_t>(sums[*row] + stretch.weight);
    }
    constexpr std::size_t kStep = 16;
    for (std::size_t row = 0; row < rows; row += kStep) {
      // Most of these reach nothing: one vector comparison.
      const auto threshold = static_cast<std::uint16_t>(best.threshold());
      std::uint16_t above = 0;
      for (std::size_t i = 0; i < kStep; ++i) above |= static_cast<std::uint16_t>(sums[row + i] >= threshold);
      if (above == 0) continue;
      for (std::size_t i = row; i < std::min(row + kStep, rows); ++i) {
        if (sums[i] < best.threshold() || !admission.admits(number, first_row + i)) continue;
        best.offer(static_cast<Row>(first_row + i), sums[i]);
      }
    }
  }
  best.finish();
}

std::vector<std::vector<Hit>> ExactIndex::search(std::span<const PieceQuery> queries, std::size_t k,
                                                 const Admission& admission) const {
  check(admission, queries.size(), rows_);
  std::vector<std::vector<Hit>> answers(queries.size());
  k = std::min(k, rows_);
  if (k == 0) return answers;
  oneapi::tbb::enumerable_thread_specific<std::vector<std::uint16_t>> sums(
      [] { return std::vector<std::uint16_t>(kBlockRows); });
  oneapi::tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t i) {
    search_one(queries[i], k, admission, i, sums.local(), answers[i]);
  });
  return answers;
}

}  // namespace freshet::query
