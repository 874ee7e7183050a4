#include "stored/decoded_tiles.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace freshet::stored {
namespace {

/// A box of samples, one frame after another.
struct Box {
  store::Rect rect;
  std::uint32_t first = 0, count = 0;
};

store::Rect common(const store::Rect& a, const store::Rect& b) {
  const std::uint32_t x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  return {x, y, std::min(a.x + a.width, b.x + b.width) - x, std::min(a.y + a.height, b.y + b.height) - y};
}

/// What both have, from one into the other.
void copy_common(const Box& from, const std::byte* samples, const Box& to, std::size_t sample_bytes,
                 std::byte* out) {
  const store::Rect rect = common(from.rect, to.rect);
  const std::uint32_t begin = std::max(from.first, to.first),
                      end = std::min(from.first + from.count, to.first + to.count);
  const auto offset = [&](const Box& box, std::uint32_t frame, std::uint32_t y) {
    return ((std::size_t{frame - box.first} * box.rect.height + (y - box.rect.y)) * box.rect.width +
            (rect.x - box.rect.x)) *
           sample_bytes;
  };
  for (std::uint32_t frame = begin; frame < end; ++frame)
    for (std::uint32_t y = rect.y; y < rect.y + rect.height; ++y)
      std::memcpy(out + offset(to, frame, y), samples + offset(from, frame, y), rect.width * sample_bytes);
}

/// The whole tile with these numbers, as far as the plane goes.
Box tile_box(const store::StreamShape& stream, const store::PlaneShape& plane, std::uint32_t column,
             std::uint32_t row, std::uint32_t slab) {
  constexpr std::uint32_t kSide = DecodedTiles::kSide, kFrames = DecodedTiles::kFrames;
  return {{column * kSide, row * kSide, std::min(kSide, plane.width - column * kSide),
           std::min(kSide, plane.height - row * kSide)},
          slab * kFrames,
          std::min(kFrames, stream.frames - slab * kFrames)};
}

}  // namespace

DecodedTiles::DecodedTiles(store::Snapshot snapshot, std::size_t bytes)
    : snapshot_(std::move(snapshot)), most_(bytes) {}

std::size_t DecodedTiles::bytes() const {
  const std::lock_guard lock(guard_);
  return held_;
}

DecodedTiles::Samples DecodedTiles::find(const Key& key) {
  const std::lock_guard lock(guard_);
  const auto found = tiles_.find(key);
  if (found == tiles_.end()) return nullptr;
  used_.splice(used_.begin(), used_, found->second.used);
  return found->second.samples;
}

void DecodedTiles::keep(const Key& key, Samples samples) {
  const std::lock_guard lock(guard_);
  if (tiles_.contains(key)) return;  // another thread was quicker
  held_ += samples->size();
  used_.push_front(key);
  tiles_.emplace(key, Tile{std::move(samples), used_.begin()});
  while (held_ > most_ && !used_.empty()) {
    const auto oldest = tiles_.find(used_.back());
    held_ -= oldest->second.samples->size();
    tiles_.erase(oldest);
    used_.pop_back();
  }
}

void DecodedTiles::read(store::ClipId clip, store::Stream stream, std::uint32_t plane, store::Rect region,
                        std::uint32_t first, std::uint32_t count, std::span<std::byte> out) {
  const store::ClipRecord& record = snapshot_.clip(clip);
  const store::StreamShape& streamed = stream == store::Stream::kFlow ? record.flow : record.frames;
  const store::PlaneShape& shape = streamed.planes.at(plane);
  const Box wanted{region, first, count};
  for (std::uint32_t slab = first / kFrames; slab * kFrames < first + count; ++slab)
    for (std::uint32_t row = region.y / kSide; row * kSide < region.y + region.height; ++row)
      for (std::uint32_t column = region.x / kSide; column * kSide < region.x + region.width; ++column) {
        const Box box = tile_box(streamed, shape, column, row, slab);
        const Key key{clip, stream, plane, column, row, slab};
        Samples samples = find(key);
        if (!samples) {
          auto decoded = std::make_shared<std::vector<std::byte>>(
              std::size_t{box.rect.width} * box.rect.height * box.count * shape.bytes_per_sample);
          snapshot_.read(clip, stream, plane, box.rect, box.first, box.count, *decoded);
          samples = decoded;
          keep(key, samples);
        }
        copy_common(box, samples->data(), wanted, shape.bytes_per_sample, out.data());
      }
}

void read_samples(const store::Snapshot& snapshot, DecodedTiles* tiles, store::ClipId clip,
                  store::Stream stream, std::uint32_t plane, store::Rect region, std::uint32_t first,
                  std::uint32_t count, std::span<std::byte> out) {
  if (tiles != nullptr)
    tiles->read(clip, stream, plane, region, first, count, out);
  else
    snapshot.read(clip, stream, plane, region, first, count, out);
}

}  // namespace freshet::stored
