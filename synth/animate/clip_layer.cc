#include "synth/animate/clip_layer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <set>

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include "freshet_error.h"
#include "synth/animate/clip_loop.h"

namespace freshet::synth {
namespace {

constexpr std::uint32_t kChunk = 32;  // frames read at once in the first pass: two slabs of tiles
constexpr int kFlowMargin = 16;       // px around a patch that flow may reach for

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::vector<PatchWindow> windows_of(cv::Size source, const Placement& placement,
                                    std::span<const std::size_t> patches) {
  std::vector<PatchWindow> windows;
  for (std::size_t p : patches)
    windows.emplace_back(source, placement.patches[p].variant, placement.patches[p].patch, placement.side);
  return windows;
}

std::vector<cv::Rect> needed_by(std::span<const PatchWindow> windows, Resampling resampling,
                                cv::Size source) {
  std::vector<cv::Rect> needed;
  const int margin = resampling == Resampling::kFlow ? kFlowMargin : 0;
  for (const PatchWindow& window : windows) {
    const cv::Rect own = window.needed();
    needed.push_back(
        cv::Rect(own.x - margin, own.y - margin, own.width + 2 * margin, own.height + 2 * margin) &
        cv::Rect({}, source));
  }
  return needed;
}

cv::Size size_of(const store::ClipRecord& record) {
  return {static_cast<int>(record.width), static_cast<int>(record.height)};
}

/// Calls with each clip frame that a moment needs, and its weight.
template <class Use>
void each_frame(const Moment& moment, const Use& use) {
  for (int i = 0; i < moment.count(); ++i) {
    const auto frame = static_cast<std::uint32_t>(moment.at[i]);
    const double part = moment.at[i] - frame;
    use(frame, moment.weight[i] * (1 - part));
    if (part > 0) use(frame + 1, moment.weight[i] * part);
  }
}

}  // namespace

ClipLayer::ClipLayer(const store::Snapshot& snapshot, store::ClipId clip, int flow_step,
                     const Placement& placement, std::vector<std::size_t> patches,
                     const TimelineOptions& options, Resampling resampling)
    : placement_(placement),
      patches_(std::move(patches)),
      windows_(windows_of(size_of(snapshot.clip(clip)), placement, patches_)),
      luma_(snapshot, clip, needed_by(windows_, resampling, size_of(snapshot.clip(clip))), flow_step) {
  const store::ClipRecord& record = snapshot.clip(clip);
  const std::vector<double> times = snapshot.column<double>(clip, "frame.time");
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
  if (options.loop || longest > times.back() - times.front() + interval) rule = loop_rule(snapshot, clip);
  for (auto& [speed, members] : by_speed) {
    TimelineOptions own = options;
    own.speed = speed;
    own.whole = resampling == Resampling::kNearest;
    voices_.push_back({.members = std::move(members),
                       .moments = timeline(times, interval, rule, record.name, own),
                       .average = {}});
  }
}

std::vector<ClipLayer::Played> ClipLayer::played() const {
  std::vector<Played> played;
  for (const Voice& voice : voices_) {
    played.push_back({.patches = {}, .moments = voice.moments});
    for (std::size_t member : voice.members) played.back().patches.push_back(patches_[member]);
  }
  return played;
}

std::size_t ClipLayer::average_bytes() const {
  return voices_.size() * luma_.region().area() * sizeof(float);
}

std::size_t ClipLayer::bytes_an_output() const {
  std::size_t bytes = 0;
  for (const Voice& voice : voices_) {
    std::set<std::uint32_t> distinct;
    bool flow = false;
    for (const Moment& moment : voice.moments) {
      each_frame(moment, [&](std::uint32_t frame, double) { distinct.insert(frame); });
      flow = flow || moment.at[0] != std::floor(moment.at[0]);
    }
    const double frames = std::min(3.0, 1 + static_cast<double>(distinct.size()) / voice.moments.size());
    bytes += static_cast<std::size_t>(frames * (luma_.frame_bytes() + (flow ? luma_.flow_bytes() : 0)));
  }
  return bytes;
}

void ClipLayer::load(std::span<const int> outputs, std::span<const std::uint32_t> more) {
  const auto begin = std::chrono::steady_clock::now();
  std::set<std::uint32_t> frames(more.begin(), more.end()), flows;
  for (const Voice& voice : voices_)
    for (int output : outputs) {
      const Moment& moment = voice.moments[output];
      each_frame(moment, [&](std::uint32_t frame, double) { frames.insert(frame); });
      for (int i = 0; i < moment.count(); ++i)
        if (moment.at[i] != std::floor(moment.at[i])) flows.insert(static_cast<std::uint32_t>(moment.at[i]));
    }
  luma_.load(std::vector(frames.begin(), frames.end()), std::vector(flows.begin(), flows.end()));
  read_s_ += seconds_since(begin);
}

void ClipLayer::measure(std::span<const int> kept, std::vector<double>& change) {
  // How much each clip frame counts in each voice's average.
  std::vector<std::map<std::uint32_t, double>> weights(voices_.size());
  std::set<std::uint32_t> shown;
  for (std::size_t v = 0; v < voices_.size(); ++v) {
    double total = 0;
    for (const Moment& moment : voices_[v].moments)
      each_frame(moment, [&](std::uint32_t frame, double weight) {
        weights[v][frame] += weight;
        total += weight;
        shown.insert(frame);
      });
    for (auto& [frame, weight] : weights[v]) weight /= total;
    voices_[v].average = cv::Mat::zeros(luma_.region().size(), CV_32F);
  }

  // Frame after frame, in the clip's order, whatever is in memory at once: the sums are the same.
  const std::vector<std::uint32_t> frames(shown.begin(), shown.end());
  const bool all = kept.size() == voices_.front().moments.size();
  std::vector<float> step(frames.size(), 0);  // from the frame before, mean |difference|
  const int height = luma_.region().height;
  const double pixels = std::max(1, cv::countNonZero(luma_.wanted()));
  std::vector<double> row_steps(height);
  for (std::size_t first = 0; first < frames.size();) {
    std::size_t end = first + 1;
    while (end < frames.size() && (all || frames[end] / kChunk == frames[first] / kChunk)) ++end;
    if (all) {
      load(kept);
    } else {
      std::vector<std::uint32_t> chunk(
          frames.begin() + static_cast<std::ptrdiff_t>(first > 0 ? first - 1 : 0),
          frames.begin() + static_cast<std::ptrdiff_t>(end));
      std::vector<int> so_far;  // outputs that are to stay and whose frames have come by
      for (int output : kept) {
        bool past = true;
        for (const Voice& voice : voices_)
          each_frame(voice.moments[output],
                     [&](std::uint32_t frame, double) { past = past && frame <= frames[end - 1]; });
        if (past) so_far.push_back(output);
      }
      load(so_far, chunk);
    }
    std::vector<std::vector<double>> steps(height, std::vector<double>(end - first, 0));
    oneapi::tbb::parallel_for(0, height, [&](int row) {
      cv::Mat before, luma;
      if (first > 0) before = luma_.rows(frames[first - 1], row, row + 1);
      for (std::size_t i = first; i < end; ++i) {
        luma = luma_.rows(frames[i], row, row + 1);
        for (std::size_t v = 0; v < voices_.size(); ++v)
          if (const auto weight = weights[v].find(frames[i]); weight != weights[v].end())
            cv::scaleAdd(luma, weight->second, voices_[v].average.row(row), voices_[v].average.row(row));
        if (!before.empty()) steps[row][i - first] = cv::norm(luma, before, cv::NORM_L1);
        before = luma;
      }
    });
    for (std::size_t i = first; i < end; ++i) {
      double sum = 0;
      for (int row = 0; row < height; ++row) sum += steps[row][i - first];
      step[i] = static_cast<float>(sum / pixels);
    }
    first = end;
  }
  load(kept);

  // From output to output: by how far the clip goes on.
  const auto step_at = [&](double at) {
    const auto next = std::upper_bound(frames.begin(), frames.end(), static_cast<std::uint32_t>(at));
    return step[std::min<std::size_t>(next - frames.begin(), frames.size() - 1)];
  };
  for (const Voice& voice : voices_) {
    const std::size_t outputs = voice.moments.size();
    for (std::size_t i = 0; i < outputs; ++i) {
      const Moment &a = voice.moments[i], &b = voice.moments[(i + 1) % outputs];
      double power = 0;
      for (int k = 0; k < a.count(); ++k) {
        const double moved = k < b.count() ? std::min(1.5, std::abs(b.at[k] - a.at[k])) : 1;
        power += std::pow(a.weight[k] * moved * step_at(a.at[k]), 2);
      }
      change[i] += std::sqrt(power) * static_cast<double>(voice.members.size());
    }
  }
}

void ClipLayer::difference(const Voice& voice, const Moment& moment, cv::Mat& out, cv::Mat& part,
                           ClipLuma::Scratch& scratch) const {
  out.create(luma_.source(), CV_32F);
  out.setTo(0);
  cv::Mat inside = out(luma_.region());
  for (int k = 0; k < moment.count(); ++k) {
    luma_.at(moment.at[k], part, scratch);
    cv::subtract(part, voice.average, part);
    cv::scaleAdd(part, moment.weight[k], inside, inside);
  }
  // Samples never read are zero in every frame; with a limited range they would still differ by rounding.
  inside.setTo(0, ~luma_.wanted());
}

void ClipLayer::add(std::span<const int> outputs, Blender& blender) {
  load(outputs);
  struct Scratch {
    cv::Mat difference, part, reduced, window;
    ClipLuma::Scratch luma;
  };
  oneapi::tbb::enumerable_thread_specific<Scratch> scratches;
  oneapi::tbb::parallel_for(std::size_t{0}, outputs.size(), [&](std::size_t slot) {
    Scratch& s = scratches.local();
    for (const Voice& voice : voices_) {
      difference(voice, voice.moments[outputs[slot]], s.difference, s.part, s.luma);
      std::vector<float> scales;
      for (std::size_t i : voice.members) {
        const float scale = placement_.patches[patches_[i]].variant.scale;
        if (std::find(scales.begin(), scales.end(), scale) == scales.end()) scales.push_back(scale);
      }
      for (float scale : scales) {
        reduce_to_scale(s.difference, scale, s.reduced);
        for (std::size_t i : voice.members) {
          if (placement_.patches[patches_[i]].variant.scale != scale) continue;
          windows_[i].cut(s.reduced, s.window);
          blender.add(static_cast<int>(slot), patches_[i], s.window);
        }
      }
    }
  });
}

void ClipLayer::release() { luma_.load({}); }

}  // namespace freshet::synth
