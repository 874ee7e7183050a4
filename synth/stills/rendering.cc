#include "synth/stills/rendering.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

#include "cache/content_hash.h"
#include "freshet/error.h"
#include "synth/stills/between/between.h"
#include "synth/stills/between/kept_between.h"
#include "synth/stills/between/pinned_flow.h"
#include "synth/stills/still_pins.h"
#include "synth/stills/still_set.h"

namespace freshet::synth::stills {
namespace {

constexpr int kMargin = 24;  // px of the work size around a region: motion comes in from there

constexpr std::size_t kMostKept = std::size_t{1} << 30;  // bytes of pictures that a run keeps

using Pair = std::pair<int, int>;  // of stills, the lower number first

constexpr float kFarthest = 1000;  // px of the flow that FlowPair can say

/// A region as it is rendered.
struct RegionLayer {
  const PlannedRegion* planned = nullptr;
  cv::Mat weight;  // CV_32F, work size
  cv::Rect box;    // px of the stills; all that has weight, and a margin
  std::map<Pair, Between> flows;
  bool fades = false;
  bool kept = false;                  // its pictures are
  const FrontThing* front = nullptr;  // it goes over all regions, by its own alpha
};

cv::Rect full_box(const cv::Mat& weight, cv::Size full) {
  const cv::Rect box = cv::boundingRect(weight > 0);
  const double sx = static_cast<double>(full.width) / weight.cols,
               sy = static_cast<double>(full.height) / weight.rows;
  const auto span = [](int from, int length, double scale, int limit) {
    int low = std::max(0, static_cast<int>((from - kMargin) * scale));
    int high = std::min(limit, static_cast<int>((from + length + kMargin) * scale) + 1);
    if (high - low < kMinSide) {
      low = std::clamp((low + high - kMinSide) / 2, 0, limit - kMinSide);
      high = low + kMinSide;
    }
    return Pair(low, high - low);
  };
  const auto [x, width] = span(box.x, box.width, sx, full.width);
  const auto [y, height] = span(box.y, box.height, sy, full.height);
  return {x, y, width, height};
}

std::set<Pair> pairs_shown(const Timeline& timeline, double seconds) {
  std::set<Pair> pairs;
  const std::vector<int>& stills = timeline.sequence();
  const std::vector<double>& times = timeline.times();
  for (std::size_t i = 0; i + 1 < stills.size() && times[i] < seconds; ++i)
    if (stills[i] != stills[i + 1]) pairs.insert(std::minmax(stills[i], stills[i + 1]));
  return pairs;
}

/// Regions that have any weight.
std::vector<RegionLayer> layers_of(const Plan& plan, cv::Size pictures, const RenderOptions& options) {
  std::vector<Region> regions;
  for (const PlannedRegion& each : plan.regions)
    if (!each.front) regions.push_back(each.region);
  const std::vector<cv::Mat> weights = region_weights(regions, options.grown_px, options.feather_px);
  std::vector<RegionLayer> layers;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (cv::countNonZero(weights[i]) == 0) continue;
    layers.push_back({.planned = &plan.regions[i],
                      .weight = weights[i],
                      .box = full_box(weights[i], pictures),
                      .flows = {},
                      .fades = !options.flow || plan.regions[i].region.kind == RegionKind::kSlow});
  }
  for (const PlannedRegion& each : plan.regions)
    if (each.front)
      layers.push_back({.planned = &each,
                        .weight = {},
                        .box = full_box(each.region.mask, pictures),
                        .flows = {},
                        .fades = !options.flow,
                        .front = each.front.get()});
  return layers;
}

/// A weight of the work size as a row of the stills has it.
class WeightRow {
 public:
  WeightRow(const cv::Mat& weight, cv::Size full)
      : weight_(weight),
        scale_x_(static_cast<float>(weight.cols) / static_cast<float>(full.width)),
        scale_y_(static_cast<float>(weight.rows) / static_cast<float>(full.height)) {}

  void read(int y, const cv::Rect& box, float* out) const {
    const float v = place(y, scale_y_, weight_.rows);
    const int v0 = static_cast<int>(v), v1 = std::min(v0 + 1, weight_.rows - 1);
    const float fv = v - static_cast<float>(v0);
    const float *top = weight_.ptr<float>(v0), *low = weight_.ptr<float>(v1);
    for (int x = 0; x < box.width; ++x) {
      const float u = place(box.x + x, scale_x_, weight_.cols);
      const int u0 = static_cast<int>(u), u1 = std::min(u0 + 1, weight_.cols - 1);
      const float fu = u - static_cast<float>(u0);
      out[x] = (1 - fv) * ((1 - fu) * top[u0] + fu * top[u1]) + fv * ((1 - fu) * low[u0] + fu * low[u1]);
    }
  }

 private:
  static float place(int at, float scale, int side) {
    return std::clamp((static_cast<float>(at) + .5f) * scale - .5f, 0.0f, static_cast<float>(side - 1));
  }
  const cv::Mat& weight_;
  float scale_x_, scale_y_;
};

class Renderer {
 public:
  Renderer(const Plan& plan, const std::vector<cv::Mat>& pictures, const RenderOptions& options,
           const Job& job)
      : plan_(plan), pictures_(pictures), options_(options), kept_(options.cache) {
    layers_ = layers_of(plan, pictures[0].size(), options);
    choose_kept();
    find_flow(job);
  }

  cv::Mat frame(double seconds) const {
    std::vector<Shown> shown;
    for (const RegionLayer& layer : layers_) shown.push_back(show(layer, seconds));
    cv::Mat out = pictures_[plan_.standing].clone();
    if (out.depth() == CV_16U)
      compose<std::uint16_t>(shown, out);
    else
      compose<std::uint8_t>(shown, out);
    return out;
  }

 private:
  struct Shown {
    const RegionLayer* layer;
    const cv::Mat *a, *b;
    const cv::Mat *alpha_a, *alpha_b;  // of a thing in front; else null
    Moment moment;
    cv::Mat picture;  // of the layer's box; empty: it is read from the moment, row by row
  };

  Shown show(const RegionLayer& layer, double seconds) const {
    const Instant instant = layer.planned->timeline.at(seconds);
    Shown shown{&layer, nullptr, nullptr, nullptr, nullptr, {}, {}};
    const auto take = [&](int from, int to) {
      const std::vector<cv::Mat>& stills = layer.front != nullptr ? layer.front->light : pictures_;
      shown.a = &stills[from], shown.b = &stills[to];
      if (layer.front != nullptr)
        shown.alpha_a = &layer.front->alpha[from], shown.alpha_b = &layer.front->alpha[to];
    };
    take(instant.from, instant.to);
    shown.moment.phase = static_cast<float>(instant.phase);
    const Pair pair = std::minmax(instant.from, instant.to);
    const auto found = layer.flows.find(pair);
    if (found == layer.flows.end()) return shown;
    take(pair.first, pair.second);
    const double phase = instant.from < instant.to ? instant.phase : 1 - instant.phase;
    const auto moment = [&] { return found->second.at(phase); };
    if (!layer.kept) {
      shown.moment = moment();
      return shown;
    }
    const BetweenKey key{content_[pair.first], content_[pair.second], layer.box, phase,
                         options_.flow_side,   pins_of(layer, pair)};
    shown.picture = kept_.picture(key, pictures_[0].type(), [&] {
      cv::Mat rounded;
      moment_picture(moment(), *shown.a, *shown.b, layer.box).convertTo(rounded, pictures_[0].depth());
      return rounded;
    });
    return shown;
  }

  /// A row of the box in the stills' own whole units, kept or not.
  template <class T>
  static void read_row(const Shown& shown, MomentReader& reader, int y, std::span<float> out) {
    if (shown.picture.empty()) {
      reader.row(y, out.data());
      for (float& each : out) each = cv::saturate_cast<T>(each);
    } else {
      const T* row = shown.picture.ptr<T>(y);
      std::copy(row, row + out.size(), out.data());
    }
  }

  template <class T>
  void compose(const std::vector<Shown>& shown, cv::Mat& out) const {
    const std::size_t width = static_cast<std::size_t>(out.cols);
    std::vector<float> sum(3 * width), left(width), colour(3 * width), weight(width);
    std::vector<MomentReader> readers;
    std::vector<MomentReader> alphas;  // of the things in front, which come last
    const std::size_t things = std::count_if(shown.begin(), shown.end(),
                                             [](const Shown& each) { return each.layer->front != nullptr; });
    const std::size_t regions = shown.size() - things;
    std::vector<float> alpha(things > 0 ? 3 * width : 0);
    for (const Shown& each : shown) {
      readers.emplace_back(each.moment, *each.a, *each.b, each.layer->box);
      if (each.layer->front != nullptr)
        alphas.emplace_back(each.moment, *each.alpha_a, *each.alpha_b, each.layer->box);
    }
    for (int y = 0; y < out.rows; ++y) {
      std::fill(left.begin(), left.end(), 1.0f);
      std::fill(sum.begin(), sum.end(), 0.0f);
      bool any = false;
      for (std::size_t k = 0; k < regions; ++k) {
        const cv::Rect& box = shown[k].layer->box;
        if (y < box.y || y >= box.y + box.height) continue;
        WeightRow(shown[k].layer->weight, out.size()).read(y, box, weight.data());
        if (std::all_of(weight.begin(), weight.begin() + box.width, [](float w) { return w <= 0; })) continue;
        read_row<T>(shown[k], readers[k], y - box.y,
                    std::span(colour).first(3 * static_cast<std::size_t>(box.width)));
        any = true;
        for (int x = 0; x < box.width; ++x) {
          left[box.x + x] -= weight[x];
          for (int c = 0; c < 3; ++c) sum[3 * (box.x + x) + c] += weight[x] * colour[3 * x + c];
        }
      }
      T* row = out.ptr<T>(y);
      for (int x = 0; any && x < out.cols; ++x) {
        if (left[x] >= 1) continue;
        const float rest = std::max(0.0f, left[x]);
        for (int c = 0; c < 3; ++c)
          row[3 * x + c] = cv::saturate_cast<T>(sum[3 * x + c] + rest * static_cast<float>(row[3 * x + c]));
      }
      // Things in front, the farthest first.
      for (std::size_t k = shown.size(); k-- > regions;) {
        const cv::Rect& box = shown[k].layer->box;
        if (y < box.y || y >= box.y + box.height) continue;
        readers[k].row(y - box.y, colour.data());
        alphas[k - regions].row(y - box.y, alpha.data());
        for (int i = 0; i < 3 * box.width; ++i) {
          T& value = row[3 * box.x + i];
          const float cover =
              std::clamp(alpha[i] / static_cast<float>(std::numeric_limits<T>::max()), 0.0f, 1.0f);
          if (cover > 0) value = cv::saturate_cast<T>(colour[i] + (1 - cover) * static_cast<float>(value));
        }
      }
    }
  }

  /// Layers' pictures are kept from the smallest layer on, as long as they are few bytes.
  void choose_kept() {
    if (options_.cache == nullptr) return;
    std::vector<RegionLayer*> by_area;
    for (RegionLayer& layer : layers_)
      if (!layer.fades && layer.front == nullptr) by_area.push_back(&layer);
    std::stable_sort(by_area.begin(), by_area.end(), [](const RegionLayer* a, const RegionLayer* b) {
      return a->box.area() < b->box.area();
    });
    std::size_t bytes = 0;
    for (RegionLayer* layer : by_area) {
      bytes += static_cast<std::size_t>(options_.frames) * layer->box.area() * pictures_[0].elemSize();
      if (bytes > kMostKept) break;
      layer->kept = true;
    }
    if (by_area.empty() || !by_area.front()->kept) return;
    content_.resize(pictures_.size());
    oneapi::tbb::parallel_for(std::size_t{0}, pictures_.size(), [&](std::size_t still) {
      content_[still] = cache::content_hash(pictures_[still]);
    });
  }

  void find_flow(const Job& job) {
    struct Task {
      RegionLayer* layer;
      Pair pair;
      const std::vector<cv::Mat>* small;
    };
    std::vector<Task> tasks;
    // By layer the stills' boxes as flow sees them; empty where not needed.
    std::vector<std::vector<cv::Mat>> small(layers_.size(), std::vector<cv::Mat>(pictures_.size()));
    const double seconds = options_.frames / options_.fps;
    for (std::size_t k = 0; k < layers_.size(); ++k) {
      RegionLayer& layer = layers_[k];
      if (layer.fades) continue;
      for (const Pair& pair : pairs_shown(layer.planned->timeline, seconds)) {
        tasks.push_back({&layer, pair, &small[k]});
        for (const int still : {pair.first, pair.second})
          if (small[k][still].empty())
            small[k][still] = reduced(
                {layer.front == nullptr
                     ? pictures_[still](layer.box)
                     : over_grey(layer.front->light[still](layer.box), layer.front->alpha[still](layer.box))},
                options_.flow_side)[0];
      }
    }
    std::vector<std::optional<Between>> found(tasks.size());
    std::mutex reporting;
    std::size_t done = 0;
    oneapi::tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
      if (job.stop.stop_requested()) return;
      const Task& task = tasks[i];
      const cv::Mat &from = (*task.small)[task.pair.first], &to = (*task.small)[task.pair.second];
      const FlowPair flow = task.layer->front == nullptr
                                ? kept_.flow(from, to)
                                : flow_of_thing(from, to, way_of(*task.layer, task.pair, from.size()));
      const std::vector<FlowPin> pins = pins_of(*task.layer, task.pair);
      if (pins.empty())
        found[i].emplace(flow);
      else
        found[i].emplace(flow, pinned_flow(from, to, flow, pins, job.stop));
      const std::lock_guard lock(reporting);
      if (job.progress) job.progress({"flow between stills", ++done, tasks.size()});
    });
    if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "stills", "stopped");
    for (std::size_t i = 0; i < tasks.size(); ++i)
      tasks[i].layer->flows.emplace(tasks[i].pair, std::move(*found[i]));
  }

  /// From the middle of the thing in the one still to that in the other, whole px of the flow.
  static cv::Point way_of(const RegionLayer& layer, const Pair& pair, cv::Size flow) {
    cv::Point2d middle[2];
    for (int k = 0; k < 2; ++k) {
      cv::Mat alpha;
      cv::extractChannel(layer.front->alpha[k == 0 ? pair.first : pair.second](layer.box), alpha, 0);
      const cv::Moments moments = cv::moments(alpha);
      if (moments.m00 <= 0) return {};  // not seen in one of them: it fades where it is
      middle[k] = {moments.m10 / moments.m00, moments.m01 / moments.m00};
    }
    const double scale = static_cast<double>(flow.width) / layer.box.width;
    const cv::Point2d way = (middle[1] - middle[0]) * scale;
    if (std::max(std::abs(way.x), std::abs(way.y)) > kFarthest)
      throw Error(ErrorKind::kInput, "front " + layer.planned->region.name,
                  fmt::format("it goes {:.0f} px of the flow, more than {:.0f}", cv::norm(way), kFarthest),
                  "Lower --flow-side");
    return {cvRound(way.x), cvRound(way.y)};
  }

  /// Flow beside the way that the thing as a whole went, to which it is added: a thing that leaps over its own
  /// length goes once, and is not faded twice.
  FlowPair flow_of_thing(const cv::Mat& from, const cv::Mat& to, cv::Point way) const {
    constexpr auto kPerPx = static_cast<int>(1 / FlowPair::kUnit);
    const auto moved = [](const cv::Mat& picture, cv::Point by, int border, const cv::Scalar& value) {
      cv::Mat out;
      cv::warpAffine(picture, out, cv::Matx23d(1, 0, by.x, 0, 1, by.y), picture.size(), cv::INTER_NEAREST,
                     border, value);
      return out;
    };
    const FlowPair beside = kept_.flow(from, moved(to, -way, cv::BORDER_CONSTANT, cv::Scalar::all(127)));
    const cv::Scalar whole(kPerPx * way.x, kPerPx * way.y);
    return {beside.forth + whole, moved(beside.back, way, cv::BORDER_REPLICATE, {}) - whole};
  }

  std::vector<FlowPin> pins_of(const RegionLayer& layer, const Pair& pair) const {
    return flow_pins(options_.pins, pair.first, pair.second, layer.box,
                     reduced_size(layer.box.size(), options_.flow_side));
  }

  const Plan& plan_;
  const std::vector<cv::Mat>& pictures_;
  RenderOptions options_;
  KeptBetween kept_;
  std::vector<RegionLayer> layers_;
  std::vector<cache::Key> content_;  // of the stills; empty where no layer is kept
};

}  // namespace

std::vector<std::string> check_pins(const Plan& plan, cv::Size pictures, const RenderOptions& options) {
  std::vector<std::string> notices;
  if (options.pins.empty()) return notices;
  const std::vector<RegionLayer> layers = layers_of(plan, pictures, options);
  for (const PlacedPin& pin : options.pins) {
    bool held = false, shown = false;
    for (const RegionLayer& layer : layers) {
      if (layer.fades) continue;
      const std::vector<FlowPin> seen =
          flow_pins({pin}, pin.from, pin.to, layer.box, reduced_size(layer.box.size(), options.flow_side));
      if (seen.empty()) continue;
      const cv::Point2f move = seen[0].move();
      if (std::max(std::abs(move.x), std::abs(move.y)) > kFarthest)
        throw Error(ErrorKind::kInput, pin.name,
                    fmt::format("it goes {:.0f} px of the flow, more than {:.0f}", cv::norm(move), kFarthest),
                    "Lower --flow-side");
      held = true;
      shown |=
          pairs_shown(layer.planned->timeline, options.frames / options.fps).contains({pin.from, pin.to});
    }
    if (!held)
      throw Error(ErrorKind::kInput, pin.name, "no region that flows holds both its ends",
                  "Look at the --sheet: draw a region around the whole way with --regions, give it the kind "
                  "\"independent\", or use --one-region");
    if (!shown)
      notices.push_back(pin.name +
                        ": these two stills are never shown one after the other, and it changes nothing");
  }
  return notices;
}

void render_frames(const Plan& plan, const std::vector<cv::Mat>& pictures, const RenderOptions& options,
                   const FrameSink& sink, const Job& job) {
  const Renderer renderer(plan, pictures, options, job);
  const int batch = 2 * std::max(1, oneapi::tbb::this_task_arena::max_concurrency());
  std::vector<cv::Mat> frames(static_cast<std::size_t>(batch));
  for (int first = 0; first < options.frames; first += batch) {
    if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "stills", "stopped");
    const int count = std::min(batch, options.frames - first);
    oneapi::tbb::parallel_for(0, count,
                              [&](int i) { frames[i] = renderer.frame((first + i) / options.fps); });
    for (int i = 0; i < count; ++i) sink(frames[i]);
    if (job.progress)
      job.progress(
          {"frames", static_cast<std::size_t>(first + count), static_cast<std::size_t>(options.frames)});
  }
}

}  // namespace freshet::synth::stills
