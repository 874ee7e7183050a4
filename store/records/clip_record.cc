#include "store/records/clip_record.h"

#include "freshet/error.h"
#include "store/records/byte_cursor.h"

namespace freshet::store {

bool has_rows(const ArrayAccount& column, std::uint64_t rows) {
  return column.bytes % column.element_bytes == 0 && column.bytes / column.element_bytes == rows;
}

namespace {

// Readers allocate for the clip's rows what its columns are then read into.
bool rows_are_those_of_columns(const StoredClip& clip) {
  bool any = false;
  for (const auto& [name, column] : clip.columns) {
    if (!name.starts_with(kPatchColumns)) continue;
    any = true;
    if (!has_rows(column, clip.record.rows)) return false;
  }
  return any || clip.record.rows == 0;
}

}  // namespace

Bytes serialise_clip(const StoredClip& clip) {
  const ClipRecord& record = clip.record;
  Bytes bytes;
  for (const std::string* text : {&record.name, &record.class_name, &record.licence, &record.source_hash,
                                  &record.pixel_format, &record.metadata}) {
    append_string(bytes, *text);
  }
  append(bytes, record.width);
  append(bytes, record.height);
  append(bytes, record.frame_count);
  append(bytes, record.fps_num);
  append(bytes, record.fps_den);
  append(bytes, record.rows);
  for (const TileGrid& grid : clip.grids) {
    append(bytes, grid.shape().frames);
    append(bytes, static_cast<std::uint8_t>(grid.shape().planes.size()));
    for (std::size_t p = 0; p < grid.shape().planes.size(); ++p) {
      const PlaneShape& plane = grid.shape().planes[p];
      append(bytes, plane.width);
      append(bytes, plane.height);
      append(bytes, plane.bytes_per_sample);
      append(bytes, grid.edges_log2()[p]);
    }
  }
  for (const RecordSum& sum : clip.tiles) append_sum(bytes, sum);
  append_arrays(bytes, clip.columns);
  return bytes;
}

std::optional<StoredClip> parse_clip(ByteSpan bytes) {
  ByteCursor cursor(bytes);
  StoredClip clip;
  ClipRecord& record = clip.record;
  for (std::string* text : {&record.name, &record.class_name, &record.licence, &record.source_hash,
                            &record.pixel_format, &record.metadata}) {
    *text = cursor.take_string();
  }
  record.width = cursor.take<std::uint32_t>();
  record.height = cursor.take<std::uint32_t>();
  record.frame_count = cursor.take<std::uint32_t>();
  record.fps_num = cursor.take<std::int64_t>();
  record.fps_den = cursor.take<std::int64_t>();
  record.rows = cursor.take<std::uint64_t>();
  for (std::size_t s = 0; s < kStreams; ++s) {
    StreamShape shape;
    shape.frames = cursor.take<std::uint32_t>();
    const auto planes = cursor.take<std::uint8_t>();
    std::vector<std::uint8_t> edges;
    for (std::uint8_t p = 0; p < planes && cursor.good(); ++p) {
      PlaneShape plane;
      plane.width = cursor.take<std::uint32_t>();
      plane.height = cursor.take<std::uint32_t>();
      plane.bytes_per_sample = cursor.take<std::uint8_t>();
      shape.planes.push_back(plane);
      edges.push_back(cursor.take<std::uint8_t>());
    }
    if (!cursor.good()) return std::nullopt;
    try {
      clip.grids[s] = TileGrid(shape, edges);
    } catch (const Error&) {
      return std::nullopt;
    }
    stream_shape(record, s) = std::move(shape);
  }
  for (RecordSum& sum : clip.tiles) sum = take_sum(cursor);
  clip.columns = take_arrays(cursor, kMaxColumnName);
  if (!cursor.finished() || !rows_are_those_of_columns(clip)) return std::nullopt;
  return clip;
}

}  // namespace freshet::store
