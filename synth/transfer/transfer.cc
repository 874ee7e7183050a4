#include "synth/transfer/transfer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"
#include "platform/random.h"
#include "synth/transfer/draft.h"
#include "synth/transfer/exemplar.h"
#include "synth/transfer/features.h"
#include "synth/transfer/forward_warp.h"
#include "synth/transfer/frame_report.h"
#include "synth/transfer/motion_blur.h"
#include "synth/transfer/pixel_grid.h"
#include "synth/transfer/retrieval.h"
#include "synth/transfer/segments.h"
#include "synth/transfer/state_file.h"
#include "synth/transfer/target_level.h"
#include "synth/transfer/vote.h"

namespace freshet::synth::transfer {
namespace {

constexpr int kMaxTile = 32;  // px, at full size, where only a part of the exemplar is used
constexpr int kMinTile = 4;
constexpr unsigned kLeastTiles = 6;  // in a part, where tiles are not of the least size
constexpr int kMinSide = 24;         // px, of the coarsest level when levels are chosen here

/// Where a frame's time goes: what has passed since the last call is added to one of its seconds.
class FrameClock {
 public:
  explicit FrameClock(TransferSeconds& seconds) : seconds_(seconds) {}
  void add_to(double TransferSeconds::*stage) {
    const auto now = std::chrono::steady_clock::now();
    seconds_.*stage += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  /// What has passed has been counted by others.
  void restart() { last_ = std::chrono::steady_clock::now(); }
  TransferSeconds& seconds() { return seconds_; }

 private:
  TransferSeconds& seconds_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

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

// Each place begins with the source patch that the frame before carried to it. The search may leave it again. The
// search does not find this start by itself: it exchanges the sources of two places at a time, and a texture of which
// only some patches have moved on by a px fits worse than one of which none or all have.
void begin_at(std::span<const std::int32_t> hints, NearestField& field) {
  for (std::size_t i = 0; i < hints.size(); ++i)
    if (hints[i] >= 0) field.source[i] = hints[i];
}

// A place that no task has keeps no patch of a coarser level's.
void leave_unsegmented(const Segments& target, NearestField& field) {
  for (std::size_t i = 0; i < field.source.size(); ++i)
    if (target.of.values[i] == Segment::kNone) field.source[i] = -1;
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

  bool first() const { return state.picture.values.empty(); }
  TransferredFrame next(const TargetFrame& target, const std::function<void(double)>& done);
  // Its steps.
  void prepare_exemplar(cv::Size target);
  Past past_of(const Grid& mask) const;
  int iterations_at(std::size_t level) const;
  Draft begun(const TargetLevel& coarsest, std::uint64_t seed) const;
  std::vector<Task> tasks_at(std::size_t level, const Segments& target) const;
  void improve(std::size_t level, std::span<const std::int32_t> hints, TargetLevel& target,
               std::uint64_t seed, Draft& draft, FrameClock& clock, const std::function<void()>& done) const;
  void retrieve(const std::vector<Task>& tasks, const PatchDistance& distance,
                const RetrievalOptions& retrieval, NearestField& field, TransferSeconds& seconds) const;
  PixelGrid shown(const PixelGrid& picture, const Grid& mask) const;
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

// None before the first frame, whose lambda is 0 (Sec. 4.4).
Past Transfer::Impl::past_of(const Grid& mask) const {
  const int width = mask.width, height = mask.height;
  if (first())
    return {PixelGrid(width, height), Grid(width, height), GridOf<std::int32_t>(width, height, -1)};
  WarpedFrame warped = forward_warp(state.picture, state.mask, state.flow);
  Past past{std::move(warped.picture), local_lambda(mask, warped.mask, options.lambda),
            GridOf<std::int32_t>(width, height, -1)};
  if (options.start == Start::kRandom) return past;
  past.sources = carried(state.sources, state.flow);
  follow(prepared, past.sources);
  for (std::size_t i = 0; i < past.sources.values.size(); ++i)
    if (!has_past(past.lambda.values[i], options.lambda)) past.sources.values[i] = -1;
  return past;
}

// With a past a frame has only to be finished at full size, where most of the time goes.
int Transfer::Impl::iterations_at(std::size_t level) const {
  return level > 0 || first() ? options.iterations : std::max(1, options.iterations / 2);
}

Draft Transfer::Impl::begun(const TargetLevel& coarsest, std::uint64_t seed) const {
  Draft draft = random_draft(prepared.levels.back(), coarsest, options, seed);
  if (options.start == Start::kWarped && !first()) start_from_past(coarsest, options.lambda, draft.picture);
  return draft;
}

// Uniform use of fewer targets than sources is of a part of them.
std::vector<Task> Transfer::Impl::tasks_at(std::size_t level, const Segments& target) const {
  const ExemplarLevel& source = prepared.levels[level];
  std::vector<Task> tasks = tasks_of(source.segments, target);
  if (options.retrieval != Retrieval::kUniform) return tasks;
  for (Task& task : tasks) {
    const std::size_t count = task.targets.size();
    if (count == 0 || count >= task.sources.size()) continue;
    const double side = std::sqrt(static_cast<double>(count / kLeastTiles));
    const int tile = std::clamp(static_cast<int>(std::bit_floor(static_cast<unsigned>(side))), kMinTile,
                                std::max(kMinTile, kMaxTile >> level));
    task.sources = part_of(task.sources, source.now.width, count, tile, options.seed);
  }
  return tasks;
}

// Retrieval and vote, by turns, at one level. done() after each turn.
// hints: what the frame before had, by place; tried once.
void Transfer::Impl::improve(std::size_t level, std::span<const std::int32_t> hints, TargetLevel& target,
                             std::uint64_t seed, Draft& draft, FrameClock& clock,
                             const std::function<void()>& done) const {
  const ExemplarLevel& source = prepared.levels[level];
  const int iterations = iterations_at(level);
  const std::vector<Task> tasks = tasks_at(level, target.segments);
  const PatchDistance distance(source.features, target.features, target.lambda.values, options.patch);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    put_now(draft.picture, target.features);
    if (iteration == 0 && !prepared.back.empty()) begin_at(hints, draft.field);
    if (iteration == 0) leave_unsegmented(target.segments, draft.field);
    clock.add_to(&TransferSeconds::prepare);
    retrieve(tasks, distance,
             {.search = options.search,
              .passes = options.passes,
              .seed = scramble(seed + static_cast<std::size_t>(iteration)),
              .hints = iteration == 0 ? hints : std::span<const std::int32_t>()},
             draft.field, clock.seconds());
    clock.restart();
    vote(source.now, draft.field, options.patch, options.vote_power, draft.picture);
    if (iteration + 1 == iterations) clear_uncovered(draft.field, options.patch / 2, draft.picture);
    clock.add_to(&TransferSeconds::vote);
    done();
  }
}

void Transfer::Impl::retrieve(const std::vector<Task>& tasks, const PatchDistance& distance,
                              const RetrievalOptions& retrieval, NearestField& field,
                              TransferSeconds& seconds) const {
  const auto assign = options.retrieval == Retrieval::kUniform ? assign_uniformly : assign_nearest;
  RetrievalSeconds spent;
  for (const Task& task : tasks) assign(distance, task.sources, task.targets, retrieval, field, spent);
  seconds.search += spent.search;
  seconds.assign += spent.assign;
}

// An opaque exemplar says nothing about alpha: the target's is taken.
PixelGrid Transfer::Impl::shown(const PixelGrid& picture, const Grid& mask) const {
  PixelGrid shown = picture;
  if (prepared.opaque)
    for (std::size_t i = 0; i < shown.values.size(); ++i)
      for (float& value : shown.values[i].c) value *= mask.values[i];
  return shown;
}

TransferredFrame Transfer::Impl::next(const TargetFrame& target, const std::function<void(double)>& done) {
  TransferredFrame made;
  made.index = state.frame;
  FrameClock clock(made.seconds);

  // The exemplar, the design and the frame before, at every level.
  check_target(target, state);
  prepare_exemplar(target.alpha.size());
  const Grid mask = grid_of(target.alpha);
  const VectorGrid flow = vectors_of(target.flow);
  Past past = past_of(mask);
  made.lambda = cv::Mat(mask.height, mask.width, CV_32F, past.lambda.values.data()).clone();
  const std::size_t levels = prepared.levels.size();
  std::vector<TargetLevel> targets =
      target_levels(blurred(mask, options.radius),
                    guided(options) ? guides_of(mask, flow, options) : Guides(), past, levels, options);
  clock.add_to(&TransferSeconds::prepare);

  // From the coarsest level to the finest.
  double work = 0, worked = 0;
  for (const TargetLevel& level : targets) work += static_cast<double>(level.lambda.values.size());
  const std::uint64_t seed = scramble(options.seed ^ scramble(static_cast<std::uint64_t>(state.frame)));
  Draft draft = begun(targets.back(), seed);
  for (std::size_t k = levels; k-- > 0;) {
    if (k + 1 < levels)
      draft = refined(draft, prepared.levels[k + 1], prepared.levels[k], targets[k], options);
    const std::vector<std::int32_t> hints =
        carried_sources(past.sources, prepared.levels.front(), prepared.levels[k], static_cast<int>(k),
                        {targets[k].lambda.width, targets[k].lambda.height}, options.patch / 2);
    improve(k, hints, targets[k], seed + 100 * k, draft, clock, [&] {
      worked += static_cast<double>(targets[k].lambda.values.size()) / iterations_at(k);
      if (done) done(worked / work);
    });
  }

  // What it is made of.
  const int margin = options.patch / 2;
  const ExemplarLevel& source = prepared.levels.front();
  report_use(draft.field, source.segments, targets.front().segments, made);
  report_nearest(draft.field, source, targets.front().segments, margin, made);
  if (prepared.opaque) made.remarks.push_back("the exemplar is opaque: the frame's alpha is the target's");

  // The frame, and what the next one needs of it.
  PixelGrid picture = without_margin(draft.picture, margin);
  PixelGrid seen = shown(picture, mask);
  clock.add_to(&TransferSeconds::prepare);
  if (options.motion_blur > 0) seen = blurred_along(seen, flow, options.motion_blur);
  made.bgra = straight(seen);
  clock.add_to(&TransferSeconds::blur);
  GridOf<std::int32_t> sources(draft.picture.width, draft.picture.height);
  sources.values = std::move(draft.field.source);
  state = {state.frame + 1, std::move(picture), mask, flow, without_margin(sources, margin)};
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
