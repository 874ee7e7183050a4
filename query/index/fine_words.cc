#include "query/index/fine_words.h"

#include <cstring>
#include <limits>

#include "platform/vectors.h"

namespace freshet::query {
namespace {

constexpr int kSide = vision::kGridSide, kPoints = kSide * kSide;
constexpr std::size_t kPadded = 96, kMaxInCell = 9;

// The cell of level 2 that a point lies in.
const std::array<int, kPoints> kFineCell = [] {
  std::array<int, kPoints> cells;
  for (int point = 0; point < kPoints; ++point)
    cells[point] = vision::cells_of(point % kSide, point / kSide)[2];
  return cells;
}();

// The points of a cell that come before another lie up to two columns and two rows away.
template <class Word>
struct Earlier {
  static constexpr std::size_t kOffsets = 12, kFarthest = 2 * kSide + 2;
  std::array<std::size_t, kOffsets> back;
  std::array<std::array<Word, kPadded>, kOffsets> in_cell{};  // that the point so far back is

  Earlier() {
    std::size_t n = 0;
    for (int dy = 0; dy <= 2; ++dy)
      for (int dx = dy == 0 ? 1 : -2; dx <= 2; ++dx, ++n) {
        back[n] = static_cast<std::size_t>(dy * kSide + dx);
        for (int point = 0; point < kPoints; ++point) {
          const int x = point % kSide - dx, y = point / kSide - dy;
          if (x >= 0 && x < kSide && y >= 0) in_cell[n][point] = kFineCell[point] == kFineCell[y * kSide + x];
        }
      }
  }
};
template <class Word>
const Earlier<Word> kEarlier;

template <class Word, std::size_t kBytes>
struct VectorOf {
  typedef Word Type __attribute__((vector_size(kBytes)));
};

// Points whose word is wanted more often than it was before, a vector of points at a time. Inlined into a
// function for each width: gcc takes wider vectors than a processor has apart into single bytes.
template <class Word, std::size_t kBytes>
inline __attribute__((always_inline)) std::uint32_t count_shared(const Word* row, const Word* words,
                                                                 const Word* is_there) {
  using Vector = typename VectorOf<Word, kBytes>::Type;
  const Earlier<Word>& earlier = kEarlier<Word>;
  Vector sums{};  // of at most 12
  for (std::size_t i = 0; i < kPadded; i += kBytes / sizeof(Word)) {
    Vector here, other, mask, wanted{}, before{};
    std::memcpy(&here, row + i, sizeof here);
    for (std::size_t n = 0; n < kMaxInCell; ++n) {
      std::memcpy(&other, words + n * kPadded + i, sizeof other);
      std::memcpy(&mask, is_there + n * kPadded + i, sizeof mask);
      wanted += (here == other) & mask;
    }
    for (std::size_t n = 0; n < Earlier<Word>::kOffsets; ++n) {
      std::memcpy(&other, row + i - earlier.back[n], sizeof other);
      std::memcpy(&mask, earlier.in_cell[n].data() + i, sizeof mask);
      before += (here == other) & mask;
    }
    sums -= before < wanted;  // true is -1
  }
  std::uint64_t eights[kBytes / 8], sum = 0;
  std::memcpy(eights, &sums, sizeof sums);
  for (const std::uint64_t eight : eights) sum += eight;
  constexpr std::uint64_t kOnes = ~std::uint64_t{0} / std::numeric_limits<Word>::max();  // a 1 in each lane
  return static_cast<std::uint32_t>(sum * kOnes >>
                                    (64 - 8 * sizeof(Word)));  // the sum of its lanes, at most 81
}

template <class Word>
std::uint32_t count_16(const Word* row, const Word* words, const Word* is_there) {
  return count_shared<Word, 16>(row, words, is_there);
}
#if FRESHET_HAS_WIDE
template <class Word>
__attribute__((target("arch=x86-64-v3"))) std::uint32_t count_32(const Word* row, const Word* words,
                                                                 const Word* is_there) {
  return count_shared<Word, 32>(row, words, is_there);
}
template <class Word>
const auto kCount = vector_bytes() >= 32 ? count_32<Word> : count_16<Word>;
#else
template <class Word>
const auto kCount = count_16<Word>;
#endif

}  // namespace

template <class Word>
FineWords<Word>::FineWords(const PieceQuery& query, std::size_t word_count) {
  for (int point = 0; point < kPoints; ++point) {
    std::size_t n = 0;
    for (int other = 0; other < kPoints; ++other) {
      if (query.mask[other] == 0 || query.words[other] >= word_count || kFineCell[other] != kFineCell[point])
        continue;
      words_[n][point] = static_cast<Word>(query.words[other]);
      is_there_[n++][point] = 1;
    }
  }
}

template <class Word>
std::uint32_t FineWords<Word>::intersection(const Word* map) const {
  constexpr std::size_t kBefore = Earlier<Word>::kFarthest;
  Word row[kBefore + kPadded] = {};
  std::memcpy(row + kBefore, map, kPoints * sizeof(Word));
  return kCount<Word>(row + kBefore, words_[0].data(), is_there_[0].data());
}

template class FineWords<std::uint8_t>;
template class FineWords<std::uint16_t>;

}  // namespace freshet::query
