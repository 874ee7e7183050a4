// store/codec/tile_grid.h — where a stream's tiles lie: numbers and sizes, no bytes.
//
// Frames come in slabs of kSlabFrames. A slab's tiles are counted plane by plane, row by row, left to right,
// and slab after slab: tile number = slab * tiles_per_slab + index in the slab.
#pragma once

#include "store/format/format.h"

namespace freshet::store {

/// A tile's place in its plane and what it holds; border tiles are smaller.
struct TileBox {
  std::uint32_t plane = 0;
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  // samples
  std::uint32_t first_frame = 0, frames = 0;
  std::uint8_t bytes_per_sample = 1;
  std::size_t samples() const { return std::size_t{width} * height * frames; }
  std::size_t bytes() const { return samples() * bytes_per_sample; }
};

/// The tiles of one stream.
class TileGrid {
 public:
  TileGrid() = default;
  /// tile_edge_log2   of each plane, 4..8. Throws Error{kUsage} for shapes outside the format's limits.
  TileGrid(StreamShape shape, std::vector<std::uint8_t> tile_edge_log2);

  /// The edge the writer chooses: 64 samples, and 32 in planes of at most half the first one's width, so that
  /// tiles of one number cover the same part of the picture.
  static std::vector<std::uint8_t> default_edges(std::span<const PlaneShape> planes);

  const StreamShape& shape() const { return shape_; }
  const std::vector<std::uint8_t>& edges_log2() const { return edges_; }
  std::uint32_t tiles_per_slab() const { return first_of_plane_.empty() ? 0 : first_of_plane_.back(); }
  std::uint32_t slabs() const { return (shape_.frames + kSlabFrames - 1) / kSlabFrames; }
  std::uint64_t tile_count() const { return std::uint64_t{slabs()} * tiles_per_slab(); }

  TileBox box(std::uint32_t tile) const;

  /// The tiles that a region of one plane in frames [first, first + count) touches, ascending.
  std::vector<std::uint32_t> touched(std::uint32_t plane, Rect region, std::uint32_t first,
                                     std::uint32_t count) const;

 private:
  std::uint32_t columns(std::uint32_t plane) const;

  StreamShape shape_;
  std::vector<std::uint8_t> edges_;
  std::vector<std::uint32_t> first_of_plane_;  // in a slab; one more entry than planes
};

}  // namespace freshet::store
