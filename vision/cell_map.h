// vision/cell_map.h — measurements of a clip in square cells of its frame.
#pragma once

#include <span>
#include <vector>

namespace freshet::vision {

/// A map of cells over a clip's source frame: rows * columns records of `channels` floats.
struct CellMap {
  int rows = 0, columns = 0, channels = 0;
  float cell = 4;             // source px, side of a cell
  std::vector<float> values;  // row-major, channel fastest
  std::span<const float> at(int row, int column) const {
    return {values.data() + (static_cast<std::size_t>(row) * columns + column) * channels,
            static_cast<std::size_t>(channels)};
  }
};

}  // namespace freshet::vision
