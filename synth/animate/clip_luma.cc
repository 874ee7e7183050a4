#include "synth/animate/clip_luma.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet_error.h"
#include "query/clip_frames.h"

namespace freshet::synth {
namespace {

constexpr int kBlock = 64;  // px: the store's tiles

/// The frame of `times` nearest to each output time.
std::vector<std::uint32_t> nearest_frames(std::span<const double> times, int frames, double fps) {
  std::vector<std::uint32_t> shown(frames);
  std::size_t at = 0;
  for (int i = 0; i < frames; ++i) {
    const double t = times[0] + i / fps;
    while (at + 1 < times.size() && std::abs(times[at + 1] - t) <= std::abs(times[at] - t)) ++at;
    shown[i] = static_cast<std::uint32_t>(at);
  }
  return shown;
}

}  // namespace

std::vector<std::uint32_t> frames_shown(const store::Snapshot& snapshot, store::ClipId clip, int frames,
                                        double fps) {
  const store::ClipRecord& record = snapshot.clip(clip);
  std::vector<double> times = snapshot.column<double>(clip, "frame.time");
  if (times.size() != record.frame_count || times.empty())
    throw Error(ErrorKind::kDamaged, record.name, "its frame times do not match its frames",
                "Run freshet store verify");
  const double interval = static_cast<double>(record.fps_den) / static_cast<double>(record.fps_num);
  // Half a frame of either side is as near as a nearest frame can be.
  if ((frames - 1) / fps > times.back() - times.front() + interval)
    throw Error(ErrorKind::kInput, record.name,
                "the clip lasts " + std::to_string(times.back() - times.front() + interval) +
                    " s, the animation " + std::to_string(frames / fps) + " s",
                "Ask for fewer frames, or label again for this duration");
  return nearest_frames(times, frames, fps);
}

ClipLuma::ClipLuma(const store::Snapshot& snapshot, store::ClipId clip, std::span<const cv::Rect> needed,
                   std::span<const std::uint32_t> shown) {
  const store::ClipRecord& record = snapshot.clip(clip);
  const query::ClipFrames clip_frames(snapshot, clip);  // checks that layout, planes and size agree
  layout_ = clip_frames.layout();
  raw_ = media::luma_in_plane_0(layout_);
  const cv::Size size(static_cast<int>(record.width), static_cast<int>(record.height));

  // Distinct clip frames, each kept once.
  std::vector<std::uint32_t> distinct(shown.begin(), shown.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  for (std::uint32_t frame : shown)
    frame_of_output_.push_back(std::lower_bound(distinct.begin(), distinct.end(), frame) - distinct.begin());

  // Blocks that some patch touches.
  const int block_columns = (size.width + kBlock - 1) / kBlock,
            block_rows = (size.height + kBlock - 1) / kBlock;
  cv::Mat touched = cv::Mat::zeros(block_rows, block_columns, CV_8U);
  for (const cv::Rect& rect : needed) {
    const cv::Rect inside = rect & cv::Rect({}, size);
    if (inside.empty()) continue;
    touched(cv::Rect(cv::Point(inside.x / kBlock, inside.y / kBlock),
                     cv::Point((inside.br().x - 1) / kBlock + 1, (inside.br().y - 1) / kBlock + 1)))
        .setTo(1);
  }
  std::vector<cv::Rect> blocks;
  for (int row = 0; row < block_rows; ++row)
    for (int column = 0; column < block_columns; ++column)
      if (touched.at<std::uint8_t>(row, column))
        blocks.push_back(cv::Rect(column * kBlock, row * kBlock, kBlock, kBlock) & cv::Rect({}, size));
  wanted_ = cv::Mat::zeros(size, CV_8U);
  for (const cv::Rect& block : blocks) wanted_(block).setTo(255);

  const std::uint32_t first = distinct.front(), count = distinct.back() - first + 1;
  if (raw_) {
    const int bytes = record.frames.planes[0].bytes_per_sample;
    for (std::size_t i = 0; i < distinct.size(); ++i)
      frames_.push_back(cv::Mat::zeros(size, bytes == 1 ? CV_8U : CV_16U));
    oneapi::tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
      const cv::Rect& block = blocks[b];
      const std::size_t row_bytes = static_cast<std::size_t>(block.width) * bytes,
                        frame_bytes = row_bytes * block.height;
      std::vector<std::byte> samples(frame_bytes * count);
      snapshot.read(clip, store::Stream::kFrames, 0,
                    {static_cast<std::uint32_t>(block.x), static_cast<std::uint32_t>(block.y),
                     static_cast<std::uint32_t>(block.width), static_cast<std::uint32_t>(block.height)},
                    first, count, samples);
      for (std::size_t i = 0; i < distinct.size(); ++i)
        for (int row = 0; row < block.height; ++row)
          std::memcpy(frames_[i].ptr(block.y + row) + static_cast<std::size_t>(block.x) * bytes,
                      samples.data() + (distinct[i] - first) * frame_bytes + row * row_bytes, row_bytes);
    });
  } else {
    // Colour planes: luminance needs all of them, so whole frames are read, a slab of tiles at a time, and
    // reduced.
    constexpr std::uint32_t kSlab = 16;
    frames_.resize(distinct.size());
    for (std::size_t i = 0; i < distinct.size();) {
      const std::uint32_t from = distinct[i], slab_end = (from / kSlab + 1) * kSlab;
      std::size_t end = i;
      while (end < distinct.size() && distinct[end] < slab_end) ++end;
      const std::vector<media::Frame> slab = clip_frames.read(from, distinct[end - 1] - from + 1);
      oneapi::tbb::parallel_for(
          i, end, [&](std::size_t j) { frames_[j] = media::to_luma(slab[distinct[j] - from]); });
      i = end;
    }
  }

  // The average over output frames, in output order: a repeated frame counts as often as it is shown.
  average_ = cv::Mat::zeros(size, CV_32F);
  oneapi::tbb::parallel_for(0, size.height, [&](int row) {
    cv::Mat sum = average_.row(row), luma;
    for (std::size_t frame : frame_of_output_) {
      if (raw_)
        luma = media::luma_from_plane(layout_, frames_[frame].row(row));
      else
        frames_[frame].row(row).convertTo(luma, CV_32F, 1.0 / 255);
      sum += luma;
    }
    sum *= 1.0 / static_cast<double>(frame_of_output_.size());
  });
}

void ClipLuma::difference(std::size_t i, cv::Mat& out) const {
  const cv::Mat& samples = frames_[frame_of_output_[i]];
  if (raw_)
    cv::subtract(media::luma_from_plane(layout_, samples), average_, out);
  else {
    samples.convertTo(out, CV_32F, 1.0 / 255);
    cv::subtract(out, average_, out);
  }
  // Samples never read are zero in every frame; with a limited range they would still differ by rounding.
  out.setTo(0, ~wanted_);
}

}  // namespace freshet::synth
