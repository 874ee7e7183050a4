#include "query/index/exact_index.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>

#include "query/index/fine_words.h"

namespace freshet::query {
namespace {

constexpr std::size_t kBlockRows = PyramidSums::kRows;
constexpr int kPoints = vision::kGridSide * vision::kGridSide;
constexpr std::size_t kQueriesAtOnce = 32;  // that share a block's lists while they are in the cache

// The k best seen so far.
class Best {
 public:
  explicit Best(std::size_t k) : k_(k) { scored_patches_.reserve(2 * k + kSpare); }
  /// No row of a lower score can be among the best; 0 until there are k.
  std::uint32_t min_score() const { return min_score_; }
  void offer(stored::Row row, std::uint32_t score) {
    if (score < min_score_) return;
    scored_patches_.push_back({row, score});
    if (scored_patches_.size() == 2 * k_ + kSpare) shrink();
  }
  void shrink() {
    if (scored_patches_.size() < k_) return;
    const auto last = scored_patches_.begin() + static_cast<std::ptrdiff_t>(k_ - 1);
    std::nth_element(scored_patches_.begin(), last, scored_patches_.end(), better);
    min_score_ = last->score;
    scored_patches_.resize(k_);
  }
  std::vector<ScoredPatch> take() {
    shrink();
    std::sort(scored_patches_.begin(), scored_patches_.end(), better);
    return std::move(scored_patches_);
  }

 private:
  static constexpr std::size_t kSpare = 64;
  std::size_t k_;
  std::vector<ScoredPatch> scored_patches_;
  std::uint32_t min_score_ = 0;
};

// What a thread works in: sums of a block, the columns that went into them, some of them made here of
// numbers, and rows to compare.
struct Scratch {
  PyramidSums sums;
  std::vector<const RowBits*> level0, level1;
  std::vector<std::array<RowBits, PyramidSums::kGroups>> made =
      std::vector<std::array<RowBits, PyramidSums::kGroups>>(2 * kPoints);
  std::array<std::uint16_t, kBlockRows> rows;
};

// A block of rows, kPoints words each.
template <class Word>
struct Block {
  std::size_t first_row, rows;
  const Word* words;
  const Word* row(std::size_t at) const { return words + at * kPoints; }
};

// The lists of one level that a query takes.
class LevelLists {
 public:
  void add(const RowLists::List& list) {
    if (list.bits != nullptr)
      columns_.push_back(list.bits);
    else if (!list.rows.empty())
      few_.push_back(list.rows);
  }
  /// Their columns in a block, blocks being asked for in rising order; `made` grows by those made of numbers.
  void columns(std::size_t first_row, Scratch& scratch, std::size_t& made,
               std::vector<const RowBits*>& columns) {
    columns.clear();
    for (const RowBits* column : columns_) columns.push_back(column + first_row / RowBits::kRows);
    for (std::span<const std::uint32_t>& rows : few_) {
      while (!rows.empty() && rows.front() < first_row) rows = rows.subspan(1);
      if (rows.empty() || rows.front() >= first_row + kBlockRows) continue;
      auto& column = scratch.made[made++];
      column.fill({});
      for (; !rows.empty() && rows.front() < first_row + kBlockRows; rows = rows.subspan(1)) {
        const std::size_t row = rows.front() - first_row;
        column[row / RowBits::kRows].words[row / 64 % 8] |= std::uint64_t{1} << row % 64;
      }
      columns.push_back(column.data());
    }
  }

 private:
  std::vector<const RowBits*> columns_;
  std::vector<std::span<const std::uint32_t>> few_;  // what lies ahead of them
};

// A query made ready, and the best it has found.
template <class Word>
class Search {
 public:
  Search(const PieceQuery& query, const RowLists& lists, std::size_t word_count, std::size_t number,
         std::size_t k)
      : number_(number), k_(k), best_(k), fine_(query, word_count) {
    std::array<std::array<std::uint8_t, vision::kMaxWords>, RowLists::kCells> times{};
    for (int point = 0; point < kPoints; ++point) {
      const std::size_t word = query.words[point];
      if (query.mask[point] == 0 || word >= word_count) continue;
      const auto cells = vision::cells_of(point % vision::kGridSide, point / vision::kGridSide);
      level0_.add(lists.list(0, word, ++times[0][word]));
      level1_.add(lists.list(cells[1], word, ++times[cells[1]][word]));
    }
  }

  void add_block(const Block<Word>& block, const SearchFilter& search_filter, Scratch& scratch) {
    std::size_t made = 0;
    level0_.columns(block.first_row, scratch, made, scratch.level0);
    level1_.columns(block.first_row, scratch, made, scratch.level1);
    const std::size_t groups = (block.rows + RowBits::kRows - 1) / RowBits::kRows;
    scratch.sums.add_up(scratch.level0, scratch.level1, groups);

    const PyramidSums::Mask all = admitted(block, search_filter);
    PyramidSums::Mask compared{};
    std::uint32_t reach = 0;
    if (best_.min_score() > 0) {
      reach = best_.min_score() + 1;  // of equal scores the lower row is the better, and it has come before
    } else {
      // The most promising rows first: they tell what the others must reach.
      std::uint32_t promising = 0;
      for (std::uint32_t bit = 256; bit > 0; bit /= 2) {
        PyramidSums::Mask mask = all;
        if (scratch.sums.keep_reaching(promising + bit, groups, mask) >= 2 * k_) promising += bit;
      }
      if (promising > 0) {
        compared = all;
        scratch.sums.keep_reaching(promising, groups, compared);
        compare(block, compared, search_filter, scratch);
        reach = best_.min_score();
      }
    }
    PyramidSums::Mask mask = all;
    if (scratch.sums.keep_reaching(reach, groups, mask) == 0) return;
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] &= ~compared[i];
    compare(block, mask, search_filter, scratch);
  }

  std::vector<ScoredPatch> take() { return best_.take(); }

 private:
  static PyramidSums::Mask admitted(const Block<Word>& block, const SearchFilter& search_filter) {
    PyramidSums::Mask mask{};
    if (search_filter.rows != nullptr) {
      const auto words = search_filter.rows->bit_words().subspan(block.first_row / 64);
      std::copy_n(words.begin(), std::min(words.size(), mask.size()), mask.begin());
      return mask;
    }
    std::fill_n(mask.begin(), block.rows / 64, ~std::uint64_t{0});
    if (block.rows % 64 != 0) mask[block.rows / 64] = (std::uint64_t{1} << block.rows % 64) - 1;
    return mask;
  }

  // Offers the rows of a mask with their scores, and learns what is to be reached from now on.
  void compare(const Block<Word>& block, const PyramidSums::Mask& mask, const SearchFilter& search_filter,
               Scratch& scratch) {
    // Word maps lie anywhere in memory: all are asked for before the first is needed.
    std::size_t count = 0;
    for (std::size_t i = 0; i < mask.size(); ++i)
      for (std::uint64_t rest = mask[i]; rest != 0; rest &= rest - 1) {
        const std::size_t row = i * 64 + static_cast<std::size_t>(std::countr_zero(rest));
        __builtin_prefetch(block.row(row));
        __builtin_prefetch(block.row(row + 1) - 1);
        scratch.rows[count++] = static_cast<std::uint16_t>(row);
      }
    for (const std::uint16_t row : std::span(scratch.rows).first(count)) {
      if (!search_filter.admits(number_, block.first_row + row)) continue;
      best_.offer(static_cast<stored::Row>(block.first_row + row),
                  scratch.sums.sum_of(row) + vision::kLevelWeights[2] * fine_.intersection(block.row(row)));
    }
    best_.shrink();
  }

  std::size_t number_, k_;
  Best best_;
  FineWords<Word> fine_;
  LevelLists level0_, level1_;
};

vision::WordMaps checked(vision::WordMaps words, int word_count) {
  check_words(words, word_count);
  return words;
}

}  // namespace

ExactIndex::ExactIndex(vision::WordMaps words, int word_count)
    : words_(checked(words, word_count)),
      word_count_(static_cast<std::size_t>(word_count)),
      lists_(words_, word_count_) {}

std::vector<std::vector<ScoredPatch>> ExactIndex::search(std::span<const PieceQuery> queries, std::size_t k,
                                                         const SearchFilter& search_filter) const {
  return words_.visit([&](auto words) { return search_words(words, queries, k, search_filter); });
}

template <class Word>
std::vector<std::vector<ScoredPatch>> ExactIndex::search_words(std::span<const Word> words,
                                                               std::span<const PieceQuery> queries,
                                                               std::size_t k,
                                                               const SearchFilter& search_filter) const {
  check(search_filter, queries.size(), rows());
  std::vector<std::vector<ScoredPatch>> answers(queries.size());
  k = std::min(k, rows());
  if (k == 0) return answers;
  const std::size_t parts = (queries.size() + kQueriesAtOnce - 1) / kQueriesAtOnce;
  oneapi::tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
    thread_local Scratch scratch;  // kept from search to search: a single piece takes less than making it
    const std::size_t first = part * queries.size() / parts, last = (part + 1) * queries.size() / parts;
    std::vector<Search<Word>> searches;
    searches.reserve(last - first);
    for (std::size_t i = first; i < last; ++i) searches.emplace_back(queries[i], lists_, word_count_, i, k);
    for (std::size_t row = 0; row < rows(); row += kBlockRows) {
      const Block<Word> block{row, std::min(kBlockRows, rows() - row), words.data() + row * kPoints};
      if (search_filter.rows != nullptr && search_filter.rows->empty(row, block.rows)) continue;
      for (Search<Word>& search : searches) search.add_block(block, search_filter, scratch);
    }
    for (std::size_t i = first; i < last; ++i) answers[i] = searches[i - first].take();
  });
  return answers;
}

}  // namespace freshet::query
