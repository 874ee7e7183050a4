#include "synth/transfer/transfer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"
#include "platform/random.h"
#include "platform/stopwatch.h"
#include "synth/transfer/exemplar.h"
#include "synth/transfer/features.h"
#include "synth/transfer/forward_warp.h"
#include "synth/transfer/motion_blur.h"
#include "synth/transfer/pixel_grid.h"
#include "synth/transfer/retrieval.h"
#include "synth/transfer/segments.h"
#include "synth/transfer/state_file.h"
#include "synth/transfer/vote.h"

namespace freshet::synth::transfer {
namespace {

constexpr int kMinSide = 24;  // px, of the coarsest level when levels are chosen here

void check_target(const TargetFrame& target, const State& state) {
  const std::string where = fmt::format("target frame {}", state.frame);
  const auto refuse = [&](const std::string& fault) { throw Error(ErrorKind::kInput, where, fault); };
  if (target.alpha.empty() || (target.alpha.type() != CV_8UC1 && target.alpha.type() != CV_32FC1))
    refuse("its alpha is empty or not one channel of 8 or 32 bits");
  if (target.flow.type() != CV_32FC2 || target.flow.size() != target.alpha.size())
    refuse(fmt::format("its flow is {} x {} px, its alpha {} x {}", target.flow.cols, target.flow.rows,
                       target.alpha.cols, target.alpha.rows));
  if (!state.picture.values.empty() &&
      target.alpha.size() != cv::Size(state.picture.width, state.picture.height))
    refuse(fmt::format("it is {} x {} px, the frame before {} x {}", target.alpha.cols, target.alpha.rows,
                       state.picture.width, state.picture.height));
  for (int y = 0; y < target.flow.rows; ++y)
    for (int x = 0; x < target.flow.cols; ++x) {
      const cv::Vec2f by = target.flow.at<cv::Vec2f>(y, x);
      if (!std::isfinite(by[0]) || !std::isfinite(by[1]))
        refuse(fmt::format("its flow is not a number at ({}, {})", x, y));
    }
}

VectorGrid flow_of(const cv::Mat& flow) {
  VectorGrid out(flow.cols, flow.rows);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const cv::Vec2f by = flow.at<cv::Vec2f>(y, x);
      out(x, y) = {by[0], by[1]};
    }
  return out;
}

// With a margin on all sides that repeats the edge, so that a patch around any pixel of the frame is whole.
template <typename T>
GridOf<T> with_margin(const GridOf<T>& grid, int margin) {
  GridOf<T> out(grid.width + 2 * margin, grid.height + 2 * margin);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out(x, y) = grid(std::clamp(x - margin, 0, grid.width - 1), std::clamp(y - margin, 0, grid.height - 1));
  return out;
}

template <typename T>
GridOf<T> without_margin(const GridOf<T>& grid, int margin) {
  GridOf<T> out(grid.width - 2 * margin, grid.height - 2 * margin);
  for (int y = 0; y < out.height; ++y) std::copy_n(grid.row(y + margin) + margin, out.width, out.row(y));
  return out;
}

// The target at one level. Everything has the margin.
struct TargetLevel {
  Grid blurred_alpha, lambda;
  PixelGrid previous;
  Segments segments;
  Features features;  // all but the channels of the frame that is being made
};

// The frame before, as this frame sees it.
struct Past {
  PixelGrid picture;
  Grid lambda;
};

std::vector<TargetLevel> target_levels(Grid blurred_alpha, Past past, std::size_t levels,
                                       const TransferOptions& options) {
  const int margin = options.patch / 2;
  std::vector<TargetLevel> made;
  for (std::size_t k = 0; k < levels; ++k) {
    if (k > 0) {
      blurred_alpha = halved(blurred_alpha);
      past = {halved(past.picture), halved(past.lambda)};
    }
    TargetLevel level;
    level.blurred_alpha = with_margin(blurred_alpha, margin);
    level.lambda = with_margin(past.lambda, margin);
    level.previous = with_margin(past.picture, margin);
    segment(level.blurred_alpha, options.lower, options.upper, margin, level.segments);
    level.features = Features(level.previous.width, level.previous.height);
    put_blurred_alpha(level.blurred_alpha, options.eta, level.features);
    put_previous(level.previous, level.features);
    made.push_back(std::move(level));
  }
  return made;
}

// Sources and targets that are matched with each other.
struct Task {
  const std::vector<int>* sources;
  std::vector<int> targets;
};

// Boundary with boundary, interior with interior; where the exemplar lacks one, everything with the other.
std::vector<Task> tasks_of(const Segments& source, const Segments& target) {
  const std::vector<int>&source_boundary = source[Segment::kBoundary],
        &source_interior = source[Segment::kInterior];
  const std::vector<int>&boundary = target[Segment::kBoundary], &interior = target[Segment::kInterior];
  if (!source_boundary.empty() && !source_interior.empty())
    return {{&source_boundary, boundary}, {&source_interior, interior}};
  // In the order of Segments, as one list.
  Segments all;
  all.of = target.of;
  for (Segment& of : all.of.values)
    if (of == Segment::kBoundary) of = Segment::kInterior;
  list_segments(all);
  return {{source_interior.empty() ? &source_boundary : &source_interior, all[Segment::kInterior]}};
}

// Squares of the exemplar, side by side: averages of patches that have nothing to do with each other would be
// one grey.
PixelGrid random_picture(const ExemplarLevel& source, const TargetLevel& target,
                         const TransferOptions& options, std::uint64_t seed) {
  const int side = options.patch, half = side / 2;
  const std::vector<int>&boundary = source.segments[Segment::kBoundary],
        &interior = source.segments[Segment::kInterior];
  const Random random(seed, 0);
  PixelGrid out(target.previous.width, target.previous.height);
  const int squares = out.width / side + 1;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const double alpha = static_cast<double>(target.blurred_alpha(x, y));
      if (alpha <= options.lower) continue;
      const bool whole = boundary.empty() || (alpha >= options.upper && !interior.empty());
      const std::vector<int>& from = whole ? interior : boundary;
      const std::uint64_t square = static_cast<std::uint64_t>((y / side) * squares + x / side);
      const std::size_t pick = static_cast<std::size_t>(random.bits(square) % from.size());
      const int centre = from[pick];
      out(x, y) = source.now.values[static_cast<std::size_t>(centre + (y % side - half) * source.now.width +
                                                             x % side - half)];
    }
  return out;
}

// Where the previous frame's fluid is most of what is here.
void start_from_past(const TargetLevel& target, double lambda, PixelGrid& picture) {
  for (std::size_t i = 0; i < picture.values.size(); ++i)
    if (static_cast<double>(target.lambda.values[i]) > 0.5 * lambda)
      picture.values[i] = target.previous.values[i];
}

// What the coarser level found, one level finer: patches keep their neighbours.
NearestField refined(const NearestField& coarse, const ExemplarLevel& coarse_source,
                     const ExemplarLevel& source, const TargetLevel& target, int margin) {
  NearestField fine(source.now.width, source.now.height, target.previous.width, target.previous.height);
  for (int y = margin; y < fine.target_height - margin; ++y)
    for (int x = margin; x < fine.target_width - margin; ++x) {
      const int in_x = x - margin, in_y = y - margin;
      const int of = coarse.source[static_cast<std::size_t>((in_y / 2 + margin) * coarse.target_width +
                                                            in_x / 2 + margin)];
      if (of < 0) continue;
      ExemplarLevel::Place at = coarse_source.split(of);
      const cv::Size size = source.sizes[static_cast<std::size_t>(at.turn)];
      at.x = std::clamp(2 * at.x + in_x % 2, margin, size.width - 1 - margin);
      at.y = std::clamp(2 * at.y + in_y % 2, margin, size.height - 1 - margin);
      fine.source[static_cast<std::size_t>(y * fine.target_width + x)] = source.join(at);
    }
  return fine;
}

PixelGrid doubled(const PixelGrid& coarse, int margin, const TargetLevel& target) {
  PixelGrid out(target.previous.width, target.previous.height);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out(x, y) = coarse(std::clamp((x - margin) / 2 + margin, 0, coarse.width - 1),
                         std::clamp((y - margin) / 2 + margin, 0, coarse.height - 1));
  return out;
}

// Where no patch reaches there is nothing.
void clear_uncovered(const NearestField& field, int half, PixelGrid& picture) {
  GridOf<std::uint8_t> covered(picture.width, picture.height, 0);
  for (int y = half; y < picture.height - half; ++y)
    for (int x = half; x < picture.width - half; ++x)
      if (field.source[static_cast<std::size_t>(y * picture.width + x)] >= 0)
        for (int dy = -half; dy <= half; ++dy)
          std::fill_n(covered.row(y + dy) + x - half, 2 * half + 1, std::uint8_t{1});
  for (std::size_t i = 0; i < covered.values.size(); ++i)
    if (!covered.values[i]) picture.values[i] = Pixel{};
}

SegmentUse use_of(const NearestField& field, const std::vector<int>& sources,
                  const std::vector<int>& targets) {
  SegmentUse use;
  use.sources = static_cast<std::int64_t>(sources.size());
  use.targets = static_cast<std::int64_t>(targets.size());
  if (use.sources == 0) return use;
  use.min_uses = use.targets / use.sources;
  use.remainder = use.targets % use.sources;
  std::vector<std::int32_t> used(field.source_places(), 0);
  for (const int target : targets) {
    const std::int32_t source = field.source[static_cast<std::size_t>(target)];
    if (source >= 0) ++used[static_cast<std::size_t>(source)];
  }
  for (const int source : sources) {
    const std::size_t times = static_cast<std::size_t>(used[static_cast<std::size_t>(source)]);
    if (times >= use.sources_used.size()) use.sources_used.resize(times + 1, 0);
    ++use.sources_used[times];
  }
  return use;
}

int levels_for(cv::Size exemplar, cv::Size target, const TransferOptions& options) {
  if (options.levels > 0) return options.levels;
  int side = std::min({exemplar.width, exemplar.height, target.width, target.height}), levels = 1;
  for (; side / 2 >= kMinSide && levels < 10; side /= 2) ++levels;
  return levels;
}

}  // namespace

struct Transfer::Impl {
  Exemplar exemplar;
  TransferOptions options;
  State state;
  // Of the last exemplar, while it stays the same picture.
  ExemplarFrame kept, kept_previous;
  int kept_levels = 0;
  PreparedExemplar prepared;

  void prepare_exemplar(cv::Size target);
  TransferredFrame next(const TargetFrame& target, const std::function<void(double)>& done);
};

void Transfer::Impl::prepare_exemplar(cv::Size target) {
  const ExemplarFrame now = exemplar(state.frame), previous = exemplar(state.frame - 1);
  const int levels = levels_for(now.bgra.size(), target, options);
  if (now.bgra.data != nullptr && kept.bgra.data == now.bgra.data &&
      kept_previous.bgra.data == previous.bgra.data && kept_levels == levels)
    return;
  kept = {};
  prepared = prepare(now, previous, levels, options);
  // Held, so that no other frame comes to lie at the same address.
  kept = now;
  kept_previous = previous;
  kept_levels = levels;
}

TransferredFrame Transfer::Impl::next(const TargetFrame& target, const std::function<void(double)>& done) {
  Stopwatch watch;
  TransferredFrame made;
  made.index = state.frame;
  check_target(target, state);
  prepare_exemplar(target.alpha.size());
  const int margin = options.patch / 2;
  const Grid mask = grid_of(target.alpha);
  const VectorGrid flow = flow_of(target.flow);

  // The past: none before the first frame, whose lambda is 0 (Sec. 4.4).
  const bool first = state.picture.values.empty();
  Past past{PixelGrid(mask.width, mask.height), Grid(mask.width, mask.height)};
  if (!first) {
    WarpedFrame warped = forward_warp(state.picture, state.mask, state.flow);
    past.lambda = local_lambda(mask, warped.mask, options.lambda);
    past.picture = std::move(warped.picture);
  }
  const cv::Mat lambda(mask.height, mask.width, CV_32F, past.lambda.values.data());
  made.lambda = lambda.clone();
  const std::size_t levels = prepared.levels.size();
  std::vector<TargetLevel> targets =
      target_levels(blurred(mask, options.radius), std::move(past), levels, options);
  made.seconds.prepare += watch.lap();

  double work = 0, worked = 0;
  for (const TargetLevel& level : targets) work += static_cast<double>(level.lambda.values.size());
  const std::uint64_t frame_seed = scramble(options.seed ^ scramble(static_cast<std::uint64_t>(state.frame)));
  PixelGrid picture;
  NearestField field;
  for (std::size_t k = levels; k-- > 0;) {
    const ExemplarLevel& source = prepared.levels[k];
    TargetLevel& level = targets[k];
    if (k + 1 == levels) {
      field = NearestField(source.now.width, source.now.height, level.previous.width, level.previous.height);
      picture = random_picture(source, level, options, frame_seed);
      if (options.start == Start::kWarped && !first) start_from_past(level, options.lambda, picture);
    } else {
      field = refined(field, prepared.levels[k + 1], source, level, margin);
      picture = doubled(picture, margin, level);
      vote(source.now, field, options.patch, options.vote_power, picture);
    }
    const std::vector<Task> tasks = tasks_of(source.segments, level.segments);
    const PatchDistance distance(source.features, level.features, level.lambda.values, options.patch);
    for (int iteration = 0; iteration < options.iterations; ++iteration) {
      put_now(picture, level.features);
      // A place that no task has keeps no patch of a coarser level's.
      if (iteration == 0)
        for (std::size_t i = 0; i < field.source.size(); ++i)
          if (level.segments.of.values[i] == Segment::kNone) field.source[i] = -1;
      made.seconds.prepare += watch.lap();
      RetrievalOptions retrieval{options.search, options.passes,
                                 scramble(frame_seed + 100 * k + static_cast<std::size_t>(iteration))};
      RetrievalSeconds seconds;
      for (const Task& task : tasks) {
        if (options.retrieval == Retrieval::kUniform)
          assign_uniformly(distance, *task.sources, task.targets, retrieval, field, seconds);
        else
          assign_nearest(distance, *task.sources, task.targets, retrieval, field, seconds);
      }
      made.seconds.search += seconds.search;
      made.seconds.assign += seconds.assign;
      watch.lap();
      vote(source.now, field, options.patch, options.vote_power, picture);
      if (iteration + 1 == options.iterations) clear_uncovered(field, margin, picture);
      made.seconds.vote += watch.lap();
      worked += static_cast<double>(level.lambda.values.size()) / options.iterations;
      if (done) done(worked / work);
    }
  }

  const ExemplarLevel& source = prepared.levels[0];
  const TargetLevel& level = targets[0];
  const Segments &from = source.segments, &to = level.segments;
  if (from[Segment::kBoundary].empty() || from[Segment::kInterior].empty()) {
    const bool no_boundary = from[Segment::kBoundary].empty();
    made.remarks.push_back(fmt::format("the exemplar has no {}: its {} is used for both",
                                       no_boundary ? "boundary" : "interior",
                                       no_boundary ? "interior" : "boundary"));
    const Task task = tasks_of(from, to)[0];
    (no_boundary ? made.interior : made.boundary) = use_of(field, *task.sources, task.targets);
  } else {
    made.boundary = use_of(field, from[Segment::kBoundary], to[Segment::kBoundary]);
    made.interior = use_of(field, from[Segment::kInterior], to[Segment::kInterior]);
  }
  made.nearest = cv::Mat(mask.height, mask.width, CV_32SC3, cv::Scalar::all(-1));
  made.distance = cv::Mat(mask.height, mask.width, CV_32F, cv::Scalar::all(0));
  std::int64_t patches = 0;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      const std::size_t at = static_cast<std::size_t>((y + margin) * field.target_width + x + margin);
      if (field.source[at] < 0) continue;
      const ExemplarLevel::Place place = source.split(field.source[at]);
      const int of[3] = {place.x, place.y, place.turn};
      // Back to the exemplar as it was given: (x, y) of a picture turned once lies at (w - 1 - y, x) of it.
      int px = of[0], py = of[1];
      for (int turn = place.turn; turn > 0; --turn) {
        const cv::Size before = source.sizes[static_cast<std::size_t>(turn - 1)];
        const int turned_x = px;
        px = before.width - 1 - py;
        py = turned_x;
      }
      made.nearest.at<cv::Vec3i>(y, x) = {px, py, place.turn};
      made.distance.at<float>(y, x) = field.distance[at];
      made.mean_distance += static_cast<double>(field.distance[at]);
      made.violations += from.of.values[static_cast<std::size_t>(field.source[at])] != to.of.values[at];
      ++patches;
    }
  if (patches > 0) made.mean_distance /= static_cast<double>(patches);
  if (patches == 0) made.remarks.push_back("the target's mask is empty: the frame is transparent");

  picture = without_margin(picture, margin);
  PixelGrid shown = picture;
  if (prepared.opaque) {
    made.remarks.push_back("the exemplar is opaque: the frame's alpha is the target's");
    for (std::size_t i = 0; i < shown.values.size(); ++i)
      for (float& value : shown.values[i].c) value *= mask.values[i];
  }
  made.seconds.prepare += watch.lap();
  if (options.motion_blur > 0) shown = blurred_along(shown, flow, options.motion_blur);
  made.bgra = straight(shown);
  made.seconds.blur += watch.lap();
  state = {state.frame + 1, std::move(picture), mask, flow};
  return made;
}

Transfer::Transfer(Exemplar exemplar, const TransferOptions& options) : impl_(std::make_unique<Impl>()) {
  check(options);
  impl_->exemplar = std::move(exemplar);
  impl_->options = options;
}
Transfer::Transfer(Transfer&&) noexcept = default;
Transfer& Transfer::operator=(Transfer&&) noexcept = default;
Transfer::~Transfer() = default;

int Transfer::frame() const { return impl_->state.frame; }

TransferredFrame Transfer::next(const TargetFrame& target, const std::function<void(double fraction)>& done) {
  return impl_->next(target, done);
}

void Transfer::save_state(const std::filesystem::path& path) const {
  write_state(path, impl_->state, impl_->options);
}

void Transfer::load_state(const std::filesystem::path& path) {
  impl_->state = read_state(path, impl_->options);
}

}  // namespace freshet::synth::transfer
