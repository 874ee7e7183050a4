#include "stored/clip_region.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "media/frame/frame_part.h"

namespace freshet::stored {
namespace {

constexpr int kMargin =
    8;  // px that chroma between samples may reach for, and what rectangles are aligned to

cv::Rect with_margin(cv::Rect region, cv::Size frame) {
  const int left = std::max(0, region.x - kMargin) / kMargin * kMargin;
  const int top = std::max(0, region.y - kMargin) / kMargin * kMargin;
  const auto end = [](int side, int last) {
    return std::min(side, (last + 2 * kMargin - 1) / kMargin * kMargin);
  };
  return {left, top, end(frame.width, region.br().x) - left, end(frame.height, region.br().y) - top};
}

/// Whether a sample of chroma covers whole pixels everywhere. Else swscale spreads it a little wider over the whole
/// frame
/// (76 samples over 151 px), which no part of it repeats.
bool chroma_is_even(const media::PixelLayout& layout) {
  const auto fit = [](int pixels, int samples) { return pixels % samples == 0 || samples % pixels == 0; };
  const std::vector<media::Plane> planes = media::plane_shapes(layout);
  return std::all_of(planes.begin(), planes.end(), [&](const media::Plane& plane) {
    return fit(layout.width, plane.width) && fit(layout.height, plane.height);
  });
}

/// Samples of a plane before column x and row y of the frame: what a picture of that size has.
cv::Point samples_before(const media::PixelLayout& layout, std::size_t plane, cv::Point corner) {
  media::PixelLayout part = layout;
  part.width = std::max(1, corner.x);
  part.height = std::max(1, corner.y);
  const media::Plane shape = media::plane_shapes(part)[plane];
  return {corner.x == 0 ? 0 : shape.width, corner.y == 0 ? 0 : shape.height};
}

}  // namespace

std::vector<cv::Mat> read_region(const store::Snapshot& snapshot, store::ClipId clip,
                                 const media::PixelLayout& layout, cv::Rect region, std::uint32_t first,
                                 std::uint32_t count, Shown shown) {
  const bool luma = shown == Shown::kLuma && media::luma_in_plane_0(layout);
  const cv::Size frame_size(layout.width, layout.height);
  // Luminance that is made of colours knows other weights for untagged ones: the whole frame says which.
  const bool whole = !luma && (shown == Shown::kLuma || !chroma_is_even(layout));
  const cv::Rect read = luma ? region : whole ? cv::Rect({}, frame_size) : with_margin(region, frame_size);
  const media::PixelLayout part =
      read.size() == frame_size ? layout : media::layout_of_part(layout, read.size());
  std::vector<media::Frame> frames;
  for (std::uint32_t i = 0; i < count; ++i) frames.push_back(media::make_frame(part));

  const std::size_t planes = luma ? 1 : frames.empty() ? 0 : frames[0].planes.size();
  std::vector<std::byte> samples;
  for (std::size_t p = 0; p < planes; ++p) {
    const media::Plane& shape = frames[0].planes[p];
    const cv::Point corner = samples_before(layout, p, read.tl());
    const std::size_t row_bytes = static_cast<std::size_t>(shape.width) * shape.bytes_per_sample;
    samples.resize(row_bytes * static_cast<std::size_t>(shape.height) * count);
    snapshot.read(clip, store::Stream::kFrames, static_cast<std::uint32_t>(p),
                  {static_cast<std::uint32_t>(corner.x), static_cast<std::uint32_t>(corner.y),
                   static_cast<std::uint32_t>(shape.width), static_cast<std::uint32_t>(shape.height)},
                  first, count, samples);
    const std::byte* from = samples.data();
    for (const media::Frame& frame : frames)
      for (int row = 0; row < shape.height; ++row, from += row_bytes)
        std::memcpy(frame.planes[p].data + row * frame.planes[p].stride, from, row_bytes);
  }
  std::vector<cv::Mat> pictures;
  for (const media::Frame& frame : frames)
    pictures.push_back((shown == Shown::kLuma ? media::to_luma(frame) : media::to_bgr(frame))(
        cv::Rect(region.tl() - read.tl(), region.size())));
  return pictures;
}

}  // namespace freshet::stored
