#include "synth/animate/motion/motion_sequence.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <compare>
#include <cstddef>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "stored/clip_schema.h"
#include "synth/animate/placement/pieces_picture.h"
#include "synth/sampling/patch_window.h"
#include "synth/sampling/pull_push.h"
#include "vision/flow.h"

namespace freshet::synth::animate {
namespace {

constexpr float kFastest = 2.5f;     // times the mean speed of a frame
constexpr double kSmoothing = 1.25;  // squares
constexpr double kStill = 0.25;      // of its neighbours' mean speed: a step between two equal frames
constexpr int kSquare = 8;           // px: finer than flow is true, fine enough for a flame's edge
constexpr std::uint32_t kSlab = stored::DecodedTiles::kFrames;  // decoded together

/// The grid of squares on which motion is summed. It coincides with the pieces' and holds the whole picture, reduced
/// as they are.
struct SquareGrid {
  int square = 0;    // px per side
  int per_side = 0;  // squares on a patch's side
  cv::Point corner;  // px, of the first square
  cv::Size size;     // squares
  cv::Mat tent;      // per_side x per_side, CV_32F: a patch's weights, which fall from its middle
};

cv::Mat tent_of(int per_side) {
  cv::Mat tent(per_side, per_side, CV_32F);
  for (int row = 0; row < per_side; ++row)
    for (int column = 0; column < per_side; ++column) {
      const auto fraction = [&](int i) { return 1 - std::abs((2.0 * i + 1) / per_side - 1); };
      tent.at<float>(row, column) = static_cast<float>(fraction(row) * fraction(column));
    }
  return tent;
}

SquareGrid grid_of(const Placement& placement, cv::Size picture) {
  SquareGrid grid;
  const int square = grid.square = common_step(placement, kSquare);
  grid.per_side = placement.side / square;
  const cv::Size reduced = pieces_picture(placement, picture);
  const cv::Rect canvas = canvas_of(placement);
  const auto whole = [&](int length) { return (std::max(length, 0) + square - 1) / square; };
  const cv::Point before(whole(canvas.x), whole(canvas.y));
  grid.corner = canvas.tl() - before * square;
  grid.size = {before.x + std::max(canvas.width / square, whole(reduced.width - canvas.x)),
               before.y + std::max(canvas.height / square, whole(reduced.height - canvas.y))};
  grid.tent = tent_of(grid.per_side);
  return grid;
}

/// The flow of one clip, checked against its record.
const store::StreamShape& checked_flow(const store::ClipRecord& record, int step) {
  const store::StreamShape& flow = record.flow;
  const auto reduced = [&](std::uint32_t length) {
    return (length + static_cast<std::uint32_t>(step) - 1) / static_cast<std::uint32_t>(step);
  };
  const store::PlaneShape expected{reduced(record.width), reduced(record.height), 2};
  if (flow.planes.size() != 2 || flow.planes[0] != expected || flow.planes[1] != expected ||
      flow.frames == 0 || flow.frames + 1 != record.frame_count)
    throw Error(ErrorKind::kDamaged, record.name, "its flow does not fit its frames",
                "Run freshet store verify, and ingest the clip again");
  return flow;
}

/// The part of one clip's flow that its patches need.
struct NeededFlow {
  const store::Snapshot& snapshot;
  stored::DecodedTiles* tiles;
  store::ClipId clip;
  int step = 0;  // px of the clip between samples
  std::uint32_t frames = 0;
  std::vector<double> px_per_s;  // of each frame, for one unit of what is stored
  cv::Rect samples;
};

/// By the clip's rate, or where that varies by each pair of frames' own.
std::vector<double> px_per_s_of(const store::Snapshot& snapshot, store::ClipId clip) {
  const store::ClipRecord& record = snapshot.clip(clip);
  const double fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den);
  std::vector<double> rates(record.flow.frames, fps);
  if (stored::kFlowRate.is_in(snapshot, clip)) rates = stored::kFlowRate.read(snapshot, clip);
  if (rates.size() != record.flow.frames ||
      !std::all_of(rates.begin(), rates.end(), [](double rate) { return rate > 0 && std::isfinite(rate); }))
    throw Error(ErrorKind::kDamaged, record.name, "the rates of its flow do not fit it",
                "Run freshet store verify, and ingest the clip again");
  for (double& rate : rates) rate *= vision::kFlowUnit;
  return rates;
}

NeededFlow needed_flow(const store::Snapshot& snapshot, stored::DecodedTiles* tiles, int step,
                       const Placement& placement, const PlayedPatches& group) {
  const store::ClipRecord& record = snapshot.clip(group.clip);
  const store::StreamShape& flow = checked_flow(record, step);
  const cv::Size source(static_cast<int>(record.width), static_cast<int>(record.height));
  cv::Rect needed;
  for (const std::size_t p : group.patches)
    needed |= sampling::PatchWindow(source, placement.patches[p].variant, placement.patches[p].patch,
                                    placement.side)
                  .needed();
  cv::Rect samples(cv::Point(needed.x / step - kSquare, needed.y / step - kSquare),
                   cv::Point(needed.br().x / step + kSquare, needed.br().y / step + kSquare));
  samples &= cv::Rect(0, 0, static_cast<int>(flow.planes[0].width), static_cast<int>(flow.planes[0].height));
  return {snapshot, tiles, group.clip, step, flow.frames, px_per_s_of(snapshot, group.clip), samples};
}

/// One placed patch: where its squares lie in its clip's flow, and how velocities turn.
struct Probe {
  cv::Point corner;                // on the grid of squares
  int reach = 1;                   // samples over which flow is averaged: a square is as wide
  std::vector<cv::Point2f> spots;  // among the samples of the clip's flow, row-major over the patch's squares
  cv::Matx22d turn;
};

std::vector<Probe> probes_of(const PlayedPatches& group, const Placement& placement, const SquareGrid& grid,
                             const NeededFlow& flow) {
  const store::ClipRecord& record = flow.snapshot.clip(group.clip);
  const cv::Size source(static_cast<int>(record.width), static_cast<int>(record.height));
  std::vector<Probe> probes;
  for (const std::size_t number : group.patches) {
    const PlacedPatch& placed = placement.patches[number];
    const vision::VariantFrame frame = vision::variant_frame(source, placed.variant);
    Probe probe;
    probe.corner = (placed.piece - grid.corner) / grid.square;
    probe.turn = frame.variant_from_source_velocity;
    probe.reach =
        std::max(1, static_cast<int>(std::lround(grid.square / placed.variant.scale / flow.step))) | 1;
    const double middle = (grid.square - 1) / 2.0;
    for (int row = 0; row < grid.per_side; ++row)
      for (int column = 0; column < grid.per_side; ++column) {
        const cv::Vec2d at =
            frame.source_from_variant * cv::Vec3d(placed.patch.x + column * grid.square + middle,
                                                  placed.patch.y + row * grid.square + middle, 1);
        probe.spots.emplace_back(static_cast<float>((at[0] + 0.5) / flow.step - 0.5 - flow.samples.x),
                                 static_cast<float>((at[1] + 0.5) / flow.step - 0.5 - flow.samples.y));
      }
    probes.push_back(std::move(probe));
  }
  return probes;
}

/// A flow frame that some output frame shows at some rate.
struct ShownFlow {
  std::uint32_t at = 0;
  double rate = 1;
  auto operator<=>(const ShownFlow&) const = default;
};

/// The needed samples of some frames of a clip's flow, decoded once.
class DecodedFlow {
 public:
  DecodedFlow(const NeededFlow& flow, std::uint32_t first, std::uint32_t count)
      : size_(flow.samples.size()), first_(first) {
    const cv::Rect& s = flow.samples;
    for (std::uint32_t p = 0; p < 2; ++p) {
      planes_[p].resize(static_cast<std::size_t>(s.area()) * count);
      stored::read_samples(flow.snapshot, flow.tiles, flow.clip, store::Stream::kFlow, p,
                           {static_cast<std::uint32_t>(s.x), static_cast<std::uint32_t>(s.y),
                            static_cast<std::uint32_t>(s.width), static_cast<std::uint32_t>(s.height)},
                           first, count, std::as_writable_bytes(std::span(planes_[p])));
    }
  }

  std::array<cv::Mat, 2> at(std::uint32_t frame) {
    const std::size_t offset = static_cast<std::size_t>(size_.area()) * (frame - first_);
    return {cv::Mat(size_, CV_16S, planes_[0].data() + offset),
            cv::Mat(size_, CV_16S, planes_[1].data() + offset)};
  }

 private:
  cv::Size size_;
  std::uint32_t first_ = 0;
  std::vector<std::int16_t> planes_[2];
};

/// A box between samples: from `first` on one more than it is wide, of which the outermost count in part.
struct Box {
  int first = 0;
  float fraction = 0;  // of the last; of the first the rest

  /// reach samples wide around `at`, where there are n samples.
  Box(float at, int reach, int n) {
    at = std::clamp(at, 0.0f, static_cast<float>(n - 1));
    const int whole = static_cast<int>(at);
    first = whole - reach / 2;
    fraction = at - static_cast<float>(whole);
  }
};

float sum_of_row(const std::int16_t* row, const Box& across, int reach, int n) {
  int inner = 0;
  if (across.first >= 0 && across.first + reach < n) {
    const std::int16_t* at = row + across.first;
    for (int i = 1; i < reach; ++i) inner += at[i];
    return static_cast<float>(inner) + (1 - across.fraction) * at[0] + across.fraction * at[reach];
  }
  const auto sample = [&](int i) { return row[std::clamp(across.first + i, 0, n - 1)]; };
  for (int i = 1; i < reach; ++i) inner += sample(i);
  return static_cast<float>(inner) + (1 - across.fraction) * sample(0) + across.fraction * sample(reach);
}

/// Mean of a plane over a box around a place between its samples: what interpolation reads from the box-blurred plane.
float box_mean(const cv::Mat& plane, const cv::Point2f& at, int reach) {
  const Box across(at.x, reach, plane.cols), down(at.y, reach, plane.rows);
  float sum = 0;
  for (int i = 0; i <= reach; ++i) {
    const float weight = i == 0 ? 1 - down.fraction : i == reach ? down.fraction : 1;
    const int row = std::clamp(down.first + i, 0, plane.rows - 1);
    sum += weight * sum_of_row(plane.ptr<std::int16_t>(row), across, reach, plane.cols);
  }
  return sum / static_cast<float>(reach * reach);
}

/// Of a square of a patch, over the output frames: sums of its motion and of its square.
struct Moments {
  cv::Vec2d sum;
  double squares = 0;
};

/// Adds a patch's motion, weighted by its tent, to the squares that it lies on. rate: px/s for a unit of the flow.
/// moments: of the patch's squares; `count` output frames show it so.
void add_patch(const Probe& probe, const std::array<cv::Mat, 2>& flow, double rate, int count,
               const cv::Mat& tent, cv::Mat& squares, Moments* moments) {
  const cv::Point2f* spot = probe.spots.data();
  for (int row = 0; row < tent.rows; ++row)
    for (int column = 0; column < tent.cols; ++column, ++spot, ++moments) {
      const cv::Vec2d v(box_mean(flow[0], *spot, probe.reach), box_mean(flow[1], *spot, probe.reach));
      const cv::Vec2d turned = probe.turn * v * rate;
      moments->sum += count * turned;
      moments->squares += count * turned.dot(turned);
      const cv::Vec2d weighted = turned * tent.at<float>(row, column);
      squares.at<cv::Vec2f>(probe.corner.y + row, probe.corner.x + column) +=
          cv::Vec2f(static_cast<float>(weighted[0]), static_cast<float>(weighted[1]));
    }
}

/// The patches' motion in flow frames of one slab, in ascending order. held: the clip's flow, null: it is decoded.
/// counts   of output frames that show each.
/// listed   of the grid, the squares that any of the patches lies on.
/// moments  patch by patch, square by square: added to.
void sum_slab(std::span<const ShownFlow> slab, std::span<const int> counts, const NeededFlow& flow,
              const HeldFlow* held, std::span<const Probe> probes, const SquareGrid& grid,
              std::span<const std::uint32_t> listed, std::span<std::vector<cv::Vec2f>> sums,
              std::span<Moments> moments) {
  const std::uint32_t first = slab.front().at;
  std::optional<DecodedFlow> decoded;
  if (!held) decoded.emplace(flow, first, slab.back().at - first + 1);
  cv::Mat squares(grid.size, CV_32FC2);
  for (std::size_t i = 0; i < slab.size(); ++i) {
    std::array<cv::Mat, 2> planes = held ? held->at(slab[i].at) : decoded->at(slab[i].at);
    if (held)
      for (cv::Mat& plane : planes) plane = plane(flow.samples - held->samples.tl());
    squares.setTo(cv::Scalar::all(0));
    for (std::size_t k = 0; k < probes.size(); ++k)
      add_patch(probes[k], planes, flow.px_per_s[slab[i].at] * slab[i].rate, counts[i], grid.tent, squares,
                moments.data() + k * grid.tent.total());
    sums[i].reserve(listed.size());
    for (const std::uint32_t square : listed) sums[i].push_back(squares.ptr<cv::Vec2f>()[square]);
  }
}

double speed_of(const std::vector<cv::Vec2f>& sums) {
  double speed = 0;
  for (const cv::Vec2f& sum : sums) speed += std::hypot(sum[0], sum[1]);
  return speed;
}

/// A clip brought to a higher rate shows a frame twice now and then, where all stands: such a step goes as the mean of
/// those before and after it. Returns how many output frames show one.
int go_on_through_repeats(std::span<const ShownFlow> flows, std::span<const int> counts,
                          std::span<std::vector<cv::Vec2f>> sums) {
  std::vector<double> speed;
  for (const std::vector<cv::Vec2f>& of : sums) speed.push_back(speed_of(of));
  const auto follows = [&](std::size_t i) {
    return flows[i].at == flows[i - 1].at + 1 && flows[i].rate == flows[i - 1].rate;
  };
  int repeats = 0;
  for (std::size_t i = 1; i + 1 < flows.size(); ++i) {
    if (!follows(i) || !follows(i + 1) || speed[i] >= kStill * (speed[i - 1] + speed[i + 1]) / 2) continue;
    for (std::size_t k = 0; k < sums[i].size(); ++k) sums[i][k] = (sums[i - 1][k] + sums[i + 1][k]) / 2;
    repeats += counts[i];
  }
  return repeats;
}

/// Adds the variance of each patch's motion over so many frames, weighted by its tent. moments: as of sum_slab.
void add_variance(std::span<const Moments> moments, std::span<const Probe> probes, double frames,
                  const SquareGrid& grid, cv::Mat& variance) {
  auto one = moments.begin();
  for (const Probe& probe : probes)
    for (int row = 0; row < grid.tent.rows; ++row)
      for (int column = 0; column < grid.tent.cols; ++column, ++one) {
        const cv::Vec2d mean = one->sum / frames;
        variance.at<float>(probe.corner.y + row, probe.corner.x + column) +=
            grid.tent.at<float>(row, column) *
            static_cast<float>(std::max(0.0, one->squares / frames - mean.dot(mean)));
      }
}

/// The squares that any of the patches lies on, ascending.
std::vector<std::uint32_t> squares_under(std::span<const Probe> probes, const SquareGrid& grid) {
  cv::Mat under = cv::Mat::zeros(grid.size, CV_8U);
  for (const Probe& probe : probes) under(cv::Rect(probe.corner, grid.tent.size())) = 1;
  std::vector<std::uint32_t> squares;
  for (std::size_t i = 0; i < under.total(); ++i)
    if (under.data[i] != 0) squares.push_back(static_cast<std::uint32_t>(i));
  return squares;
}

/// From sums to means; then the motion of what moves goes on over what hardly does, and beyond the pieces. A
/// patch from a flame's edge is half dark and stands still there: taken at its word, no flame would ever
/// leave its outline.
void spread(cv::Mat& squares, const cv::Mat& mass) {
  double speed_sum = 0;
  cv::Mat speed = cv::Mat::zeros(squares.size(), CV_32F);
  for (int row = 0; row < squares.rows; ++row)
    for (int column = 0; column < squares.cols; ++column) {
      const float weight = mass.at<float>(row, column);
      if (weight <= 0) continue;
      auto& v = squares.at<cv::Vec2f>(row, column);
      v /= weight;
      speed.at<float>(row, column) = std::hypot(v[0], v[1]);
      speed_sum += speed.at<float>(row, column);
    }
  const auto mean = static_cast<float>(speed_sum / std::max(1, cv::countNonZero(mass)));
  if (mean <= 0) return;
  // Flow is wrong here and there by much, and such a place would tear the matte into rings.
  for (int row = 0; row < squares.rows; ++row)
    for (int column = 0; column < squares.cols; ++column)
      if (const float v = speed.at<float>(row, column); v > kFastest * mean)
        squares.at<cv::Vec2f>(row, column) *= kFastest * mean / v;
  cv::Mat trust = speed / (mean / 2);
  cv::min(trust, 1.0, trust);
  trust = trust.mul(trust);
  squares = sampling::pull_push(squares, trust);
  cv::GaussianBlur(squares, squares, {}, kSmoothing, kSmoothing, cv::BORDER_REPLICATE);
}

/// The motion of patches that play together.
struct Group {
  std::vector<std::uint32_t> squares;        // of the grid: those that the patches lie on
  std::vector<std::vector<cv::Vec2f>> sums;  // by flow frame that is shown: of these squares, weighted
  std::vector<std::uint32_t> shows;          // by output frame: into sums
};

// Frames kept: as many as CarryingField measures, and more as far as they fit into this.
constexpr std::size_t kMinKept = 64, kKeptBytes = 64 << 20;

}  // namespace

struct MotionSequence::Impl {
  SquareGrid grid;
  cv::Mat mass;      // CV_32F: weights of each square
  cv::Mat variance;  // CV_32F: of each patch's motion over time, (px/s)^2, times its weight
  std::vector<Group> groups;
  cv::Size picture;
  double piece_scale = 1;
  cv::Matx23d squares_from_picture;

  struct Kept {
    int frame = -1;
    cv::Mat squares;
  };
  std::mutex mutex;
  std::vector<Kept> kept;  // frame i at i modulo their number

  /// Values of squares in the middles of others, of `step` px.
  cv::Mat sampled(const cv::Mat& of_squares, int step, cv::Size size) const {
    // Sample (x, y) lies in the middle of its square.
    const double middle = (step - 1) / 2.0;
    const cv::Matx33d picture_from_samples(step, 0, middle, 0, step, middle, 0, 0, 1);
    cv::Mat out;
    cv::warpAffine(of_squares, out, squares_from_picture * picture_from_samples, size,
                   cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    return out;
  }

  cv::Mat squares(int i) {
    Kept& place = kept[static_cast<std::size_t>(i) % kept.size()];
    {
      const std::lock_guard lock(mutex);
      if (place.frame == i) return place.squares;
    }
    cv::Mat sums = cv::Mat::zeros(grid.size, CV_32FC2);
    auto* const sum = sums.ptr<cv::Vec2f>();
    for (const Group& group : groups) {
      const std::vector<cv::Vec2f>& shown = group.sums[group.shows[static_cast<std::size_t>(i)]];
      for (std::size_t k = 0; k < shown.size(); ++k) sum[group.squares[k]] += shown[k];
    }
    spread(sums, mass);
    const std::lock_guard lock(mutex);
    place = {i, sums};
    return sums;
  }
};

struct MotionSums::Impl {
  const store::Snapshot& snapshot;
  stored::DecodedTiles* tiles;
  const Placement& placement;
  int flow_step = 0;
  std::size_t frames = 0;
  std::shared_ptr<MotionSequence::Impl> sequence;
};

MotionSums::MotionSums(const store::Snapshot& snapshot, const vision::Settings& settings,
                       const Placement& placement, cv::Size picture, int frames, stored::DecodedTiles* tiles)
    : impl_(std::make_unique<Impl>(Impl{snapshot, tiles, placement, settings.flow_step,
                                        static_cast<std::size_t>(frames),
                                        std::make_shared<MotionSequence::Impl>()})) {
  MotionSequence::Impl& sequence = *impl_->sequence;
  sequence.grid = grid_of(placement, picture);
  sequence.mass = cv::Mat::zeros(sequence.grid.size, CV_32F);
  sequence.variance = sequence.mass.clone();
  sequence.picture = picture;
  sequence.piece_scale = placement.piece_scale;
  const std::size_t fit =
      kKeptBytes / (static_cast<std::size_t>(sequence.grid.size.area()) * sizeof(cv::Vec2f) + 1);
  sequence.kept.resize(std::clamp<std::size_t>(fit, kMinKept, std::max(kMinKept, impl_->frames)));
  sequence.squares_from_picture =
      squares_from_picture(placement, sequence.grid.corner, sequence.grid.square, picture);
}

MotionSums::~MotionSums() = default;

void MotionSums::add(const PlayedPatches& group, const HeldFlow* held) {
  assert(group.shown.size() == impl_->frames);
  MotionSequence::Impl& sequence = *impl_->sequence;
  NeededFlow flow = needed_flow(impl_->snapshot, impl_->tiles, impl_->flow_step, impl_->placement, group);
  if (held) flow.samples &= held->samples;
  const std::vector<Probe> probes = probes_of(group, impl_->placement, sequence.grid, flow);
  for (const Probe& probe : probes) {
    cv::Mat covered = sequence.mass(cv::Rect(probe.corner, sequence.grid.tent.size()));
    covered += sequence.grid.tent;
  }
  // A clip's frames come again and again in a long animation: each is summed once.
  std::vector<ShownFlow> distinct, shown;
  for (const ShownFrame& frame :
       group.shown)  // from the last frame no flow leads on: the one before stands for it
    shown.push_back({std::min(frame.frame, flow.frames - 1), frame.rate});
  distinct = shown;
  std::ranges::sort(distinct);
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  Group& made = sequence.groups.emplace_back();
  made.squares = squares_under(probes, sequence.grid);
  made.sums.resize(distinct.size());
  made.shows.reserve(shown.size());
  for (const ShownFlow& one : shown)
    made.shows.push_back(
        static_cast<std::uint32_t>(std::ranges::lower_bound(distinct, one) - distinct.begin()));
  std::vector<std::size_t> slabs;  // where each begins
  for (std::size_t i = 0; i < distinct.size(); ++i)
    if (i == 0 || distinct[i].at / kSlab != distinct[i - 1].at / kSlab) slabs.push_back(i);
  slabs.push_back(distinct.size());
  std::vector<int> counts(distinct.size(), 0);
  for (const std::uint32_t one : made.shows) ++counts[one];
  using Sums = std::vector<Moments>;
  const Sums moments = oneapi::tbb::parallel_deterministic_reduce(
      oneapi::tbb::blocked_range<std::size_t>(0, slabs.size() - 1),
      Sums(probes.size() * sequence.grid.tent.total()),
      [&](const oneapi::tbb::blocked_range<std::size_t>& range, Sums sum) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const std::size_t from = slabs[i], count = slabs[i + 1] - from;
          sum_slab(std::span(distinct).subspan(from, count), std::span(counts).subspan(from, count), flow,
                   held, probes, sequence.grid, made.squares, std::span(made.sums).subspan(from, count), sum);
        }
        return sum;
      },
      [](Sums sum, const Sums& more) {
        for (std::size_t i = 0; i < sum.size(); ++i) {
          sum[i].sum += more[i].sum;
          sum[i].squares += more[i].squares;
        }
        return sum;
      });
  const int repeats = go_on_through_repeats(distinct, counts, made.sums);  // no patch moves there
  add_variance(moments, probes, static_cast<double>(shown.size()) - repeats, sequence.grid,
               sequence.variance);
}

MotionSequence MotionSums::means() && { return MotionSequence(std::move(impl_->sequence)); }

MotionSequence::MotionSequence(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

std::size_t MotionSequence::bytes() const {
  const std::size_t squares = impl_->grid.size.area() * sizeof(cv::Vec2f);
  std::size_t bytes = impl_->kept.size() * squares;
  for (const Group& group : impl_->groups) {
    bytes += (group.squares.capacity() + group.shows.capacity()) * sizeof(std::uint32_t);
    for (const auto& sum : group.sums) bytes += sum.capacity() * sizeof(cv::Vec2f);
  }
  return bytes;
}

cv::Mat MotionSequence::at(int i) const { return at(i, 1, impl_->picture); }

cv::Mat MotionSequence::at(int i, int step, cv::Size size) const {
  return impl_->sampled(impl_->squares(i) * impl_->piece_scale, step, size);
}

cv::Mat MotionSequence::own_variance(int step, cv::Size size) const {
  const cv::Mat covered = impl_->mass > 0;
  cv::Mat mean, trust;
  cv::divide(impl_->variance, impl_->mass, mean, impl_->piece_scale * impl_->piece_scale);
  mean.setTo(0, ~covered);
  covered.convertTo(trust, CV_32F, 1 / 255.0);
  return impl_->sampled(sampling::pull_push(mean, trust), step, size);
}

}  // namespace freshet::synth::animate
