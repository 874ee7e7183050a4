#include "vision/spatial_pyramid.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

constexpr int kPoints = kGridSide * kGridSide;

constexpr std::array<std::array<std::uint8_t, 3>, kPoints> make_cells() {
  std::array<std::array<std::uint8_t, 3>, kPoints> cells{};
  for (int row = 0; row < kGridSide; ++row) {
    for (int column = 0; column < kGridSide; ++column) {
      auto& cell = cells[row * kGridSide + column];
      cell[0] = 0;
      cell[1] = static_cast<std::uint8_t>(1 + row * 2 / kGridSide * 2 + column * 2 / kGridSide);
      cell[2] = static_cast<std::uint8_t>(5 + row * 4 / kGridSide * 4 + column * 4 / kGridSide);
    }
  }
  return cells;
}
constexpr auto kCells = make_cells();

void check_word(int word, int word_count) {
  if (word >= word_count) {
    throw Error(
        ErrorKind::kDamaged, "word map",
        "visual word " + std::to_string(word) + " of a codebook of " + std::to_string(word_count) + " words");
  }
}

}  // namespace

std::array<int, 3> cells_of(int column, int row) {
  const auto& cell = kCells[row * kGridSide + column];
  return {cell[0], cell[1], cell[2]};
}

int intersection(const WordMap& a, const WordMap& b, int word_count, const WordMask* mask_of_a) {
  std::vector<int> counts_a(static_cast<std::size_t>(kPyramidCells) * word_count), counts_b(counts_a.size());
  for (int i = 0; i < kPoints; ++i) {
    check_word(a[i], word_count);
    check_word(b[i], word_count);
    for (int level = 0; level < 3; ++level) {
      const int cell = kCells[i][level];
      if (!mask_of_a || (*mask_of_a)[i]) counts_a[cell * word_count + a[i]] += kLevelWeights[level];
      counts_b[cell * word_count + b[i]] += kLevelWeights[level];
    }
  }
  int sum = 0;
  for (std::size_t bin = 0; bin < counts_a.size(); ++bin) sum += std::min(counts_a[bin], counts_b[bin]);
  return sum;
}

WordMap WordMaps::operator[](std::size_t row) const {
  return visit([&](auto words) {
    WordMap map;
    std::copy_n(words.begin() + static_cast<std::ptrdiff_t>(row * kPoints), kPoints, map.begin());
    return map;
  });
}

void OwnWordMaps::set(std::size_t row, const WordMap& map) {
  std::byte* const to = bytes_.data() + row * row_bytes();
  if (word_bytes_ == 1)
    std::transform(map.begin(), map.end(), to, [](Word word) { return static_cast<std::byte>(word); });
  else
    std::memcpy(to, map.data(), row_bytes());
}

void OwnWordMaps::set(std::size_t first, WordMaps rows) {
  std::ranges::copy(rows.bytes(), bytes_.begin() + static_cast<std::ptrdiff_t>(first * row_bytes()));
}

OwnWordMaps rows_of(WordMaps maps, std::span<const std::uint32_t> rows) {
  OwnWordMaps some(maps.word_bytes(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) some.set(i, maps.subspan(rows[i], 1));
  return some;
}

}  // namespace freshet::vision
