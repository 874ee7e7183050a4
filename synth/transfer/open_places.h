// synth/transfer/open_places.h — a set of places in a picture, from which one near a point can be drawn.
#pragma once

#include <cstdint>
#include <vector>

#include "synth/field/grid.h"

namespace freshet::synth::transfer {

/// Which patches may still be chosen. Counts by squares of 2, 4, 8 ... px find one near any point in a few
/// steps, however few are left. Reading is safe from many threads.
class OpenPlaces {
 public:
  OpenPlaces(int width, int height, const std::vector<int>& places);

  bool has(int place) const { return open_[static_cast<std::size_t>(place)] != 0; }
  int count() const { return count_; }
  /// One that is not open.
  void add(int place);
  /// One that is.
  void remove(int place);

  /// A place in the smallest of the squares around (x, y) that has one; random draws which. -1 if none is
  /// left. x and y are clamped to the picture.
  int near(int x, int y, std::uint64_t random) const;

 private:
  void change(int place, int by);

  int width_, height_, count_;
  std::vector<std::uint8_t> open_;             // by place
  std::vector<GridOf<std::int32_t>> squares_;  // [k]: of 2 << k px per side; the last one is one
};

}  // namespace freshet::synth::transfer
