// tests/store/clip_samples.h — clips made from a seed, and a store in a folder of its own.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "freshet/error.h"
#include "store/store.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::store {

using Samples = std::vector<std::byte>;

/// One plane of a clip over time: drifting waves, noise, and a part that stands still.
inline Samples moving_plane(const PlaneShape& shape, std::uint32_t frames, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const double amplitude = shape.bytes_per_sample == 1 ? 100.0 : 3000.0;
  const int noise = static_cast<int>(random() % 12);
  Samples samples;
  samples.reserve(std::size_t{shape.width} * shape.height * frames * shape.bytes_per_sample);
  for (std::uint32_t f = 0; f < frames; ++f) {
    for (std::uint32_t y = 0; y < shape.height; ++y) {
      for (std::uint32_t x = 0; x < shape.width; ++x) {
        const double time = x < shape.width / 3 ? 0.0 : f;
        double value = amplitude * std::sin(0.11 * x + 0.07 * y + 0.3 * time);
        if (noise > 0 && time > 0) value += static_cast<double>(random() % static_cast<unsigned>(noise));
        // Two-byte samples are signed, as flow is.
        const auto whole = static_cast<std::int32_t>(value) + (shape.bytes_per_sample == 1 ? 128 : 0);
        samples.push_back(static_cast<std::byte>(whole));
        if (shape.bytes_per_sample == 2) samples.push_back(static_cast<std::byte>(whole >> 8));
      }
    }
  }
  return samples;
}

/// A whole clip: planes of frames and of flow, and columns.
struct TestClip {
  std::string name = "water/a.mp4";
  std::vector<PlaneShape> planes = {{70, 50, 1}, {35, 25, 1}, {35, 25, 1}};
  std::uint32_t frames = 20;
  std::uint64_t seed = 1;
  std::size_t rows = 10;

  Samples plane(std::size_t p) const { return moving_plane(planes[p], frames, seed * 100 + p); }
  PlaneShape flow_shape() const { return {planes[0].width, planes[0].height, 2}; }
  Samples flow(std::size_t p) const { return moving_plane(flow_shape(), frames - 1, seed * 100 + 50 + p); }
  std::vector<float> column() const {
    std::vector<float> values(rows);
    for (std::size_t i = 0; i < rows; ++i)
      values[i] = static_cast<float>(seed) + 0.25f * static_cast<float>(i);
    return values;
  }
  ClipRecord record() const {
    ClipRecord record;
    record.name = name;
    record.class_name = "water";
    record.source_hash = "hash of " + name;
    record.pixel_format = "yuv420p";
    record.width = planes[0].width;
    record.height = planes[0].height;
    record.fps_num = 25;
    record.metadata = "{}";
    return record;
  }
};

/// Appends frames [first, first + count) of planes that were made whole.
inline void append_planes(ClipWriter& writer, Stream stream, std::span<const PlaneShape> shapes,
                          std::span<const Samples> samples, std::uint32_t first, std::uint32_t count) {
  std::vector<PlaneView> views;
  for (std::uint32_t f = first; f < first + count; ++f) {
    for (std::size_t p = 0; p < shapes.size(); ++p) {
      const std::size_t row = std::size_t{shapes[p].width} * shapes[p].bytes_per_sample;
      views.push_back({samples[p].data() + f * row * shapes[p].height, static_cast<std::ptrdiff_t>(row)});
    }
  }
  writer.append(stream, views);
}

/// Everything but the commit.
inline ClipWriter write_clip(Store& store, const TestClip& clip) {
  ClipWriter writer = store.add_clip();
  std::vector<Samples> planes, flow{clip.flow(0), clip.flow(1)};
  for (std::size_t p = 0; p < clip.planes.size(); ++p) planes.push_back(clip.plane(p));
  const std::vector<PlaneShape> flow_shapes(2, clip.flow_shape());
  writer.begin_stream(Stream::kFrames, clip.planes);
  writer.begin_stream(Stream::kFlow, flow_shapes);
  for (std::uint32_t f = 0; f < clip.frames; f += 7) {
    append_planes(writer, Stream::kFrames, clip.planes, planes, f, std::min(7u, clip.frames - f));
  }
  if (clip.frames > 1) append_planes(writer, Stream::kFlow, flow_shapes, flow, 0, clip.frames - 1);
  const std::vector<float> values = clip.column();
  writer.column<float>("patch.mean_u", values);
  return writer;
}

inline ClipId add_clip(Store& store, const TestClip& clip) {
  return write_clip(store, clip).commit(clip.record());
}

inline Samples read_plane(const Snapshot& snapshot, ClipId id, Stream stream, std::uint32_t plane) {
  const ClipRecord& record = snapshot.clip(id);
  const StreamShape& shape = stream == Stream::kFrames ? record.frames : record.flow;
  const PlaneShape& size = shape.planes[plane];
  Samples out(std::size_t{size.width} * size.height * size.bytes_per_sample * shape.frames);
  snapshot.read(id, stream, plane, {0, 0, size.width, size.height}, 0, shape.frames, out);
  return out;
}

/// True when all of the clip reads back as it was made.
inline bool reads_back(const Snapshot& snapshot, ClipId id, const TestClip& clip) {
  for (std::uint32_t p = 0; p < clip.planes.size(); ++p) {
    if (read_plane(snapshot, id, Stream::kFrames, p) != clip.plane(p)) return false;
  }
  for (std::uint32_t p = 0; p < 2 && clip.frames > 1; ++p) {
    if (read_plane(snapshot, id, Stream::kFlow, p) != clip.flow(p)) return false;
  }
  return snapshot.column<float>(id, "patch.mean_u") == clip.column();
}

}  // namespace freshet::store
