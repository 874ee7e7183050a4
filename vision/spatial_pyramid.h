// vision/spatial_pyramid.h — histograms of visual words over a 3-level spatial pyramid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "vision/codebook.h"
#include "vision/dense_sift.h"

namespace freshet::vision {

/// The words of a patch's 9 x 9 grid, row-major: a whole spatial pyramid.
using WordMap = std::array<Word, kGridSide * kGridSide>;
/// For a target piece: 1 where a grid point lies in the fluid and counts.
using WordMask = std::array<std::uint8_t, kGridSide * kGridSide>;

inline constexpr int kPyramidCells = 1 + 4 + 16;
/// Weights of levels 0, 1, 2 as integers: Lazebnik et al. 2006 give 1/4, 1/4, 1/2.
inline constexpr std::array<int, 3> kLevelWeights{1, 1, 2};

/// The pyramid cells (one per level) of grid point (column, row), numbered 0..20: level 0 is 0, level 1
/// is 1..4, level 2 is 5..20.
std::array<int, 3> cells_of(int column, int row);

/// Weighted histogram intersection of two word maps, counted the slow and obvious way: 0..mass of a.
/// Source: Okabe et al. 2011, Eq. 1; Lazebnik, Schmid, Ponce 2006, Eq. 3.
int intersection(const WordMap& a, const WordMap& b, int word_count, const WordMask* mask_of_a = nullptr);

/// Bytes of a word where many are kept: 1 of a codebook of at most 256 words, so that a pyramid takes 81 bytes; else 2.
constexpr int word_bytes(int word_count) { return word_count <= 256 ? 1 : 2; }
constexpr std::size_t word_map_bytes(int word_bytes) {
  return std::size_t{kGridSide * kGridSide} * word_bytes;
}

/// Word maps that lie elsewhere, row by row, in words of one or of two bytes.
class WordMaps {
 public:
  WordMaps() = default;
  /// bytes   whole rows of word_map_bytes(word_bytes), aligned for words.
  WordMaps(std::span<const std::byte> bytes, int word_bytes) : bytes_(bytes), word_bytes_(word_bytes) {}

  std::size_t row_bytes() const { return word_map_bytes(word_bytes_); }
  std::size_t size() const { return bytes_.size() / row_bytes(); }
  WordMap operator[](std::size_t row) const;
  WordMaps subspan(std::size_t first, std::size_t count) const {
    return {bytes_.subspan(first * row_bytes(), count * row_bytes()), word_bytes_};
  }
  std::span<const std::byte> bytes() const { return bytes_; }
  int word_bytes() const { return word_bytes_; }
  /// Calls visit with all words, row after row: a span of std::uint8_t, or of std::uint16_t.
  template <class Visit>
  decltype(auto) visit(Visit&& visit) const {
    if (word_bytes_ == 1)
      return visit(std::span(reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size()));
    return visit(std::span(reinterpret_cast<const std::uint16_t*>(bytes_.data()), bytes_.size() / 2));
  }

 private:
  std::span<const std::byte> bytes_;
  int word_bytes_ = 1;
};

/// Word maps and the memory that they lie in; words are 0 to begin with.
class OwnWordMaps {
 public:
  OwnWordMaps() = default;
  explicit OwnWordMaps(int word_bytes, std::size_t rows = 0) : word_bytes_(word_bytes) { resize(rows); }
  OwnWordMaps(int word_bytes, std::vector<std::byte> bytes)
      : word_bytes_(word_bytes), bytes_(std::move(bytes)) {}

  std::size_t size() const { return WordMaps(*this).size(); }
  bool empty() const { return bytes_.empty(); }
  void resize(std::size_t rows) { bytes_.resize(rows * row_bytes()); }
  std::size_t row_bytes() const { return word_map_bytes(word_bytes_); }
  WordMap operator[](std::size_t row) const { return WordMaps(*this)[row]; }
  /// Words must fit into word_bytes.
  void set(std::size_t row, const WordMap& map);
  /// Rows of as many bytes, from row `first` on.
  void set(std::size_t first, WordMaps rows);
  std::span<std::byte> bytes() { return bytes_; }
  std::span<const std::byte> bytes() const { return bytes_; }
  operator WordMaps() const& { return {bytes_, word_bytes_}; }
  operator WordMaps() && = delete;
  bool operator==(const OwnWordMaps&) const = default;

 private:
  int word_bytes_ = 1;
  std::vector<std::byte> bytes_;
};
/// Some rows, in the order in which they are named.
OwnWordMaps rows_of(WordMaps maps, std::span<const std::uint32_t> rows);

}  // namespace freshet::vision
