#include "store/codec/tile_grid.h"

#include <algorithm>

#include "freshet/error.h"

namespace freshet::store {
namespace {

std::uint32_t tiles_along(std::uint32_t samples, std::uint8_t edge_log2) {
  return (samples + (1u << edge_log2) - 1) >> edge_log2;
}

[[noreturn]] void throw_shape(const std::string& fault) {
  throw Error(ErrorKind::kUsage, "stream shape", fault,
              "Give planes of 1 to 65536 samples per edge, 1 or 2 bytes per sample");
}

}  // namespace

TileGrid::TileGrid(StreamShape shape, std::vector<std::uint8_t> tile_edge_log2)
    : shape_(std::move(shape)), edges_(std::move(tile_edge_log2)) {
  if (shape_.planes.size() > kMaxPlanes || edges_.size() != shape_.planes.size())
    throw_shape("number of planes");
  if (shape_.frames > kMaxFrames) throw_shape("more than 2^24 frames");
  std::uint64_t tiles = 0;
  first_of_plane_.push_back(0);
  for (std::size_t p = 0; p < edges_.size(); ++p) {
    const PlaneShape& plane = shape_.planes[p];
    if (edges_[p] < 4 || edges_[p] > 8) throw_shape("tile edge outside 16..256");
    if (plane.width == 0 || plane.height == 0 || plane.width > kMaxPlaneEdge ||
        plane.height > kMaxPlaneEdge) {
      throw_shape("plane of " + std::to_string(plane.width) + " x " + std::to_string(plane.height));
    }
    if (plane.bytes_per_sample != 1 && plane.bytes_per_sample != 2) throw_shape("bytes per sample");
    tiles += std::uint64_t{tiles_along(plane.width, edges_[p])} * tiles_along(plane.height, edges_[p]);
    if (tiles > UINT32_MAX) throw_shape("too many tiles");
    first_of_plane_.push_back(static_cast<std::uint32_t>(tiles));
  }
  if (tile_count() > UINT32_MAX) throw_shape("more than 2^32 tiles");
}

std::vector<std::uint8_t> TileGrid::default_edges(std::span<const PlaneShape> planes) {
  std::vector<std::uint8_t> edges;
  for (const PlaneShape& plane : planes) edges.push_back(2 * plane.width <= planes[0].width + 1 ? 5 : 6);
  return edges;
}

std::uint32_t TileGrid::columns(std::uint32_t plane) const {
  return tiles_along(shape_.planes[plane].width, edges_[plane]);
}

TileBox TileGrid::box(std::uint32_t tile) const {
  const std::uint32_t slab = tile / tiles_per_slab(), index = tile % tiles_per_slab();
  TileBox box;
  while (index >= first_of_plane_[box.plane + 1]) ++box.plane;
  const PlaneShape& plane = shape_.planes[box.plane];
  const std::uint32_t in_plane = index - first_of_plane_[box.plane], across = columns(box.plane);
  const std::uint32_t edge = 1u << edges_[box.plane];
  box.x = in_plane % across * edge;
  box.y = in_plane / across * edge;
  box.width = std::min(edge, plane.width - box.x);
  box.height = std::min(edge, plane.height - box.y);
  box.first_frame = slab * kSlabFrames;
  box.frames = std::min(kSlabFrames, shape_.frames - box.first_frame);
  box.bytes_per_sample = plane.bytes_per_sample;
  return box;
}

std::vector<std::uint32_t> TileGrid::touched(std::uint32_t plane, Rect region, std::uint32_t first,
                                             std::uint32_t count) const {
  std::vector<std::uint32_t> tiles;
  if (region.width == 0 || region.height == 0 || count == 0) return tiles;
  const std::uint32_t across = columns(plane);
  const std::uint8_t edge = edges_[plane];
  for (std::uint32_t slab = first / kSlabFrames; slab <= (first + count - 1) / kSlabFrames; ++slab) {
    for (std::uint32_t row = region.y >> edge; row <= (region.y + region.height - 1) >> edge; ++row) {
      for (std::uint32_t col = region.x >> edge; col <= (region.x + region.width - 1) >> edge; ++col) {
        tiles.push_back(slab * tiles_per_slab() + first_of_plane_[plane] + row * across + col);
      }
    }
  }
  return tiles;
}

}  // namespace freshet::store
