#include "bench/transfer/rivals/rivals.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "bench/transfer/rivals/retrievals.h"
#include "bench/transfer/rivals/votes.h"
#include "platform/random.h"
#include "synth/transfer/draft.h"
#include "synth/transfer/exemplar.h"
#include "synth/transfer/forward_warp.h"
#include "synth/transfer/frame_report.h"
#include "synth/transfer/target_level.h"
#include "synth/transfer/vote.h"

namespace freshet::bench {
namespace {

using namespace synth::transfer;
using synth::Grid;

const TransferOptions kOptions{.vote_power = 0.6, .retrieval = Retrieval::kNearest};
constexpr int kLevels = 3;  // of pictures whose exemplar is half as high as their frame

void make_one(Segments& segments) {
  for (Segment& of : segments.of.values)
    if (of == Segment::kBoundary) of = Segment::kInterior;
  list_segments(segments);
}

/// One level's retrieval and vote, by turns.
void improve(Rival method, const ExemplarLevel& source, TargetLevel& target, const TransferOptions& options,
             std::uint64_t seed, Draft& draft) {
  const int patch = options.patch;
  const cv::Size source_size(source.now.width, source.now.height);
  const PatchDistance distance(source.features, target.features, target.lambda.values, patch);
  const std::vector<Task> tasks = tasks_of(source.segments, target.segments);
  std::vector<std::int32_t> alike;
  if (method == Rival::kDiscrete) {
    const std::vector<float> none(source.now.values.size(), 0.0f);
    const PatchDistance to_itself(source.features, source.features, none, patch);
    alike.assign(none.size(), -1);
    for (const Task& task : tasks) {
      const auto of_task = most_alike(to_itself, task.sources, source_size, patch, options.passes, seed);
      for (const int place : task.sources)
        alike[static_cast<std::size_t>(place)] = of_task[static_cast<std::size_t>(place)];
    }
  }
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    put_now(draft.picture, target.features);
    const RetrievalOptions retrieval{.passes = options.passes,
                                     .seed = scramble(seed + static_cast<std::uint64_t>(iteration))};
    std::vector<Completing> pairs;
    RetrievalSeconds seconds;
    for (std::size_t i = 0; i < draft.field.source.size(); ++i)
      if (target.segments.of.values[i] == Segment::kNone) draft.field.source[i] = -1;
    for (const Task& task : tasks) {
      if (task.targets.empty()) continue;
      if (method == Rival::kDiscrete)
        assign_coherent(distance, task.sources, task.targets, alike, patch, retrieval, draft.field);
      else if (method == Rival::kOccurrences)
        assign_limited(distance, task.sources, task.targets, retrieval, draft.field);
      else if (method == Rival::kBenard)
        assign_by_histogram(distance, task.sources, task.targets, retrieval, draft.field);
      else
        assign_nearest(distance, task.sources, task.targets, retrieval, draft.field, seconds);
      if (method == Rival::kBidirectional)
        add_completing(distance, task.sources, task.targets, retrieval, draft.field, options.vote_power,
                       pairs);
    }
    if (method == Rival::kDiscrete)
      vote_discrete(source.now, draft.field, patch, options.vote_power, draft.picture);
    else if (method == Rival::kBidirectional)
      vote_bidirectional(source.now, draft.field, pairs, patch, options.vote_power, draft.picture);
    else
      vote(source.now, draft.field, patch, options.vote_power, draft.picture);
    if (iteration + 1 == options.iterations) clear_uncovered(draft.field, patch / 2, draft.picture);
  }
}

/// From the coarsest level to the finest.
Draft optimised(Rival method, const PreparedExemplar& exemplar, std::vector<TargetLevel>& targets,
                const TransferOptions& options, std::uint64_t seed) {
  Draft draft = random_draft(exemplar.levels[targets.size() - 1], targets.back(), options, seed);
  start_from_past(targets.back(), options.lambda, draft.picture);
  for (std::size_t k = targets.size(); k-- > 0;) {
    if (k + 1 < targets.size())
      draft = refined(draft, exemplar.levels[k + 1], exemplar.levels[k], targets[k], options);
    improve(method, exemplar.levels[k], targets[k], options, seed + 100 * k, draft);
  }
  return draft;
}

/// The frame within its margin; of an opaque exemplar with the target's alpha.
cv::Mat shown(const PixelGrid& picture, bool opaque, const Grid& mask) {
  PixelGrid seen = picture;
  if (opaque)
    for (std::size_t i = 0; i < seen.values.size(); ++i)
      for (float& value : seen.values[i].c) value *= mask.values[i];
  return straight(seen);
}

/// Frame by frame: each begins from the one before.
class Optimised {
 public:
  Optimised(Rival method, Exemplar exemplar) : method_(method), exemplar_(std::move(exemplar)) {}

  TransferredFrame next(const TargetFrame& target, int t) {
    PreparedExemplar exemplar = prepare(exemplar_(t), exemplar_(t - 1), kLevels, kOptions);
    const Grid mask = grid_of(target.alpha);
    Past past{PixelGrid(mask.width, mask.height), Grid(mask.width, mask.height), {}};
    if (t > 0) {
      WarpedFrame warped = forward_warp(before_, mask_before_, flow_before_);
      past.lambda = local_lambda(mask, warped.mask, kOptions.lambda);
      past.picture = std::move(warped.picture);
    }
    std::vector<TargetLevel> targets =
        target_levels(blurred(mask, kOptions.radius), {}, past, exemplar.levels.size(), kOptions);
    if (method_ == Rival::kBenard) {
      for (ExemplarLevel& level : exemplar.levels) make_one(level.segments);
      for (TargetLevel& level : targets) make_one(level.segments);
    }
    const Draft draft =
        optimised(method_, exemplar, targets, kOptions, scramble(static_cast<std::uint64_t>(t) + 1));
    TransferredFrame made;
    made.index = t;
    const int margin = kOptions.patch / 2;
    report_use(draft.field, exemplar.levels[0].segments, targets[0].segments, made);
    report_nearest(draft.field, exemplar.levels[0], targets[0].segments, margin, made);
    before_ = without_margin(draft.picture, margin);
    mask_before_ = mask;
    flow_before_ = vectors_of(target.flow);
    made.bgra = shown(before_, exemplar.opaque, mask);
    return made;
  }

 private:
  Rival method_;
  Exemplar exemplar_;
  PixelGrid before_;
  Grid mask_before_;
  synth::VectorGrid flow_before_;
};

cv::Mat mat_of(const PixelGrid& picture) {
  cv::Mat out(picture.height, picture.width, CV_32FC4);
  std::copy_n(&picture.values[0].c[0], 4 * picture.values.size(), out.ptr<float>());
  return out;
}

/// Keyframes, each by itself, and what lies between two.
class Keyframed {
 public:
  Keyframed(Exemplar exemplar, const std::vector<TargetFrame>& design)
      : exemplar_(std::move(exemplar)), design_(&design) {}

  TransferredFrame next(std::size_t t) {
    const std::size_t from = t / kKeyStep * kKeyStep, to = std::min(from + kKeyStep, design_->size() - 1);
    if (t == from) keys_[0] = t == at_ && t > 0 ? keys_[1] : key(t);
    if (t == from && to > from) keys_[1] = key(to), at_ = to;
    TransferredFrame made;
    made.index = static_cast<int>(t);
    made.bgra = t == from ? keys_[0] : t == to ? keys_[1] : between(t, from, to);
    return made;
  }

 private:
  cv::Mat key(std::size_t t) const {
    Transfer transfer([&](int) { return exemplar_(static_cast<int>(t)); },
                      {.lambda = 0, .start = Start::kRandom, .seed = t + 1});
    return transfer.next((*design_)[t]).bgra;
  }

  cv::Mat between(std::size_t t, std::size_t from, std::size_t to) const {
    const double share = static_cast<double>(t - from) / static_cast<double>(to - from);
    const auto carried_key = [&](const cv::Mat& key, std::size_t at) {
      cv::Mat out;
      cv::remap(mat_of(premultiplied(key)), out, carried_places(*design_, t, at), cv::noArray(),
                cv::INTER_LINEAR, cv::BORDER_CONSTANT);
      return out;
    };
    cv::Mat blend;
    cv::addWeighted(carried_key(keys_[0], from), 1 - share, carried_key(keys_[1], to), share, 0, blend);
    Past past{PixelGrid(blend.cols, blend.rows), Grid(blend.cols, blend.rows), {}};
    std::copy_n(blend.ptr<float>(), blend.total() * 4, &past.picture.values[0].c[0]);
    const Grid mask = grid_of((*design_)[t].alpha);
    TransferOptions options = kOptions;
    options.vote_power = TransferOptions().vote_power;
    std::fill(past.lambda.values.begin(), past.lambda.values.end(), static_cast<float>(options.lambda));

    // Both keyframes, one below the other, with nothing between.
    const cv::Mat nothing(cvRound(6 * options.radius), blend.cols, CV_32FC4, cv::Scalar::all(0));
    cv::Mat both;
    cv::vconcat(std::vector{keys_[0], nothing, keys_[1]}, both);
    const Grid alpha = blurred(alpha_of(premultiplied(both)), options.radius);
    if (*std::max_element(alpha.values.begin(), alpha.values.end()) < 0.5f) return straight(past.picture);
    const PreparedExemplar keys = prepare({both}, {both}, 2, options);
    std::vector<TargetLevel> targets =
        target_levels(blurred(mask, options.radius), {}, past, keys.levels.size(), options);
    const Draft draft = optimised(Rival::kBrowning, keys, targets, options, scramble(t + 1));
    return straight(without_margin(draft.picture, options.patch / 2));
  }

  Exemplar exemplar_;
  const std::vector<TargetFrame>* design_;
  cv::Mat keys_[2];
  std::size_t at_ = 0;  // of the second
};

}  // namespace

cv::Mat carried_places(const std::vector<TargetFrame>& design, std::size_t t, std::size_t at) {
  const cv::Size size = design[t].flow.size();
  cv::Mat places(size, CV_32FC2), step;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      places.at<cv::Vec2f>(y, x) = {static_cast<float>(x), static_cast<float>(y)};
  while (t != at) {
    const bool back = at < t;
    if (back) --t;
    cv::remap(design[t].flow, step, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    if (back)
      places -= step;
    else
      places += step;
    if (!back) ++t;
  }
  return places;
}

std::function<TransferredFrame(std::size_t t)> rival(Rival method, Exemplar exemplar,
                                                     const std::vector<TargetFrame>& design) {
  if (method == Rival::kBrowning) {
    auto keyframed = std::make_shared<Keyframed>(std::move(exemplar), design);
    return [keyframed](std::size_t t) { return keyframed->next(t); };
  }
  auto optimised = std::make_shared<Optimised>(method, std::move(exemplar));
  return [optimised, &design](std::size_t t) { return optimised->next(design[t], static_cast<int>(t)); };
}

}  // namespace freshet::bench
