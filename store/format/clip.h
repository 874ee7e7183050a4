// store/format/clip.h — what a store says of a clip: its number, its streams, its record.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace freshet::store {

/// A clip's number in one store, in the order in which clips were committed. Never reused.
enum class ClipId : std::uint32_t {};

/// What of a clip a tile belongs to. Each stream is a sequence of frames of the same planes.
enum class Stream : std::uint8_t {
  kFrames = 0,   // planes exactly as the decoder gave them
  kFlow = 1,     // u, v as 16-bit signed fixed point
  kAverage = 2,  // one frame: the average image
};

/// One plane of a stream. Samples of 1 or 2 bytes, little endian.
struct PlaneShape {
  std::uint32_t width = 0, height = 0;  // samples
  std::uint8_t bytes_per_sample = 1;
  bool operator==(const PlaneShape&) const = default;
};

struct StreamShape {
  std::vector<PlaneShape> planes;  // empty: the clip has no such stream
  std::uint32_t frames = 0;
  bool operator==(const StreamShape&) const = default;
};

/// What is known of a clip without reading its tiles.
struct ClipRecord {
  std::string name;  // path relative to the folder given at ingest, '/' between parts; unique in a store
  std::string class_name;               // water, fire, ...
  std::string licence;                  // free text, may be empty
  std::string source_hash;              // 32 hex digits: XXH3-128 of the source's bytes; unique in a store
  std::string pixel_format;             // FFmpeg's name of the frames' layout, e.g. "yuv420p"
  std::uint32_t width = 0, height = 0;  // px, of the frames as stored
  std::uint32_t frame_count = 0;
  std::int64_t fps_num = 0, fps_den = 1;  // average frames per second
  std::string metadata;  // JSON: colour tags, rotation, screening report, ...; opaque to the store
  StreamShape frames, flow, average;
  std::uint64_t rows = 0;  // length of the clip's patch columns
};

struct Rect {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  // samples
};

/// One plane of one frame in memory, borrowed.
struct PlaneView {
  const std::byte* data = nullptr;
  std::ptrdiff_t stride = 0;  // bytes from a row to the next
};

}  // namespace freshet::store
