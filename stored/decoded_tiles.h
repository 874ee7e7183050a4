// stored/decoded_tiles.h — samples of clips that were decoded for an earlier animation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <tuple>
#include <vector>

#include "store/store.h"

namespace freshet::stored {

/// Keeps what it has read of one snapshot, tile by tile, up to so many bytes; what was used longest ago goes first. Who
/// draws changes a line, and most patches stay: half a preview's time was decoding them again. Safe from many threads.
class DecodedTiles {
 public:
  static constexpr std::uint32_t kSide = 64;    // samples, of the store's tiles
  static constexpr std::uint32_t kFrames = 16;  // of theirs too

  DecodedTiles(store::Snapshot snapshot, std::size_t bytes);

  /// As Snapshot::read.
  void read(store::ClipId clip, store::Stream stream, std::uint32_t plane, store::Rect region,
            std::uint32_t first, std::uint32_t count, std::span<std::byte> out);
  std::size_t bytes() const;

 private:
  using Key =
      std::tuple<store::ClipId, store::Stream, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;
  using Samples = std::shared_ptr<const std::vector<std::byte>>;
  struct Tile {
    Samples samples;
    std::list<Key>::iterator used;
  };
  Samples find(const Key& key);
  void keep(const Key& key, Samples samples);

  store::Snapshot snapshot_;
  std::size_t most_ = 0, held_ = 0;  // bytes
  mutable std::mutex guard_;
  std::map<Key, Tile> tiles_;
  std::list<Key> used_;  // the latest first
};

/// Through `tiles`, or without any straight from the snapshot.
void read_samples(const store::Snapshot& snapshot, DecodedTiles* tiles, store::ClipId clip,
                  store::Stream stream, std::uint32_t plane, store::Rect region, std::uint32_t first,
                  std::uint32_t count, std::span<std::byte> out);

}  // namespace freshet::stored
