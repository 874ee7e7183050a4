#include "query/index/fine_words.h"

#include <cstring>

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
struct Earlier {
  static constexpr std::size_t kOffsets = 12, kFarthest = 2 * kSide + 2;
  std::array<std::size_t, kOffsets> back;
  std::array<std::array<std::uint8_t, kPadded>, kOffsets> in_cell{};  // that the point so far back is

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
const Earlier kEarlier;

typedef std::uint8_t Bytes16 __attribute__((vector_size(16)));
typedef std::uint8_t Bytes32 __attribute__((vector_size(32)));

// Points whose word is wanted more often than it was before, a vector of points at a time. Inlined into a
// function for each width: gcc takes wider vectors than a processor has apart into single bytes.
template <class Bytes>
inline __attribute__((always_inline)) std::uint32_t count_shared(const std::uint8_t* row,
                                                                 const std::uint8_t* words,
                                                                 const std::uint8_t* is_there) {
  Bytes sums{};  // of at most 6
  for (std::size_t i = 0; i < kPadded; i += sizeof(Bytes)) {
    Bytes here, other, mask, wanted{}, before{};
    std::memcpy(&here, row + i, sizeof here);
    for (std::size_t n = 0; n < kMaxInCell; ++n) {
      std::memcpy(&other, words + n * kPadded + i, sizeof other);
      std::memcpy(&mask, is_there + n * kPadded + i, sizeof mask);
      wanted += (here == other) & mask;
    }
    for (std::size_t n = 0; n < Earlier::kOffsets; ++n) {
      std::memcpy(&other, row + i - kEarlier.back[n], sizeof other);
      std::memcpy(&mask, kEarlier.in_cell[n].data() + i, sizeof mask);
      before += (here == other) & mask;
    }
    sums -= before < wanted;  // true is -1
  }
  std::uint64_t eights[sizeof(Bytes) / 8], sum = 0;
  std::memcpy(eights, &sums, sizeof sums);
  for (const std::uint64_t eight : eights) sum += eight;
  return static_cast<std::uint32_t>(sum * 0x0101010101010101u >> 56);  // the sum of its bytes, at most 81
}

std::uint32_t count_16(const std::uint8_t* row, const std::uint8_t* words, const std::uint8_t* is_there) {
  return count_shared<Bytes16>(row, words, is_there);
}
#if FRESHET_HAS_WIDE
__attribute__((target("arch=x86-64-v3"))) std::uint32_t count_32(const std::uint8_t* row,
                                                                 const std::uint8_t* words,
                                                                 const std::uint8_t* is_there) {
  return count_shared<Bytes32>(row, words, is_there);
}
const auto kCount = vector_bytes() >= 32 ? count_32 : count_16;
#else
const auto kCount = count_16;
#endif

}  // namespace

FineWords::FineWords(const PieceQuery& query, std::size_t word_count) {
  for (int point = 0; point < kPoints; ++point) {
    std::size_t n = 0;
    for (int other = 0; other < kPoints; ++other) {
      if (query.mask[other] == 0 || query.words[other] >= word_count || kFineCell[other] != kFineCell[point])
        continue;
      words_[n][point] = query.words[other];
      is_there_[n++][point] = 1;
    }
  }
}

std::uint32_t FineWords::intersection(const vision::WordMap& map) const {
  std::uint8_t row[Earlier::kFarthest + kPadded] = {};
  std::memcpy(row + Earlier::kFarthest, map.data(), map.size());
  return kCount(row + Earlier::kFarthest, words_[0].data(), is_there_[0].data());
}

}  // namespace freshet::query
