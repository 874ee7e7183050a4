// synth/transfer/segments.h — where fluid ends and where it is whole.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "synth/transfer/pixel_grid.h"

namespace freshet::synth::transfer {

enum class Segment : std::uint8_t { kNone, kBoundary, kInterior };

/// Patch centres of a picture by segment: indices y * width + x, in the order in which they are searched.
struct Segments {
  GridOf<Segment> of;                    // kNone also where a patch would leave the picture
  std::array<std::vector<int>, 3> list;  // by segment; tiles of 32 px one after the other, rows within

  const std::vector<int>& operator[](Segment segment) const {
    return list[static_cast<std::size_t>(segment)];
  }
};
inline constexpr int kTile = 32;
/// Of the pixels' tiles, which one: equal within a tile.
inline int tile_of(int index, int width) {
  const int y = index / width, x = index - y * width;
  return (y / kTile) * ((width + kTile - 1) / kTile) + x / kTile;
}

/// Boundary where lower < blurred alpha < upper, interior from upper on (Sec. 4.2).
/// margin   how near to the picture's edge a patch's centre may be.
void segment(const Grid& blurred_alpha, double lower, double upper, int margin, Segments& out);

/// Makes the lists from `of`.
void list_segments(Segments& segments);

/// Sources and targets that are matched with each other.
struct Task {
  std::vector<int> sources, targets;  // places, in the order of Segments
};

/// Boundary with boundary, interior with interior; where the exemplar lacks one, everything with the other.
std::vector<Task> tasks_of(const Segments& source, const Segments& target);

}  // namespace freshet::synth::transfer
