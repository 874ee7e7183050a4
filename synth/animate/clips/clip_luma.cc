#include "synth/animate/clips/clip_luma.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <oneapi/tbb/parallel_for.h>

#include "freshet/error.h"
#include "platform/vectors.h"
#include "synth/sampling/cells.h"
#include "synth/sampling/cubic.h"
#include "vision/flow.h"

namespace freshet::synth::animate {
namespace {

constexpr int kBlock = stored::DecodedTiles::kSide;
constexpr std::uint32_t kSlab = stored::DecodedTiles::kFrames;
constexpr int kBorder = 4;  // px around a frame at half size: of what is read at once, two beyond its edge
constexpr int kCell = ClipLuma::kCellWidth * ClipLuma::kCellHeight;

template <class Sample>
[[gnu::always_inline]] inline void look_up(const Sample* from, const float* luma_of, int n, float* to) {
  for (int i = 0; i < n; ++i) to[i] = luma_of[from[i]];
}

FRESHET_WIDE void luma_of_bytes(const std::uint8_t* from, float black, float per_span, int n, float* to) {
  for (int i = 0; i < n; ++i)
    to[i] = std::min(std::max((static_cast<float>(from[i]) - black) * per_span, 0.0f), 1.0f);
}

FRESHET_WIDE void luma_of_words(const std::uint16_t* from, const float* luma_of, int n, float* to) {
  look_up(from, luma_of, n, to);
}

/// Sums of two rows' samples, two by two, as luma.
FRESHET_WIDE void halve_bytes(const std::uint8_t* upper, const std::uint8_t* lower, float black,
                              float per_span, int n, float* to) {
  const float four = 4 * black, quarter = 0.25f * per_span;
  for (int i = 0; i < n; ++i) {
    const int sum = upper[2 * i] + upper[2 * i + 1] + lower[2 * i] + lower[2 * i + 1];
    to[i] = std::min(std::max((static_cast<float>(sum) - four) * quarter, 0.0f), 1.0f);
  }
}

FRESHET_WIDE void halve_words(const std::uint16_t* upper, const std::uint16_t* lower, const float* luma_of,
                              int n, float* to) {
  for (int i = 0; i < n; ++i)
    to[i] = 0.25f * ((luma_of[upper[2 * i]] + luma_of[upper[2 * i + 1]]) +
                     (luma_of[lower[2 * i]] + luma_of[lower[2 * i + 1]]));
}

/// A plane's values go on beyond its edges, `border` px of it on each side.
void extend(cv::Mat& plane, int border) {
  for (int y = border; y < plane.rows - border; ++y) {
    auto* row = plane.ptr<float>(y);
    std::fill(row, row + border, row[border]);
    std::fill(row + plane.cols - border, row + plane.cols, row[plane.cols - border - 1]);
  }
  for (int y = 0; y < border; ++y) {
    plane.row(border).copyTo(plane.row(y));
    plane.row(plane.rows - border - 1).copyTo(plane.row(plane.rows - 1 - y));
  }
}

/// One row of one component of the flow between its rows, in `mixed` from its second value on, and the values
/// before and after it, which are those on its ends. worked: at least the samples, whole vectors if there are so many.
[[gnu::always_inline]] inline void mix_flow(const short* upper, const short* lower, float down, int samples,
                                            int worked, float* mixed) {
  for (int i = 0; i < worked; ++i) mixed[i + 1] = upper[i] + down * static_cast<float>(lower[i] - upper[i]);
  mixed[0] = mixed[1];
  mixed[samples + 1] = mixed[samples];
}

/// Between its columns: `first` from begin on.
[[gnu::always_inline]] inline void flow_of_row(const float* mixed, const std::int32_t* first,
                                               const float* fraction, int n, float* flow) {
  const int begin = first[0] - 1;
#pragma GCC ivdep
  for (int i = 0; i < n; ++i) {
    const float a = mixed[first[i] - begin], b = mixed[first[i] - begin + 1];
    flow[i] = a + fraction[i] * (b - a);
  }
}

/// The same of a flow at half size, and an even column: by far the most common.
[[gnu::always_inline]] inline void flow_of_row_halved(const float* mixed, int n, float* flow) {
  for (int i = 0; i < n / 2; ++i) {
    flow[2 * i] = 0.25f * mixed[i] + 0.75f * mixed[i + 1];
    flow[2 * i + 1] = 0.75f * mixed[i + 1] + 0.25f * mixed[i + 2];
  }
}

/// A component of a cell's flow where it has a sample for each pixel.
FRESHET_WIDE void flow_as_it_is(const short* plane, std::ptrdiff_t stride, int width, int height,
                                float* flow) {
  for (int row = 0; row < height; ++row, plane += stride, flow += width)
    for (int i = 0; i < width; ++i) flow[i] = plane[i];
}

/// Which samples of a component of the flow a cell lies between.
struct FlowCell {
  const std::int32_t *first_row, *first_column;  // by row and column of the cell
  const float *down, *across;                    // fractions of the next
  int last_row, samples, worked;  // of the component; of the columns that are needed, and worked on
  int width, height;              // of the cell
  int before;  // of a halved flow: 0 at the region's left edge, else 1; -1: it is not halved
};

/// One component of a cell's flow. plane   from the cell's first needed column on.
FRESHET_WIDE void flow_of_component(const short* plane, std::ptrdiff_t stride, const FlowCell& cell,
                                    float* mixed, float* flow) {
  for (int row = 0; row < cell.height; ++row, flow += cell.width) {
    const int y0 = cell.first_row[row], y1 = y0 < cell.last_row ? y0 + 1 : y0;
    mix_flow(plane + y0 * stride, plane + y1 * stride, cell.down[row], cell.samples, cell.worked, mixed);
    if (cell.before >= 0)
      flow_of_row_halved(mixed + cell.before, cell.width, flow);
    else
      flow_of_row(mixed, cell.first_column, cell.across, cell.width, flow);
  }
}

/// Places of a cell in steps (cubic.h), `fraction` px for each unit of the flow from `origin` px on, which goes on by
/// `across` from column to column and by `down` from row to row; not beyond -1 and limit, from where on the frame's
/// edge goes on.
FRESHET_WIDE void places_of_cell(const float* flow, int origin, int across, int down, float fraction,
                                 int limit, int width, int height, std::int32_t* places) {
  for (int row = 0; row < height; ++row, flow += width, places += width)
    for (int i = 0; i < width; ++i) {
      const float at = static_cast<float>(origin + down * row + across * i) + fraction * flow[i];
      const float inside = std::min(std::max(at, -1.0f), static_cast<float>(limit));
      // Positive where it is cut off: rounded down.
      places[i] = static_cast<std::int32_t>(inside * sampling::kCubicSteps + (sampling::kCubicSteps + 0.5f)) -
                  sampling::kCubicSteps;
    }
}

/// So many that the last vector is whole, if there are that many.
int whole_vectors(int wanted, int there) {
  constexpr int kVector = 16;
  return std::min((wanted + kVector - 1) / kVector * kVector, there);
}

struct Range {
  std::int32_t minimum, maximum;
};
FRESHET_WIDE void range_of(const std::int32_t* values, int n, Range& range) {
  std::int32_t minimum = values[0], maximum = values[0];
  for (int i = 1; i < n; ++i) {
    minimum = values[i] < minimum ? values[i] : minimum;
    maximum = values[i] > maximum ? values[i] : maximum;
  }
  range = {minimum, maximum};
}

FRESHET_WIDE void read_places(const float* plane, std::ptrdiff_t offset, std::ptrdiff_t stride,
                              const std::int32_t* x, const std::int32_t* y, int n, float* out) {
  sampling::cubic(plane, offset, stride, x, y, n, out);
}

/// Two pictures of one moment mixed: kDisagreement of luma apart, the nearer one alone counts.
FRESHET_WIDE void mix(const float* before, const float* after, float fraction, int n, float* out) {
  constexpr float kDisagreement = 0.1f;
  for (int i = 0; i < n; ++i) {
    const float difference = after[i] - before[i];
    const float steep = 1 + std::abs(difference) / kDisagreement * 4;
    const float w = std::min(std::max(0.5f + (fraction - 0.5f) * steep, 0.0f), 1.0f);
    out[i] = before[i] + w * difference;
  }
}

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

/// One plane of a clip, of samples of so many bytes.
struct LumaPlane {
  const store::Snapshot& snapshot;
  stored::DecodedTiles* tiles;
  store::ClipId clip;
  store::Stream stream;
  std::uint32_t number;
  int bytes;
};

/// One block of a plane in the frames of a run. use   takes a frame and the block's rows, one after another.
template <class Use>
void read_block(const LumaPlane& plane, const cv::Rect& block, std::span<const std::uint32_t> run,
                const Use& use) {
  const int bytes = plane.bytes;
  const std::size_t row_bytes = static_cast<std::size_t>(block.width) * bytes,
                    frame_bytes = row_bytes * block.height;
  const std::uint32_t first = run.front(), count = run.back() - first + 1;
  thread_local std::vector<std::byte>
      kept;  // a block's bytes are many, and are cleared only when there are more
  if (kept.size() < frame_bytes * count) kept.resize(frame_bytes * count);
  const std::span samples(kept.data(), frame_bytes * count);
  stored::read_samples(plane.snapshot, plane.tiles, plane.clip, plane.stream, plane.number,
                       {static_cast<std::uint32_t>(block.x), static_cast<std::uint32_t>(block.y),
                        static_cast<std::uint32_t>(block.width), static_cast<std::uint32_t>(block.height)},
                       first, count, samples);
  for (std::uint32_t frame : run) use(frame, samples.data() + (frame - first) * frame_bytes);
}

/// A block's rows into a picture, from this pixel on.
void put_rows(const std::byte* rows, const cv::Rect& block, int bytes, cv::Point at, cv::Mat& into) {
  const std::size_t row_bytes = static_cast<std::size_t>(block.width) * bytes;
  for (int row = 0; row < block.height; ++row, rows += row_bytes)
    std::memcpy(into.ptr(at.y + row) + static_cast<std::size_t>(at.x) * bytes, rows, row_bytes);
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

/// Of a rectangle of samples, what they are reduced to; its corner lies on a multiple of `by`.
cv::Rect reduced_by(int by, const cv::Rect& samples) {
  return {cv::Point(samples.x / by, samples.y / by),
          cv::Point((samples.br().x + by - 1) / by, (samples.br().y + by - 1) / by)};
}

FRESHET_WIDE void less_mean(const float* a, const float* b, int n, float* out) {
  for (int i = 0; i < n; ++i) out[i] -= 0.5f * (a[i] + b[i]);
}

}  // namespace

ClipLuma::ClipLuma(const store::Snapshot& snapshot, store::ClipId clip, Size size,
                   std::span<const cv::Rect> needed, int flow_step, stored::DecodedTiles* tiles)
    : snapshot_(snapshot),
      clip_(clip),
      tiles_(tiles),
      clip_frames_(snapshot, clip),  // checks that layout, planes and size agree
      layout_(clip_frames_.layout()),
      raw_(media::luma_in_plane_0(layout_)),
      by_(size == Size::kHalf ? 2 : 1),
      flow_step_(std::max(1, flow_step)) {
  const store::ClipRecord& record = snapshot.clip(clip);
  const cv::Size whole(static_cast<int>(record.width), static_cast<int>(record.height));
  source_ = size_of(whole, size);
  flow_size_ = {(whole.width + flow_step_ - 1) / flow_step_, (whole.height + flow_step_ - 1) / flow_step_};
  std::vector<cv::Rect> needed_samples;
  for (const cv::Rect& each : needed) needed_samples.emplace_back(each.tl() * by_, each.br() * by_);
  stored_ = sampling::cells_touched(needed_samples, cv::Rect({}, whole), {kBlock, kBlock});
  cv::Rect samples;
  for (const cv::Rect& block : stored_) {
    samples |= block;
    blocks_.push_back(reduced_by(by_, block));
  }
  region_ = reduced_by(by_, samples);
  flow_region_ = reduced_by(flow_step_, samples);
  const auto between_samples = [this](int begin, int n, int flow_begin, int flow_n) {
    Between places;
    for (int i = begin; i < begin + n; ++i) {
      const double at = std::clamp((i + 0.5) * by_ / flow_step_ - 0.5 - flow_begin, 0.0, flow_n - 1.0);
      places.first.push_back(static_cast<std::int32_t>(at));
      places.fraction.push_back(static_cast<float>(at - std::floor(at)));
    }
    return places;
  };
  flow_across_ = between_samples(region_.x, region_.width, flow_region_.x, flow_region_.width);
  flow_down_ = between_samples(region_.y, region_.height, flow_region_.y, flow_region_.height);

  if (raw_ && record.frames.planes[0].bytes_per_sample == 2) {
    cv::Mat codes(1, 1 << 16, CV_16U), luma;
    for (int i = 0; i < codes.cols; ++i) codes.at<std::uint16_t>(i) = static_cast<std::uint16_t>(i);
    luma = media::luma_from_plane(layout_, codes);
    luma_of_.assign(luma.begin<float>(), luma.end<float>());
  } else if (raw_) {
    // Straight from black to white, of which each is a code.
    cv::Mat codes(1, 1 << 8, CV_8U), luma;
    for (int i = 0; i < codes.cols; ++i) codes.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
    luma = media::luma_from_plane(layout_, codes);
    const auto black =
        std::upper_bound(luma.begin<float>(), luma.end<float>(), 0.0f) - luma.begin<float>() - 1;
    const auto white =
        std::lower_bound(luma.begin<float>(), luma.end<float>(), 1 - 1e-6f) - luma.begin<float>();
    black_ = static_cast<float>(black);
    per_span_ = 1 / static_cast<float>(white - black);
  }
}

ClipLuma::Scratch::Scratch()
    : x(kCell), y(kCell), u(kCell), v(kCell), from(kCell), to(kCell), mixed(kCell + 2) {}

cv::Size ClipLuma::size_of(cv::Size whole, Size size) {
  return size == Size::kWhole ? whole : cv::Size((whole.width + 1) / 2, (whole.height + 1) / 2);
}

std::size_t ClipLuma::frame_bytes() const {
  if (by_ == 2) return static_cast<std::size_t>(plane_size().area()) * sizeof(float);
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
  const int bytes = raw_ ? snapshot_.clip(clip_).frames.planes[0].bytes_per_sample : 1;
  for (std::uint32_t frame : missing)
    frames_[frame] = cv::Mat::zeros(plane_size(), by_ == 2 ? CV_32F : bytes == 1 ? CV_8U : CV_16U);
  const auto put = [&](std::uint32_t frame, const cv::Rect& block, const std::byte* rows) {
    if (by_ == 2)
      put_halved(rows, block, bytes, frames_.at(frame));
    else
      put_rows(rows, block, bytes, block.tl() - region_.tl(), frames_.at(frame));
  };
  if (raw_) {
    oneapi::tbb::parallel_for(std::size_t{0}, stored_.size() * runs.size(), [&](std::size_t task) {
      const cv::Rect& block = stored_[task % stored_.size()];
      read_block({snapshot_, tiles_, clip_, store::Stream::kFrames, 0, bytes}, block,
                 runs[task / stored_.size()],
                 [&](std::uint32_t frame, const std::byte* rows) { put(frame, block, rows); });
    });
  } else {
    // Colour planes: luminance needs all of them, so whole frames are read, a slab of tiles at a time, and
    // reduced.
    for (const auto& run : runs) {
      const std::vector<media::Frame> slab = clip_frames_.read(run.front(), run.back() - run.front() + 1);
      oneapi::tbb::parallel_for(std::size_t{0}, run.size(), [&](std::size_t i) {
        const cv::Mat luma = media::to_luma(slab[run[i] - run.front()]);
        for (const cv::Rect& block : stored_) {
          const cv::Mat rows = luma(block).clone();
          put(run[i], block, reinterpret_cast<const std::byte*>(rows.data));
        }
      });
    }
  }
  if (by_ == 2)
    oneapi::tbb::parallel_for(std::size_t{0}, missing.size(),
                              [&](std::size_t i) { extend(frames_.at(missing[i]), kBorder); });
}

cv::Size ClipLuma::plane_size() const {
  const int more = by_ == 2 ? 2 * kBorder : 0;
  return {region_.width + more, region_.height + more};
}

/// Rows of a block of stored samples, two by two, as luma.
void ClipLuma::put_halved(const std::byte* rows, const cv::Rect& block, int bytes, cv::Mat& into) const {
  const cv::Point at = cv::Point(block.x / 2, block.y / 2) - region_.tl() + cv::Point(kBorder, kBorder);
  const int pairs = block.width / 2;
  const auto halve = [&](const auto* samples, const auto& all) {
    for (int y = 0; y < block.height; y += 2) {
      const auto *upper = samples + y * block.width,
                 *lower = y + 1 < block.height ? upper + block.width : upper;
      auto* to = into.ptr<float>(at.y + y / 2) + at.x;
      all(upper, lower, pairs, to);
      if (block.width % 2 == 0) continue;
      const std::array above{upper[2 * pairs], upper[2 * pairs]}, below{lower[2 * pairs], lower[2 * pairs]};
      all(above.data(), below.data(), 1, to + pairs);
    }
  };
  if (bytes == 1)
    halve(reinterpret_cast<const std::uint8_t*>(rows), [&](const auto* a, const auto* b, int n, float* to) {
      halve_bytes(a, b, black_, per_span_, n, to);
    });
  else
    halve(reinterpret_cast<const std::uint16_t*>(rows),
          [&](const auto* a, const auto* b, int n, float* to) { halve_words(a, b, luma_of_.data(), n, to); });
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
  std::vector<cv::Rect> under;
  for (const cv::Rect& block : stored_)
    under.emplace_back(cv::Point(block.x / flow_step_, block.y / flow_step_),
                       cv::Point((block.br().x - 1) / flow_step_ + 1, (block.br().y - 1) / flow_step_ + 1));
  std::vector<cv::Rect> tiles = sampling::cells_touched(under, cv::Rect({}, flow_size_), {kBlock, kBlock});
  for (cv::Rect& tile : tiles) tile &= flow_region_;
  for (std::uint32_t frame : missing)
    flows_[frame] = {cv::Mat::zeros(flow_region_.size(), CV_16S),
                     cv::Mat::zeros(flow_region_.size(), CV_16S)};
  const auto runs = by_slab(missing);
  oneapi::tbb::parallel_for(std::size_t{0}, 2 * tiles.size() * runs.size(), [&](std::size_t task) {
    const std::uint32_t plane = task % 2;
    const auto& run = runs[task / 2 / tiles.size()];
    const cv::Rect& tile = tiles[task / 2 % tiles.size()];
    read_block({snapshot_, tiles_, clip_, store::Stream::kFlow, plane, 2}, tile, run,
               [&](std::uint32_t frame, const std::byte* rows) {
                 Flow& flow = flows_.at(frame);
                 put_rows(rows, tile, 2, tile.tl() - flow_region_.tl(), plane == 0 ? flow.u : flow.v);
               });
  });
}

void ClipLuma::row(const cv::Mat& samples, int x, int y, int n, float* out) const {
  if (samples.depth() == CV_8U)
    luma_of_bytes(samples.ptr(y) + x, black_, per_span_, n, out);
  else
    luma_of_words(samples.ptr<std::uint16_t>(y) + x, luma_of_.data(), n, out);
}

void ClipLuma::row(std::uint32_t frame, int x, int y, int n, float* out) const {
  const cv::Mat& samples = frames_.at(frame);
  const cv::Point at = cv::Point(x, y) - region_.tl();
  if (by_ == 2)
    std::copy_n(samples.ptr<float>(at.y + kBorder) + at.x + kBorder, n, out);
  else
    row(samples, at.x, at.y, n, out);
}

float ClipLuma::mean(std::uint32_t frame, std::span<const cv::Point> places) const {
  const cv::Mat& samples = frames_.at(frame);
  double sum = 0;
  for (const cv::Point& place : places) {
    const cv::Point at = place - region_.tl();
    if (by_ == 2) {
      sum += samples.at<float>(at + cv::Point(kBorder, kBorder));
      continue;
    }
    sum +=
        samples.depth() == CV_8U
            ? std::clamp((static_cast<float>(samples.at<std::uint8_t>(at)) - black_) * per_span_, 0.0f, 1.0f)
            : luma_of_[samples.at<std::uint16_t>(at)];
  }
  return static_cast<float>(sum / static_cast<double>(places.size()));
}

void ClipLuma::at(double moment, const cv::Rect& cell, float* out, Scratch& scratch) const {
  CV_Assert(by_ == 1);
  const auto frame = static_cast<std::uint32_t>(moment);
  const auto fraction = static_cast<float>(moment - frame);
  if (fraction > 0) return between(frame, fraction, cell, out, scratch);
  for (int y = 0; y < cell.height; ++y) row(frame, cell.x, cell.y + y, cell.width, out + y * cell.width);
}

/// The flow of a cell from `frame` to the next, between its samples, px / kFlowUnit: s.u and s.v.
void ClipLuma::flow_of_cell(std::uint32_t frame, const cv::Rect& cell, Scratch& s) const {
  const Flow& by = flows_.at(frame);
  const cv::Point corner = cell.tl() - region_.tl();
  if (flow_step_ == by_) {
    flow_as_it_is(by.u.ptr<short>(corner.y) + corner.x, static_cast<std::ptrdiff_t>(by.u.step1()), cell.width,
                  cell.height, s.u.data());
    flow_as_it_is(by.v.ptr<short>(corner.y) + corner.x, static_cast<std::ptrdiff_t>(by.v.step1()), cell.width,
                  cell.height, s.v.data());
    return;
  }
  const std::int32_t* first = flow_across_.first.data() + corner.x;
  const int begin = first[0], samples = std::min(first[cell.width - 1] + 2, flow_region_.width) - begin;
  const bool halved = flow_step_ == 2 && by_ == 1 && cell.x % 2 == 0 && cell.width % 2 == 0;
  const FlowCell places{
      .first_row = flow_down_.first.data() + corner.y,
      .first_column = first,
      .down = flow_down_.fraction.data() + corner.y,
      .across = flow_across_.fraction.data() + corner.x,
      .last_row = flow_region_.height - 1,
      .samples = samples,
      .worked = whole_vectors(samples, flow_region_.width - begin),
      .width = cell.width,
      .height = cell.height,
      // Of a halved flow the first column of a cell lies after the sample before it; at the region's edge there is
      // none.
      .before = !halved                                     ? -1
                : (cell.x + 1) / 2 - flow_region_.x > begin ? 1
                                                            : 0};
  flow_of_component(by.u.ptr<short>() + begin, static_cast<std::ptrdiff_t>(by.u.step1()), places,
                    s.mixed.data(), s.u.data());
  flow_of_component(by.v.ptr<short>() + begin, static_cast<std::ptrdiff_t>(by.v.step1()), places,
                    s.mixed.data(), s.v.data());
}

void ClipLuma::between(std::uint32_t frame, float fraction, const cv::Rect& cell, float* out,
                       Scratch& s) const {
  flow_of_cell(frame, cell, s);
  // Where `frame` comes from, and by the same flow the one after it.
  carried(frame, -fraction, cell, s.from.data(), s);
  carried(frame + 1, 1 - fraction, cell, s.to.data(), s);
  mix(s.from.data(), s.to.data(), fraction, cell.area(), out);
}

void ClipLuma::innovation(std::uint32_t frame, const cv::Rect& cell, float* out, Scratch& s) const {
  CV_Assert(by_ == 2);
  for (int y = 0; y < cell.height; ++y) row(frame, cell.x, cell.y + y, cell.width, out + y * cell.width);
  const bool before = frame > 0 && frames_.contains(frame - 1) && flows_.contains(frame - 1);
  const bool after = frames_.contains(frame + 1) && flows_.contains(frame);
  if (before) {
    flow_of_cell(frame - 1, cell, s);
    carried(frame - 1, -1, cell, s.from.data(), s);
  }
  if (after) {
    flow_of_cell(frame, cell, s);
    carried(frame + 1, 1, cell, s.to.data(), s);
  }
  const std::vector<float>&first = before ? s.from : s.to, &second = after ? s.to : s.from;
  if (before || after)
    less_mean(first.data(), second.data(), cell.area(), out);
  else
    std::fill(out, out + cell.area(), 0.0f);
}

/// A cell of a frame, read `fraction` of the flow in s.u and s.v away.
void ClipLuma::carried(std::uint32_t frame, float fraction, const cv::Rect& cell, float* out,
                       Scratch& s) const {
  const cv::Point corner = cell.tl() - region_.tl();
  const float unit = fraction * vision::kFlowUnit / static_cast<float>(by_);
  places_of_cell(s.u.data(), corner.x, 1, 0, unit, region_.width, cell.width, cell.height, s.x.data());
  places_of_cell(s.v.data(), corner.y, 0, 1, unit, region_.height, cell.width, cell.height, s.y.data());
  if (by_ == 2) {
    const cv::Mat& plane = frames_.at(frame);
    const auto stride = static_cast<std::ptrdiff_t>(plane.step1());
    return read_places(plane.ptr<float>(), kBorder * stride + kBorder, stride, s.x.data(), s.y.data(),
                       cell.area(), out);
  }
  // The samples around all places, beyond the region its edge.
  Range x, y;
  range_of(s.x.data(), cell.area(), x);
  range_of(s.y.data(), cell.area(), y);
  const int left = (x.minimum >> sampling::kCubicShift) - 1, right = (x.maximum >> sampling::kCubicShift) + 3;
  const int top = (y.minimum >> sampling::kCubicShift) - 1, bottom = (y.maximum >> sampling::kCubicShift) + 3;
  const int from = std::max(left, 0), to = std::min(right, region_.width);
  const int worked = whole_vectors(to - from, region_.width - from), missing = from - left;
  const int stride = missing + std::max(worked, right - from);
  s.window.resize(static_cast<std::size_t>(stride) * (bottom - top));
  const cv::Mat& samples = frames_.at(frame);
  for (int i = top; i < bottom; ++i) {
    float* line = s.window.data() + static_cast<std::size_t>(i - top) * stride;
    row(samples, from, std::clamp(i, 0, region_.height - 1), worked, line + missing);
    std::fill(line, line + missing, line[missing]);
    std::fill(line + (to - left), line + (right - left), line[to - left - 1]);
  }
  const std::ptrdiff_t offset = -static_cast<std::ptrdiff_t>(top) * stride - left;
  read_places(s.window.data(), offset, stride, s.x.data(), s.y.data(), cell.area(), out);
}

}  // namespace freshet::synth::animate
