// store/records/clip_record.h — a clip's record as bytes.
#pragma once

#include <array>

#include <optional>

#include "store/codec/tile_grid.h"
#include "store/records/account.h"

namespace freshet::store {

inline constexpr std::size_t kStreams = 3;
inline constexpr std::size_t kMaxClipRecordBytes = 64 << 20;

/// A clip as the store keeps it: the record, the grids of its streams, and what records it has.
struct StoredClip {
  ClipRecord record;
  std::array<TileGrid, kStreams> grids;
  std::array<RecordSum, kStreams> tiles;
  ArrayAccounts columns;
};

inline StreamShape& stream_shape(ClipRecord& record, std::size_t stream) {
  return stream == 0 ? record.frames : stream == 1 ? record.flow : record.average;
}

/// What the names of columns with a row a patch begin with.
inline constexpr std::string_view kPatchColumns = "patch.";
bool has_rows(const ArrayAccount& column, std::uint64_t rows);

Bytes serialise_clip(const StoredClip& clip);

/// Empty when the bytes are no clip record of this version, or when a patch column has not the clip's rows.
std::optional<StoredClip> parse_clip(ByteSpan bytes);

}  // namespace freshet::store
