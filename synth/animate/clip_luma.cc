#include "synth/animate/clip_luma.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet_error.h"
#include "vision/flow.h"

namespace freshet::synth {
namespace {

constexpr int kBlock = 64;           // samples: the store's tiles
constexpr std::uint32_t kSlab = 16;  // frames: the store's tiles

/// Runs of frames that lie in one slab: each is read at once, so that a tile is decoded once.
std::vector<std::span<const std::uint32_t>> by_slab(std::span<const std::uint32_t> frames) {
  std::vector<std::span<const std::uint32_t>> runs;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t end = i;
    while (end < frames.size() && frames[end] / kSlab == frames[i] / kSlab) ++end;
    runs.push_back(frames.subspan(i, end - i));
    i = end;
  }
  return runs;
}

/// One block of one plane in the frames of a run, copied into pictures whose top left corner lies at
/// `origin`.
template <class PictureOf>
void read_block(const store::Snapshot& snapshot, store::ClipId clip, store::Stream stream,
                std::uint32_t plane, const cv::Rect& block, std::span<const std::uint32_t> run, int bytes,
                cv::Point origin, const PictureOf& picture_of) {
  const std::size_t row_bytes = static_cast<std::size_t>(block.width) * bytes,
                    frame_bytes = row_bytes * block.height;
  const std::uint32_t first = run.front(), count = run.back() - first + 1;
  std::vector<std::byte> samples(frame_bytes * count);
  snapshot.read(clip, stream, plane,
                {static_cast<std::uint32_t>(block.x), static_cast<std::uint32_t>(block.y),
                 static_cast<std::uint32_t>(block.width), static_cast<std::uint32_t>(block.height)},
                first, count, samples);
  for (std::uint32_t frame : run) {
    cv::Mat& into = picture_of(frame);
    for (int row = 0; row < block.height; ++row)
      std::memcpy(into.ptr(block.y - origin.y + row) + static_cast<std::size_t>(block.x - origin.x) * bytes,
                  samples.data() + (frame - first) * frame_bytes + row * row_bytes, row_bytes);
  }
}

/// What of `wanted` is not a key of `held`; what is held and not wanted is dropped.
template <class Held>
std::vector<std::uint32_t> keep_only(Held& held, std::span<const std::uint32_t> wanted) {
  std::erase_if(held, [&](const auto& entry) {
    return !std::binary_search(wanted.begin(), wanted.end(), entry.first);
  });
  std::vector<std::uint32_t> missing;
  for (std::uint32_t frame : wanted)
    if (!held.contains(frame)) missing.push_back(frame);
  return missing;
}

}  // namespace

ClipLuma::ClipLuma(const store::Snapshot& snapshot, store::ClipId clip, std::span<const cv::Rect> needed,
                   int flow_step)
    : snapshot_(snapshot),
      clip_(clip),
      clip_frames_(snapshot, clip),  // checks that layout, planes and size agree
      layout_(clip_frames_.layout()),
      raw_(media::luma_in_plane_0(layout_)),
      flow_step_(std::max(1, flow_step)) {
  const store::ClipRecord& record = snapshot.clip(clip);
  source_ = {static_cast<int>(record.width), static_cast<int>(record.height)};
  flow_size_ = {(source_.width + flow_step_ - 1) / flow_step_,
                (source_.height + flow_step_ - 1) / flow_step_};
  const int columns = (source_.width + kBlock - 1) / kBlock, rows = (source_.height + kBlock - 1) / kBlock;
  cv::Mat touched = cv::Mat::zeros(rows, columns, CV_8U);
  for (const cv::Rect& rect : needed) {
    const cv::Rect inside = rect & cv::Rect({}, source_);
    if (inside.empty()) continue;
    touched(cv::Rect(cv::Point(inside.x / kBlock, inside.y / kBlock),
                     cv::Point((inside.br().x - 1) / kBlock + 1, (inside.br().y - 1) / kBlock + 1)))
        .setTo(1);
  }
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      if (touched.at<std::uint8_t>(row, column)) {
        blocks_.push_back(cv::Rect(column * kBlock, row * kBlock, kBlock, kBlock) & cv::Rect({}, source_));
        region_ |= blocks_.back();
      }
  wanted_ = cv::Mat::zeros(region_.size(), CV_8U);
  for (const cv::Rect& block : blocks_) wanted_(block - region_.tl()).setTo(255);
  flow_region_ = cv::Rect(cv::Point(region_.x / flow_step_, region_.y / flow_step_),
                          cv::Point((region_.br().x + flow_step_ - 1) / flow_step_,
                                    (region_.br().y + flow_step_ - 1) / flow_step_));
}

std::size_t ClipLuma::frame_bytes() const {
  const int bytes = raw_ ? snapshot_.clip(clip_).frames.planes[0].bytes_per_sample : 1;
  return static_cast<std::size_t>(region_.area()) * bytes;
}

std::size_t ClipLuma::flow_bytes() const { return static_cast<std::size_t>(flow_region_.area()) * 4; }

void ClipLuma::load(std::span<const std::uint32_t> frames, std::span<const std::uint32_t> flows) {
  if (const auto missing = keep_only(frames_, frames); !missing.empty()) read_frames(missing);
  if (const auto missing = keep_only(flows_, flows); !missing.empty()) read_flows(missing);
}

void ClipLuma::read_frames(std::span<const std::uint32_t> missing) {
  const auto runs = by_slab(missing);
  if (raw_) {
    const int bytes = snapshot_.clip(clip_).frames.planes[0].bytes_per_sample;
    for (std::uint32_t frame : missing)
      frames_[frame] = cv::Mat::zeros(region_.size(), bytes == 1 ? CV_8U : CV_16U);
    oneapi::tbb::parallel_for(std::size_t{0}, blocks_.size() * runs.size(), [&](std::size_t task) {
      read_block(snapshot_, clip_, store::Stream::kFrames, 0, blocks_[task % blocks_.size()],
                 runs[task / blocks_.size()], bytes, region_.tl(),
                 [&](std::uint32_t frame) -> cv::Mat& { return frames_.at(frame); });
    });
    return;
  }
  // Colour planes: luminance needs all of them, so whole frames are read, a slab of tiles at a time, and
  // reduced.
  for (const auto& run : runs) {
    const std::vector<media::Frame> slab = clip_frames_.read(run.front(), run.back() - run.front() + 1);
    for (std::uint32_t frame : run) frames_[frame] = cv::Mat();
    oneapi::tbb::parallel_for(std::size_t{0}, run.size(), [&](std::size_t i) {
      frames_.at(run[i]) = media::to_luma(slab[run[i] - run.front()])(region_).clone();
    });
  }
}

void ClipLuma::check_flow() const {
  const store::ClipRecord& record = snapshot_.clip(clip_);
  bool right = record.flow.planes.size() == 2 && record.flow.frames + 1 == record.frame_count;
  for (const store::PlaneShape& plane : record.flow.planes)
    right = right && plane.width == static_cast<std::uint32_t>(flow_size_.width) &&
            plane.height == static_cast<std::uint32_t>(flow_size_.height) && plane.bytes_per_sample == 2;
  if (!right)
    throw Error(ErrorKind::kDamaged, record.name, "its flow does not fit its frames",
                "Run freshet store verify");
}

void ClipLuma::read_flows(std::span<const std::uint32_t> missing) {
  check_flow();
  // Tiles of the flow's planes under the blocks.
  const int columns = (flow_size_.width + kBlock - 1) / kBlock,
            rows = (flow_size_.height + kBlock - 1) / kBlock;
  cv::Mat touched = cv::Mat::zeros(rows, columns, CV_8U);
  for (const cv::Rect& block : blocks_)
    touched(cv::Rect(cv::Point(block.x / flow_step_ / kBlock, block.y / flow_step_ / kBlock),
                     cv::Point(std::min(columns, (block.br().x - 1) / flow_step_ / kBlock + 1),
                               std::min(rows, (block.br().y - 1) / flow_step_ / kBlock + 1))))
        .setTo(1);
  std::vector<cv::Rect> tiles;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      if (touched.at<std::uint8_t>(row, column))
        tiles.push_back(cv::Rect(column * kBlock, row * kBlock, kBlock, kBlock) & flow_region_);
  std::erase_if(tiles, [](const cv::Rect& tile) { return tile.empty(); });
  for (std::uint32_t frame : missing)
    flows_[frame] = {cv::Mat::zeros(flow_region_.size(), CV_16S),
                     cv::Mat::zeros(flow_region_.size(), CV_16S)};
  const auto runs = by_slab(missing);
  oneapi::tbb::parallel_for(std::size_t{0}, 2 * tiles.size() * runs.size(), [&](std::size_t task) {
    const std::uint32_t plane = task % 2;
    const auto& run = runs[task / 2 / tiles.size()];
    read_block(snapshot_, clip_, store::Stream::kFlow, plane, tiles[task / 2 % tiles.size()], run, 2,
               flow_region_.tl(), [&](std::uint32_t frame) -> cv::Mat& {
                 Flow& flow = flows_.at(frame);
                 return plane == 0 ? flow.u : flow.v;
               });
  });
}

cv::Mat ClipLuma::rows(std::uint32_t frame, int first, int last) const {
  const cv::Mat samples = frames_.at(frame).rowRange(first, last);
  if (raw_) return media::luma_from_plane(layout_, samples);
  cv::Mat luma;
  samples.convertTo(luma, CV_32F, 1.0 / 255);
  return luma;
}

void ClipLuma::at(double moment, cv::Mat& out, Scratch& scratch) const {
  const auto frame = static_cast<std::uint32_t>(moment);
  const auto part = static_cast<float>(moment - frame);
  if (part == 0)
    out = rows(frame, 0, region_.height);
  else
    between(frame, part, out, scratch);
}

void ClipLuma::between(std::uint32_t frame, float part, cv::Mat& out, Scratch& scratch) const {
  const Flow& flow = flows_.at(frame);
  scratch.before = rows(frame, 0, region_.height);
  scratch.after = rows(frame + 1, 0, region_.height);
  out.create(region_.size(), CV_32F);
  const float step = static_cast<float>(flow_step_);
  for (const cv::Rect& block : blocks_) {
    const cv::Rect inside = block - region_.tl();
    scratch.x.create(block.size(), CV_32F);
    scratch.y.create(block.size(), CV_32F);
    // First where `before` comes from, then, by the same flow, `after`.
    for (int pass = 0; pass < 2; ++pass) {
      const float share = (pass == 0 ? -part : 1 - part) * vision::kFlowUnit;
      for (int row = 0; row < block.height; ++row) {
        const float fy = std::clamp(
            (static_cast<float>(block.y + row) + 0.5f) / step - 0.5f - static_cast<float>(flow_region_.y),
            0.0f, static_cast<float>(flow_region_.height - 1));
        const int y0 = static_cast<int>(fy), y1 = std::min(y0 + 1, flow_region_.height - 1);
        const float py = fy - static_cast<float>(y0);
        const short *u0 = flow.u.ptr<short>(y0), *u1 = flow.u.ptr<short>(y1);
        const short *v0 = flow.v.ptr<short>(y0), *v1 = flow.v.ptr<short>(y1);
        float* x = scratch.x.ptr<float>(row);
        float* y = scratch.y.ptr<float>(row);
        for (int column = 0; column < block.width; ++column) {
          const float fx = std::clamp((static_cast<float>(block.x + column) + 0.5f) / step - 0.5f -
                                          static_cast<float>(flow_region_.x),
                                      0.0f, static_cast<float>(flow_region_.width - 1));
          const int x0 = static_cast<int>(fx), x1 = std::min(x0 + 1, flow_region_.width - 1);
          const float px = fx - static_cast<float>(x0);
          const auto sample = [&](const short* upper, const short* lower) {
            const float a = upper[x0] + px * (upper[x1] - upper[x0]);
            const float b = lower[x0] + px * (lower[x1] - lower[x0]);
            return a + py * (b - a);
          };
          x[column] = static_cast<float>(inside.x + column) + share * sample(u0, u1);
          y[column] = static_cast<float>(inside.y + row) + share * sample(v0, v1);
        }
      }
      cv::remap(pass == 0 ? scratch.before : scratch.after, pass == 0 ? scratch.from : scratch.to, scratch.x,
                scratch.y, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    }
    for (int row = 0; row < block.height; ++row) {
      const float* a = scratch.from.ptr<float>(row);
      const float* b = scratch.to.ptr<float>(row);
      float* o = out.ptr<float>(inside.y + row) + inside.x;
      for (int column = 0; column < block.width; ++column) {
        // kDisagreement of luma apart, the nearer one alone counts.
        constexpr float kDisagreement = 0.1f;
        const float difference = b[column] - a[column];
        const float steep = 1 + std::abs(difference) / kDisagreement * 4;
        const float w = std::clamp(0.5f + (part - 0.5f) * steep, 0.0f, 1.0f);
        o[column] = a[column] + w * difference;
      }
    }
  }
}

}  // namespace freshet::synth
