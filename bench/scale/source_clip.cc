#include "bench/scale/source_clip.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "ingest/clip_analysis.h"
#include "media/frame/frame.h"
#include "stored/clip_cells.h"
#include "stored/clip_frames.h"
#include "vision/flow.h"

namespace freshet::bench {
namespace {

constexpr std::uint32_t kSlab = 16, kMaxSlabs = 6;

/// One plane of the flow, frames [first, first + count), in flow units.
std::vector<std::int16_t> flow_plane(const store::Snapshot& snapshot, store::ClipId clip, std::uint32_t plane,
                                     std::uint32_t first, std::uint32_t count) {
  const store::PlaneShape& shape = snapshot.clip(clip).flow.planes.at(plane);
  const std::size_t pixels = std::size_t{shape.width} * shape.height;
  std::vector<std::int16_t> all(pixels * count);
  constexpr std::uint32_t kBand = 64;  // a tile's height, or two
  oneapi::tbb::parallel_for(0u, (shape.height + kBand - 1) / kBand, [&](std::uint32_t band) {
    const std::uint32_t top = band * kBand, rows = std::min(kBand, shape.height - top);
    const std::size_t some = std::size_t{shape.width} * rows;
    std::vector<std::int16_t> samples(some * count);
    snapshot.read(clip, store::Stream::kFlow, plane, {0, top, shape.width, rows}, first, count,
                  std::as_writable_bytes(std::span(samples)));
    for (std::uint32_t i = 0; i < count; ++i) {
      std::copy_n(samples.begin() + static_cast<std::ptrdiff_t>(i * some), some,
                  all.begin() + static_cast<std::ptrdiff_t>(i * pixels + std::size_t{top} * shape.width));
    }
  });
  return all;
}

/// First frames of the slabs to measure on: all of them, or the maximum that may be, evenly spread.
std::vector<std::uint32_t> spread_slabs(std::uint32_t frames) {
  const std::uint32_t slabs = std::max(1u, (frames + kSlab - 1) / kSlab), taken = std::min(slabs, kMaxSlabs);
  std::vector<std::uint32_t> firsts;
  for (std::uint32_t i = 0; i < taken; ++i) firsts.push_back(i * slabs / taken * kSlab);
  return firsts;
}

cv::Mat what_moves(const store::Snapshot& snapshot, const vision::Settings& settings, store::ClipId clip) {
  const store::ClipRecord& record = snapshot.clip(clip);
  const stored::ClipFrames frames(snapshot, clip);
  ingest::LumaStatistics statistics(
      cv::Size(static_cast<int>(record.width), static_cast<int>(record.height)));
  for (const std::uint32_t first : spread_slabs(record.frame_count)) {
    for (const media::Frame& frame : frames.read(first, std::min(kSlab, record.frame_count - first)))
      statistics.add(media::to_luma(frame));
  }

  const store::PlaneShape& shape = record.flow.planes.at(0);
  cv::Mat speed = cv::Mat::zeros(static_cast<int>(shape.height), static_cast<int>(shape.width), CV_32F);
  const std::size_t pixels = speed.total();
  std::uint32_t flows = 0;
  for (const std::uint32_t first : spread_slabs(record.flow.frames)) {
    const std::uint32_t count = std::min(kSlab, record.flow.frames - first);
    const auto u = flow_plane(snapshot, clip, 0, first, count),
               v = flow_plane(snapshot, clip, 1, first, count);
    auto* sum = speed.ptr<float>();
    for (std::size_t i = 0; i < pixels * count; ++i) {
      const auto fu = static_cast<float>(u[i]), fv = static_cast<float>(v[i]);
      sum[i % pixels] += std::sqrt(fu * fu + fv * fv);
    }
    flows += count;
  }
  speed *= vision::kFlowUnit / static_cast<float>(std::max(1u, flows));
  const double fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den);
  return ingest::moving_mask(speed, statistics.deviation(), fps, settings);
}

}  // namespace

SourceClip read_source_clip(const store::Snapshot& snapshot, const vision::Settings& settings,
                            store::ClipId clip, int frames) {
  SourceClip source;
  source.record = snapshot.clip(clip);
  source.metadata = stored::metadata_of(snapshot, clip);
  const store::ClipRecord& record = source.record;
  source.average = cv::Mat(static_cast<int>(record.height), static_cast<int>(record.width), CV_16U);
  snapshot.read(
      clip, store::Stream::kAverage, 0, {0, 0, record.width, record.height}, 0, 1,
      std::as_writable_bytes(std::span(source.average.ptr<std::uint16_t>(), source.average.total())));
  source.moving = what_moves(snapshot, settings, clip);
  source.motion = stored::motion_cells(snapshot, settings, clip);
  for (std::size_t scale = 0; scale < settings.scales.size(); ++scale)
    source.texture.push_back(stored::texture_cells(snapshot, settings, clip, scale));

  const std::uint32_t kept = std::min(static_cast<std::uint32_t>(frames), record.frame_count);
  const stored::ClipFrames stored(snapshot, clip);
  for (const media::Frame& frame : stored.read(0, kept)) source.frames.push_back(media::to_luma(frame));
  const std::uint32_t flows = std::min(kept - 1, record.flow.frames);
  const auto u = flow_plane(snapshot, clip, 0, 0, flows), v = flow_plane(snapshot, clip, 1, 0, flows);
  const store::PlaneShape& shape = record.flow.planes.at(0);
  for (std::uint32_t i = 0; i < flows; ++i) {
    cv::Mat flow(static_cast<int>(shape.height), static_cast<int>(shape.width), CV_32FC2);
    const std::size_t first = i * flow.total();
    auto* to = flow.ptr<cv::Vec2f>();
    for (std::size_t at = 0; at < flow.total(); ++at)
      to[at] = {u[first + at] * vision::kFlowUnit, v[first + at] * vision::kFlowUnit};
    source.flow.push_back(flow);
  }
  return source;
}

}  // namespace freshet::bench
