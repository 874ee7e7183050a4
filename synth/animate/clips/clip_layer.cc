#include "synth/animate/clips/clip_layer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "platform/vectors.h"
#include "stored/clip_loop.h"
#include "stored/clip_schema.h"
#include "synth/sampling/cells.h"

namespace freshet::synth::animate {
namespace {

constexpr std::uint32_t kChunk = 32;  // frames read at once in the first pass: two slabs of tiles
constexpr int kFlowMargin = 16;       // px of the source around a patch that flow may reach for
const cv::Size kCell(ClipLuma::kCellWidth, ClipLuma::kCellHeight);

std::vector<sampling::PatchWindow> windows_of(cv::Size source, const Placement& placement,
                                              std::span<const std::size_t> patches) {
  std::vector<sampling::PatchWindow> windows;
  for (std::size_t p : patches)
    windows.emplace_back(source, placement.patches[p].variant, placement.patches[p].patch, placement.side);
  return windows;
}

std::vector<cv::Rect> needed_by(std::span<const sampling::PatchWindow> windows, int margin, cv::Size source) {
  std::vector<cv::Rect> needed;
  for (const sampling::PatchWindow& window : windows) {
    const cv::Rect own = window.needed();
    needed.push_back(
        cv::Rect(own.x - margin, own.y - margin, own.width + 2 * margin, own.height + 2 * margin) &
        cv::Rect({}, source));
  }
  return needed;
}

ClipLuma::Size size_for(ClipDetail detail) {
  return detail == ClipDetail::kInnovation ? ClipLuma::Size::kHalf : ClipLuma::Size::kWhole;
}

cv::Size source_of(const store::ClipRecord& record, ClipDetail detail) {
  return ClipLuma::size_of({static_cast<int>(record.width), static_cast<int>(record.height)},
                           size_for(detail));
}

int margin_of(Resampling resampling, ClipDetail detail) {
  if (detail == ClipDetail::kInnovation) return kFlowMargin / 2;
  return resampling == Resampling::kFlow ? kFlowMargin : 0;
}

FRESHET_WIDE void add_weighed(const float* from, float weight, int n, float* to) {
  for (int i = 0; i < n; ++i) to[i] += weight * from[i];
}

FRESHET_WIDE void weigh_difference(const float* from, const float* less, float weight, int n, float* to) {
  for (int i = 0; i < n; ++i) to[i] = weight * (from[i] - less[i]);
}

FRESHET_WIDE void add_difference(const float* from, const float* less, float weight, int n, float* to) {
  for (int i = 0; i < n; ++i) to[i] += weight * (from[i] - less[i]);
}

std::uint32_t nearest_frame(double moment) { return static_cast<std::uint32_t>(std::lround(moment)); }

}  // namespace

ClipLayer::ClipLayer(const store::Snapshot& snapshot, store::ClipId clip, int flow_step,
                     const Placement& placement, std::vector<std::size_t> patches,
                     const playing::TimelineOptions& options, Resampling resampling, ClipDetail detail,
                     stored::DecodedTiles* tiles)
    : placement_(placement),
      patches_(std::move(patches)),
      windows_(windows_of(source_of(snapshot.clip(clip), detail), placement, patches_)),
      luma_(snapshot, clip, size_for(detail),
            needed_by(windows_, margin_of(resampling, detail), source_of(snapshot.clip(clip), detail)),
            flow_step, tiles),
      detail_(detail) {
  const store::ClipRecord& record = snapshot.clip(clip);
  frame_count_ = record.frame_count;
  const std::vector<double> times = stored::kFrameTime.read(snapshot, clip);
  if (times.empty() || !std::is_sorted(times.begin(), times.end()))
    throw Error(ErrorKind::kDamaged, record.name, "its frame times are not in order",
                "Run freshet store verify");
  const double interval = static_cast<double>(record.fps_den) / static_cast<double>(record.fps_num);
  std::map<double, std::vector<std::size_t>> by_speed;
  for (std::size_t i = 0; i < patches_.size(); ++i)
    by_speed[placement.patches[patches_[i]].speed].push_back(i);
  const double longest =
      (options.frames - 1) * (by_speed.rbegin()->first / options.fps);  // as Timeline has it
  std::optional<vision::LoopRule> rule;
  if (options.loop || longest > times.back() - times.front() + interval)
    rule = stored::loop_rule(snapshot, clip);
  for (auto& [speed, members] : by_speed) {
    playing::TimelineOptions own = options;
    own.speed = speed;
    own.whole = resampling == Resampling::kNearest;
    SpeedGroup& group = groups_.emplace_back();
    group.members = std::move(members);
    group.moments = playing::timeline(times, interval, rule, record.name, own);
    lay_out(group);
  }
  if (detail_ == ClipDetail::kDifference) return;
  for (SpeedGroup& group : groups_) {
    std::vector<std::size_t> of_group;
    for (const std::size_t member : group.members) of_group.push_back(patches_[member]);
    group.levels.emplace(luma_.source(), placement, of_group, group.moments);
  }
}

/// What of the clip's frames a speed group's patches are made of, exactly.
void ClipLayer::lay_out(SpeedGroup& group) const {
  std::map<float, std::vector<std::size_t>> by_scale;
  for (std::size_t i : group.members) by_scale[placement_.patches[patches_[i]].variant.scale].push_back(i);
  std::vector<cv::Rect> needed;
  for (auto& [scale, members] : by_scale) {
    const cv::Size size = sampling::reduced_to_scale(luma_.source(), scale);
    std::vector<cv::Rect> read;
    for (std::size_t i : members) read.push_back(windows_[i].read());
    if (size == luma_.source()) {
      needed.insert(needed.end(), read.begin(), read.end());
      group.whole.insert(group.whole.end(), members.begin(), members.end());
      continue;
    }
    Reduced reduced{.reduction = sampling::AreaReduction(luma_.source(), size),
                    .cells = sampling::cells_touched(read, cv::Rect({}, size), kCell),
                    .members = std::move(members)};
    for (const cv::Rect& cell : reduced.cells) needed.push_back(reduced.reduction.source_of(cell));
    group.reduced.push_back(std::move(reduced));
  }
  group.cells = sampling::cells_touched(needed, cv::Rect({}, luma_.source()), kCell);
  for (cv::Rect& cell : group.cells) cell &= luma_.region();
}

std::vector<ClipLayer::Played> ClipLayer::played() const {
  std::vector<Played> played;
  for (const SpeedGroup& group : groups_) {
    played.push_back({.patches = {}, .moments = group.moments});
    for (std::size_t member : group.members) played.back().patches.push_back(patches_[member]);
  }
  return played;
}

void ClipLayer::each_level(const std::function<void(std::size_t, int, float)>& use) const {
  for (const SpeedGroup& group : groups_)
    oneapi::tbb::parallel_for(std::size_t{0}, group.members.size(), [&](std::size_t i) {
      for (std::size_t output = 0; output < group.moments.size(); ++output)
        use(patches_[group.members[i]], static_cast<int>(output),
            group.levels->at(i, static_cast<int>(output)));
    });
}

std::size_t ClipLayer::average_bytes() const {
  if (detail_ == ClipDetail::kInnovation) return 0;
  return groups_.size() * luma_.region().area() * sizeof(float);
}

std::size_t ClipLayer::bytes_per_output() const {
  std::size_t bytes = 0;
  for (const SpeedGroup& group : groups_) {
    std::set<std::uint32_t> distinct;
    bool flow = false;
    for (const playing::Moment& moment : group.moments) {
      playing::each_frame(moment, [&](std::uint32_t frame, double) { distinct.insert(frame); });
      flow = flow || moment.at[0] != std::floor(moment.at[0]);
    }
    const double frames = std::min(3.0, 1 + static_cast<double>(distinct.size()) / group.moments.size());
    bytes += static_cast<std::size_t>(frames * (luma_.frame_bytes() + (flow ? luma_.flow_bytes() : 0)));
  }
  return bytes;
}

void ClipLayer::load(std::span<const int> outputs, std::span<const std::uint32_t> more) {
  const TimedScope reading(read_s_);
  std::set<std::uint32_t> frames(more.begin(), more.end()), flows;
  for (const SpeedGroup& group : groups_)
    for (int output : outputs) {
      const playing::Moment& moment = group.moments[output];
      playing::each_frame(moment, [&](std::uint32_t frame, double) { frames.insert(frame); });
      for (int i = 0; i < moment.count(); ++i)
        if (moment.at[i] != std::floor(moment.at[i])) flows.insert(static_cast<std::uint32_t>(moment.at[i]));
      for (int i = 0; detail_ == ClipDetail::kInnovation && i < moment.count(); ++i) {
        const std::uint32_t frame = nearest_frame(moment.at[i]);
        frames.insert(frame);
        if (frame > 0) frames.insert(frame - 1), flows.insert(frame - 1);
        if (frame + 1 < frame_count_) frames.insert(frame + 1), flows.insert(frame);
      }
    }
  luma_.load(std::vector(frames.begin(), frames.end()), std::vector(flows.begin(), flows.end()));
}

/// Those of the outputs that need no clip frame after this one.
std::vector<int> ClipLayer::shown_by(std::uint32_t frame, std::span<const int> outputs) const {
  std::vector<int> shown;
  for (int output : outputs) {
    bool past = true;
    for (const SpeedGroup& group : groups_)
      playing::each_frame(group.moments[output],
                          [&](std::uint32_t needed, double) { past = past && needed <= frame; });
    if (past) shown.push_back(output);
  }
  return shown;
}

void ClipLayer::measure(std::span<const int> kept, std::vector<double>* change) {
  std::vector<playing::FrameWeights> weights;
  for (const SpeedGroup& group : groups_) weights.push_back(playing::frame_weights(group.moments));
  std::set<std::uint32_t> shown;
  for (const playing::FrameWeights& of_group : weights)
    for (const auto& [frame, weight] : of_group) shown.insert(frame);
  if (detail_ == ClipDetail::kDifference)
    for (SpeedGroup& group : groups_) group.average = cv::Mat::zeros(luma_.region().size(), CV_32F);

  // Frame after frame, in the clip's order, whatever is in memory at once: the sums are the same.
  const std::vector<std::uint32_t> frames(shown.begin(), shown.end());
  const bool all = kept.size() == groups_.front().moments.size();
  std::vector<float> steps(frames.size(), 0);  // from the frame before, mean |difference|
  for (std::size_t first = 0; first < frames.size();) {
    std::size_t end = first + 1;
    while (end < frames.size() && (all || frames[end] / kChunk == frames[first] / kChunk)) ++end;
    if (all)
      load(kept);
    else  // the chunk, the frame before it, and what is to stay and has come by
      load(shown_by(frames[end - 1], kept),
           std::span(frames).subspan(first > 0 ? first - 1 : 0, end - (first > 0 ? first - 1 : 0)));
    if (detail_ == ClipDetail::kInnovation)
      for (SpeedGroup& group : groups_)
        group.levels->measure(luma_, std::span(frames).subspan(first, end - first));
    else
      add_to_averages({frames, first, end}, weights, change ? &steps : nullptr);
    first = end;
  }
  load(kept);
  if (change) add_change(frames, steps, *change);
}

/// Adds a stretch to the averages. steps: if not null, by frame, how far each of them is from the one before.
void ClipLayer::add_to_averages(const Stretch& stretch, std::span<const playing::FrameWeights> weights,
                                std::vector<float>* steps) {
  const std::span<const cv::Rect> blocks = luma_.blocks();
  const std::size_t count = stretch.end - stretch.first;
  std::vector<std::vector<double>> of_blocks(blocks.size(), std::vector<double>(steps ? count : 0, 0));
  oneapi::tbb::parallel_for(std::size_t{0}, blocks.size(),
                            [&](std::size_t b) { add_block(blocks[b], stretch, weights, of_blocks[b]); });
  if (!steps) return;
  double pixels = 0;
  for (const cv::Rect& block : blocks) pixels += block.area();
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0;
    for (const std::vector<double>& of_block : of_blocks) sum += of_block[i];
    (*steps)[stretch.first + i] = static_cast<float>(sum / std::max(1.0, pixels));
  }
}

/// The same of one block. steps: by frame of the stretch, sums of |difference|; empty when nobody asks.
void ClipLayer::add_block(const cv::Rect& block, const Stretch& stretch,
                          std::span<const playing::FrameWeights> weights, std::span<double> steps) {
  std::vector<float> luma(block.width), before(block.width);
  const cv::Point corner = block.tl() - luma_.region().tl();
  for (std::size_t i = stretch.first; i < stretch.end; ++i) {
    const std::uint32_t frame = stretch.frames[i];
    for (int y = 0; y < block.height; ++y) {
      luma_.row(frame, block.x, block.y + y, block.width, luma.data());
      for (std::size_t v = 0; v < groups_.size(); ++v)
        if (const auto weight = weights[v].find(frame); weight != weights[v].end())
          add_weighed(luma.data(), static_cast<float>(weight->second), block.width,
                      groups_[v].average.ptr<float>(corner.y + y) + corner.x);
      if (steps.empty() || i == 0) continue;
      luma_.row(stretch.frames[i - 1], block.x, block.y + y, block.width, before.data());
      double& step = steps[i - stretch.first];
      for (int x = 0; x < block.width; ++x) step += std::abs(luma[x] - before[x]);
    }
  }
}

/// From output to output: by how far the clip goes on.
void ClipLayer::add_change(std::span<const std::uint32_t> frames, std::span<const float> steps,
                           std::vector<double>& change) const {
  const auto step_at = [&](double at) {
    const auto next = std::upper_bound(frames.begin(), frames.end(), static_cast<std::uint32_t>(at));
    return steps[std::min<std::size_t>(next - frames.begin(), frames.size() - 1)];
  };
  for (const SpeedGroup& group : groups_) {
    const std::size_t outputs = group.moments.size();
    for (std::size_t i = 0; i < outputs; ++i) {
      const playing::Moment &a = group.moments[i], &b = group.moments[(i + 1) % outputs];
      double power = 0;
      for (int k = 0; k < a.count(); ++k) {
        const double moved = k < b.count() ? std::min(1.5, std::abs(b.at[k] - a.at[k])) : 1;
        power += std::pow(a.weight[k] * moved * step_at(a.at[k]), 2);
      }
      change[i] += std::sqrt(power) * static_cast<double>(group.members.size());
    }
  }
}

/// What a speed group's patches are made of, less its average, into scratch.shown; the rest of it may be anything.
void ClipLayer::difference(const SpeedGroup& group, const playing::Moment& moment, Scratch& s) const {
  if (s.shown.empty()) s.shown = cv::Mat::zeros(luma_.source(), CV_32F);
  s.part.resize(static_cast<std::size_t>(kCell.area()));
  for (const cv::Rect& cell : group.cells)
    for (int k = 0; k < moment.count(); ++k) {
      luma_.at(moment.at[k], cell, s.part.data(), s.luma);
      for (int y = 0; y < cell.height; ++y) {
        float* to = s.shown.ptr<float>(cell.y + y) + cell.x;
        const float* part = s.part.data() + y * cell.width;
        const float* average =
            group.average.ptr<float>(cell.y + y - luma_.region().y) + cell.x - luma_.region().x;
        if (k == 0)
          weigh_difference(part, average, moment.weight[k], cell.width, to);
        else
          add_difference(part, average, moment.weight[k], cell.width, to);
      }
    }
}

/// The innovations of what a speed group's patches are made of, into scratch.innovation.
void ClipLayer::innovation(const SpeedGroup& group, const playing::Moment& moment, Scratch& s) const {
  if (s.innovation.empty()) s.innovation = cv::Mat::zeros(luma_.source(), CV_32F);
  s.part.resize(static_cast<std::size_t>(kCell.area()));
  for (const cv::Rect& cell : group.cells)
    for (int k = 0; k < moment.count(); ++k) {
      luma_.innovation(nearest_frame(moment.at[k]), cell, s.part.data(), s.luma);
      for (int y = 0; y < cell.height; ++y) {
        float* to = s.innovation.ptr<float>(cell.y + y) + cell.x;
        if (k == 0) std::fill(to, to + cell.width, 0.0f);
        add_weighed(s.part.data() + y * cell.width, moment.weight[k], cell.width, to);
      }
    }
}

/// A loaded frame where a speed group's patches are made of it, into scratch.shown.
void ClipLayer::frame(const SpeedGroup& group, std::uint32_t frame, Scratch& s) const {
  if (s.shown.empty()) s.shown = cv::Mat::zeros(luma_.source(), CV_32F);
  for (const cv::Rect& cell : group.cells)
    for (int y = 0; y < cell.height; ++y)
      luma_.row(frame, cell.x, cell.y + y, cell.width, s.shown.ptr<float>(cell.y + y) + cell.x);
}

/// Calls with each member of a speed group, into patches_, and its window of `shown`, of the source's size.
template <class Use>
void ClipLayer::each_window(const SpeedGroup& group, const cv::Mat& shown, Scratch& s, const Use& use) {
  for (std::size_t i : group.whole) {
    windows_[i].cut(shown, s.window);
    use(i, s.window);
  }
  for (const Reduced& reduced : group.reduced) {
    s.reduced.create(reduced.reduction.reduced(), CV_32F);
    for (const cv::Rect& cell : reduced.cells) reduced.reduction.apply(shown, cell, s.reduced, s.line);
    for (std::size_t i : reduced.members) {
      windows_[i].cut(s.reduced, s.window);
      use(i, s.window);
    }
  }
}

void ClipLayer::add(std::span<const int> outputs, Blender& blender) {
  load(outputs);
  oneapi::tbb::enumerable_thread_specific<Scratch> scratches;
  oneapi::tbb::parallel_for(std::size_t{0}, outputs.size(), [&](std::size_t slot) {
    Scratch& s = scratches.local();
    const int frame = static_cast<int>(slot);
    for (const SpeedGroup& group : groups_) {
      const playing::Moment& moment = group.moments[outputs[slot]];
      if (detail_ == ClipDetail::kDifference) {
        difference(group, moment, s);
        each_window(group, s.shown, s,
                    [&](std::size_t i, const cv::Mat& window) { blender.add(frame, patches_[i], window); });
        continue;
      }
      innovation(group, moment, s);
      each_window(group, s.innovation, s,
                  [&](std::size_t i, const cv::Mat& window) { blender.add(frame, patches_[i], window); });
    }
  });
}

std::map<std::size_t, ClipLayer::DetailPower> ClipLayer::detail_power(std::span<const int> outputs,
                                                                      Blender& blender) {
  load(outputs);
  std::vector<std::map<std::size_t, DetailPower>> by_output(outputs.size());
  oneapi::tbb::enumerable_thread_specific<Scratch> scratches;
  oneapi::tbb::parallel_for(std::size_t{0}, outputs.size(), [&](std::size_t slot) {
    Scratch& s = scratches.local();
    for (const SpeedGroup& group : groups_) {
      const playing::Moment& moment = group.moments[outputs[slot]];
      innovation(group, moment, s);
      each_window(group, s.innovation, s, [&](std::size_t i, const cv::Mat& window) {
        by_output[slot][patches_[i]].anew = blender.band_power(window);
      });
      frame(group, nearest_frame(moment.louder()), s);
      each_window(group, s.shown, s, [&](std::size_t i, const cv::Mat& window) {
        by_output[slot][patches_[i]].shown = blender.band_power(window);
      });
    }
  });
  const auto add = [&](const std::vector<double>& power, std::vector<double>& sum) {
    sum.resize(power.size());
    for (std::size_t level = 0; level < power.size(); ++level)
      sum[level] += power[level] / static_cast<double>(outputs.size());
  };
  std::map<std::size_t, DetailPower> mean;
  for (const auto& powers : by_output)
    for (const auto& [patch, power] : powers) {
      add(power.shown, mean[patch].shown);
      add(power.anew, mean[patch].anew);
    }
  return mean;
}

void ClipLayer::release() { luma_.load({}); }

}  // namespace freshet::synth::animate
