#include "stored/clip_frames.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <oneapi/tbb/parallel_for.h>

#include "freshet/error.h"
#include "stored/clip_metadata.h"
#include "stored/clip_schema.h"

namespace freshet::stored {
namespace {

media::PixelLayout layout_of(const store::Snapshot& snapshot, store::ClipId clip) {
  const ClipMetadata metadata = metadata_of(snapshot, clip);
  if (!metadata.layout)
    throw Error(ErrorKind::kDamaged, snapshot.clip(clip).name, "its metadata hold no pixel layout",
                "Run freshet store verify");
  return *metadata.layout;
}

}  // namespace

ClipFrames::ClipFrames(const store::Snapshot& snapshot, store::ClipId clip)
    : snapshot_(snapshot), clip_(clip), layout_(layout_of(snapshot, clip)) {
  const store::ClipRecord& record = snapshot_.clip(clip_);
  const std::vector<media::Plane> planes = media::plane_shapes(layout_);
  bool same = planes.size() == record.frames.planes.size() &&
              static_cast<std::uint32_t>(layout_.width) == record.width &&
              static_cast<std::uint32_t>(layout_.height) == record.height;
  for (std::size_t p = 0; same && p < planes.size(); ++p) {
    const store::PlaneShape& shape = record.frames.planes[p];
    same = static_cast<std::uint32_t>(planes[p].width) == shape.width &&
           static_cast<std::uint32_t>(planes[p].height) == shape.height &&
           planes[p].bytes_per_sample == shape.bytes_per_sample;
  }
  if (!same)
    throw Error(ErrorKind::kDamaged, record.name,
                "its planes are not those of the pixel format " + layout_.format, "Run freshet store verify");
  times_ = kFrameTime.read(snapshot_, clip_);
  if (times_.size() != record.frame_count)
    throw Error(ErrorKind::kDamaged, record.name, "its frame times do not match its frames",
                "Run freshet store verify");
  if (!std::all_of(times_.begin(), times_.end(), [](double time) { return std::isfinite(time); }) ||
      !std::is_sorted(times_.begin(), times_.end()))
    throw Error(ErrorKind::kDamaged, record.name, "its frame times are no times in their order",
                "Run freshet store verify");
}

std::uint32_t ClipFrames::size() const { return snapshot_.clip(clip_).frame_count; }

media::Frame ClipFrames::read(std::uint32_t frame) const { return std::move(read(frame, 1).front()); }

std::vector<media::Frame> ClipFrames::read(std::uint32_t first, std::uint32_t count) const {
  std::vector<media::Frame> frames;
  for (std::uint32_t i = 0; i < count; ++i) {
    frames.push_back(media::make_frame(layout_));
    frames.back().time_s = times_[first + i];
  }
  read_planes(snapshot_.clip(clip_).frames.planes.size(), first, frames);
  return frames;
}

std::vector<cv::Mat> ClipFrames::read_luma(std::uint32_t first, std::uint32_t count) const {
  std::vector<media::Frame> frames;
  for (std::uint32_t i = 0; i < count; ++i) frames.push_back(media::make_frame(layout_));
  read_planes(media::luma_in_plane_0(layout_) ? 1 : snapshot_.clip(clip_).frames.planes.size(), first,
              frames);
  std::vector<cv::Mat> lumas(count);
  oneapi::tbb::parallel_for(0u, count, [&](std::uint32_t i) { lumas[i] = media::to_luma(frames[i]); });
  return lumas;
}

void ClipFrames::read_planes(std::size_t planes, std::uint32_t first,
                             std::vector<media::Frame>& frames) const {
  const store::ClipRecord& record = snapshot_.clip(clip_);
  const auto count = static_cast<std::uint32_t>(frames.size());
  // Bands of a tile's height: each is decoded once, by one thread.
  constexpr std::uint32_t kBand = 64;
  for (std::size_t p = 0; p < planes; ++p) {
    const store::PlaneShape& shape = record.frames.planes[p];
    const std::size_t row_bytes = static_cast<std::size_t>(shape.width) * shape.bytes_per_sample;
    oneapi::tbb::parallel_for(0u, (shape.height + kBand - 1) / kBand, [&](std::uint32_t band) {
      const std::uint32_t top = band * kBand, rows = std::min(kBand, shape.height - top);
      std::vector<std::byte> samples(row_bytes * rows * count);
      snapshot_.read(clip_, store::Stream::kFrames, static_cast<std::uint32_t>(p),
                     {0, top, shape.width, rows}, first, count, samples);
      for (std::uint32_t i = 0; i < count; ++i)
        for (std::uint32_t row = 0; row < rows; ++row)
          std::memcpy(
              frames[i].planes[p].data + static_cast<std::ptrdiff_t>(top + row) * frames[i].planes[p].stride,
              samples.data() + (static_cast<std::size_t>(i) * rows + row) * row_bytes, row_bytes);
    });
  }
}

}  // namespace freshet::stored
