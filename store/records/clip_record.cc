#include "store/records/clip_record.h"

#include "freshet/error.h"

namespace freshet::store {
namespace {

// Takes values off the front of bytes; every length is compared with what is left.
class Cursor {
 public:
  explicit Cursor(ByteSpan bytes) : left_(bytes) {}
  template <class T>
  T take() {
    if (left_.size() < sizeof(T)) {
      good_ = false;
      return T{};
    }
    const T value = load<T>(left_.data());
    left_ = left_.subspan(sizeof(T));
    return value;
  }
  std::string take_string() {
    const auto size = take<std::uint32_t>();
    if (size > left_.size()) {
      good_ = false;
      return {};
    }
    std::string text(reinterpret_cast<const char*>(left_.data()), size);
    left_ = left_.subspan(size);
    return text;
  }
  bool good() const { return good_; }
  bool finished() const { return good_ && left_.empty(); }

 private:
  ByteSpan left_;
  bool good_ = true;
};

void append_string(Bytes& to, const std::string& text) {
  append(to, static_cast<std::uint32_t>(text.size()));
  const ByteSpan bytes = bytes_of(text);
  to.insert(to.end(), bytes.begin(), bytes.end());
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
  return bytes;
}

std::optional<StoredClip> parse_clip(ByteSpan bytes) {
  Cursor cursor(bytes);
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
  if (!cursor.finished()) return std::nullopt;
  return clip;
}

}  // namespace freshet::store
