#include "synth/animate/animate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <oneapi/tbb/task_group.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "synth/animate/motion/motion_field.h"
#include "synth/animate/motion/motion_sequence.h"
#include "synth/animate/sampling/enlarge.h"
#include "synth/animate/sampling/pull_push.h"
#include "synth/animate/still/colour_model.h"
#include "synth/animate/still/finished_frame.h"

namespace freshet::synth::animate {
namespace {

constexpr int kSampledFrames = 12;  // that the appearance model is fitted to
constexpr int kMinSampledFrames = 4;
constexpr int kSampledPixels = 32 << 20;  // in all of them
constexpr int kRendered = 8;              // frames rendered at once before they are handed on in order

void throw_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "animate", "stopped");
}

/// One layer a clip, in the clips' order.
std::vector<std::unique_ptr<ClipLayer>> layers_of(const store::Snapshot& snapshot,
                                                  const vision::Settings& settings,
                                                  const Placement& placement, const AnimateOptions& options) {
  std::map<store::ClipId, std::vector<std::size_t>> patches_of;
  for (std::size_t p = 0; p < placement.patches.size(); ++p)
    patches_of[placement.patches[p].clip].push_back(p);
  std::vector<std::unique_ptr<ClipLayer>> layers;
  for (auto& [clip, patches] : patches_of) {
    // Cross-fades of different clips should not fall together: steps of the golden ratio spread them.
    const double phase = std::fmod(0.618034 * static_cast<double>(layers.size()), 1.0);
    layers.push_back(std::make_unique<ClipLayer>(
        snapshot, clip, settings.flow_step, placement, std::move(patches),
        TimelineOptions{.frames = options.frames, .fps = options.fps, .loop = options.loop, .phase = phase},
        options.resampling));
  }
  return layers;
}

/// What is held at once.
struct Budget {
  int batch = 0;              // output frames
  bool carried_kept = false;  // a period of the carried picture, made once
};

/// As many frames as fit into the memory that the picture's own planes leave.
Budget budget_of(const std::vector<std::unique_ptr<ClipLayer>>& layers, cv::Size picture, cv::Size canvas,
                 const AnimateOptions& options) {
  constexpr double kPlanes = 280;  // bytes per pixel of the picture: what is held, and what rendering needs
  constexpr int kMinBatch = 32;    // frames per batch, before carried frames are kept: two slabs of tiles
  double fixed = kPlanes * picture.area(), clip_bytes = 0;
  for (const auto& layer : layers) {
    fixed += static_cast<double>(layer->average_bytes());
    clip_bytes = std::max(clip_bytes, static_cast<double>(layer->bytes_per_output()));
  }
  const double a_frame = canvas.area() * sizeof(float) * 4 / 3.0 + clip_bytes;
  const double free = static_cast<double>(options.memory_bytes) - fixed;
  const int period = CarriedBase::period(options.fps, options.carry);
  const double carried = static_cast<double>(CarriedBase::frame_bytes(picture)) * period;
  Budget budget{.batch = options.frames,
                .carried_kept = period < options.frames &&
                                free - carried >= a_frame * std::min(kMinBatch, options.frames)};
  const double fit = (free - (budget.carried_kept ? carried : 0)) / a_frame;
  // In slabs of 16: a tile is decoded for all of its frames.
  if (fit < options.frames)
    budget.batch = std::min(options.frames, std::max(16, static_cast<int>(fit) / 16 * 16));
  return budget;
}

/// The carried picture, frame by frame: it repeats, so where there is memory for a period it is made once.
class CarriedFrames {
 public:
  CarriedFrames(CarriedBase base, bool kept) : base_(std::move(base)) {
    if (!kept) return;
    made_ = std::vector<std::once_flag>(base_.period());
    frames_.resize(base_.period());
  }
  CarriedFrame at(int output) {
    if (frames_.empty()) return base_.frame(output);
    const int i = output % base_.period();
    std::call_once(made_[i], [&] { frames_[i] = base_.frame(i); });
    return frames_[i];
  }

 private:
  CarriedBase base_;
  std::vector<std::once_flag> made_;
  std::vector<CarriedFrame> frames_;
};

/// Hands finished frames on, in order, while others are made.
class Handover {
 public:
  explicit Handover(const std::function<void(const cv::Mat&)>& sink) : sink_(sink) {}
  Handover(const Handover&) = delete;
  Handover& operator=(const Handover&) = delete;
  ~Handover() {
    try {
      group_.wait();
    } catch (...) {  // what is on its way out already is said instead
    }
  }

  /// Waits until those before are handed on; throws what the sink threw.
  void take(std::vector<cv::Mat> frames) {
    wait();
    frames_ = std::move(frames);
    group_.run([this] {
      for (const cv::Mat& frame : frames_) sink_(frame);
    });
  }
  void wait() { group_.wait(); }

 private:
  const std::function<void(const cv::Mat&)>& sink_;
  std::vector<cv::Mat> frames_;
  oneapi::tbb::task_group group_;
};

/// The picture's luma as a long exposure along the motion; and what its colour does beside its luminance,
/// which keeps its place and is as blurred: CV_32FC3, BGR.
std::pair<cv::Mat, cv::Mat> exposed(const cv::Mat& target, const cv::Mat& luma, const ColourModel& colours,
                                    const cv::Mat& alpha, const cv::Mat& motion,
                                    const BaseImageOptions& options) {
  std::array<cv::Mat, 3> own;
  {
    cv::Mat modelled;
    apply_colour(colours, luma, modelled);
    cv::split(target - modelled, own.data());
  }
  // The model keeps luma: two of the three colours tell the third, and one pass blurs all.
  cv::Mat together;
  cv::merge(std::vector<cv::Mat>{luma, own[0], own[2]}, together);
  std::array<cv::Mat, 3> blurred;
  cv::split(base_image(together, alpha, motion, options), blurred.data());
  const cv::Mat green = -(kBlueLuma * blurred[1] + kRedLuma * blurred[2]) / kGreenLuma;
  cv::Mat own_colour;
  cv::merge(std::vector<cv::Mat>{blurred[1], green, blurred[2]}, own_colour);
  return {blurred[0], own_colour};
}

/// The outline carried along by the motion of what is shown, output frame by output frame in `order`.
BoundarySequence boundary_of(const store::Snapshot& snapshot, const vision::Settings& settings,
                             const Placement& placement,
                             const std::vector<std::unique_ptr<ClipLayer>>& layers, const cv::Mat& alpha,
                             const cv::Mat& mean_motion, const std::vector<int>& order,
                             const AnimateOptions& options) {
  std::vector<PlayedPatches> played;
  for (const auto& layer : layers)
    for (const ClipLayer::Played& group : layer->played()) {
      const PlacedPatch& one = placement.patches[group.patches.front()];
      played.push_back({.clip = one.clip, .patches = group.patches, .shown = {}});
      for (const Moment& moment : group.moments) {
        // In a cross-fade the louder of the two moments moves the outline.
        const double at = moment.at[moment.weight[1] > moment.weight[0] ? 1 : 0];
        played.back().shown.push_back({.frame = static_cast<std::uint32_t>(at), .rate = one.speed});
      }
    }
  const auto sequence = std::make_shared<const MotionSequence>(snapshot, settings, placement, played,
                                                               alpha.size(), options.frames);
  return BoundarySequence(
      alpha, mean_motion, options.fps, options.boundary.matte,
      [sequence, order](int i) { return sequence->at(order[static_cast<std::size_t>(i) % order.size()]); },
      options.loop ? options.frames : 0);
}

/// Lengths in px are meant for pieces of their own size: enlarged ones are blurred, carried and matched as
/// widely. And a loop is one for all.
AnimateOptions enlarged(AnimateOptions options, double scale) {
  options.base.max_length_px *= scale;
  options.base.max_sigma_px *= scale;
  options.carry.max_px *= scale;
  options.carry.edge_px *= scale;
  options.appearance.region_px = static_cast<int>(std::lround(options.appearance.region_px * scale));
  options.appearance.levels += static_cast<int>(std::lround(std::log2(scale)));
  if (options.loop) options.carry.loop_frames = options.frames;
  return options;
}

}  // namespace

AnimateReport animate(const store::Snapshot& snapshot, const vision::Settings& settings,
                      const cv::Mat& picture, const cv::Mat& matte, const Placement& placement,
                      const AnimateOptions& asked, const std::function<void(const cv::Mat&)>& sink,
                      const std::function<void(const AnimateProgress&)>& progress, std::stop_token stop) {
  check(placement);
  const AnimateOptions options = enlarged(asked, placement.piece_scale);
  // What is wrong with the background is said before the work.
  const bool moving_boundary = options.boundary.boundary == Boundary::kMoving;
  const cv::Mat behind = moving_boundary ? behind_fluid(picture, matte, options.boundary) : cv::Mat();
  Stopwatch total, watch;
  AnimateReport report;
  report.pieces = placement.patches.size();
  const auto notify = [&](const char* stage, std::size_t done, std::size_t of) {
    if (progress) progress({stage, done, of});
  };
  const auto layers = layers_of(snapshot, settings, placement, options);
  report.clips = layers.size();

  const cv::Rect canvas = canvas_of(placement);
  const Budget budget = budget_of(layers, picture.size(), canvas.size(), options);
  const int batch = budget.batch;
  const bool in_one = batch == options.frames;
  report.batches = (options.frames + batch - 1) / batch;
  // A region's histograms hold as many pixels whatever the picture's size; samples of a large picture would
  // not fit, and need not be as many.
  const int sampled = std::min(
      {options.frames, kSampledFrames, std::max(kMinSampledFrames, kSampledPixels / picture.size().area())});
  std::vector<int> all(options.frames), samples;
  std::iota(all.begin(), all.end(), 0);
  for (int i = 0; i < sampled; ++i) samples.push_back(i * options.frames / sampled);

  // The moving part: the averages of every clip's patches, then their differences, merged band by band.
  Blender blender(placement, std::max(batch, sampled), options.blend);
  const auto blend = [&](ClipLayer& layer, std::span<const int> outputs) {
    throw_if_stopped(stop);
    layer.add(outputs, blender);
    layer.release();
  };
  const bool whole_loop = options.loop && options.resampling == Resampling::kNearest;
  std::vector<double> change(options.frames, 0.0);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    throw_if_stopped(stop);
    notify("blend", i, layers.size());
    const std::vector<int>& first = in_one ? all : samples;
    layers[i]->measure(first, whole_loop ? &change : nullptr);
    // Samples are for the model alone: without one, they would be left in the blender.
    if (in_one || options.matching == AppearanceMatching::kSequence)
      blend(*layers[i], first);
    else
      layers[i]->release();
  }
  notify("blend", layers.size(), layers.size());
  report.blend_s = watch.lap();

  // The still part: the picture as a long exposure along the assigned motion.
  cv::Mat target, alpha;
  picture.convertTo(target, CV_32F, 1.0 / 255);
  matte.convertTo(alpha, CV_32F, 1.0 / 255);
  const cv::Mat target_luma = luma_of(target);
  cv::Mat motion;
  ColourModel colours;
  oneapi::tbb::parallel_invoke(
      [&] {
        motion = apply_guide(motion_field(snapshot, settings, placement, picture.size()), options.guide);
      },
      [&] {
        colours =
            fit_colour(target, target_luma, alpha, static_cast<int>(std::lround(12 * placement.piece_scale)));
      });
  auto [base_luma, own_colour] = exposed(target, target_luma, colours, alpha, motion, options.base);
  std::optional<CarriedFrames> carried;
  if (options.carry.fraction > 0)
    carried.emplace(CarriedBase(target, target_luma, alpha, motion, options.fps, options.carry),
                    budget.carried_kept);
  // The fluid's layers go on beyond the still matte, for a moving one to uncover.
  if (moving_boundary)
    for (cv::Mat* layer : {&own_colour, &colours.slope, &colours.offset}) *layer = pull_push(*layer, alpha);
  const FrameFinisher finisher(colours, own_colour, moving_boundary ? behind : target);
  colours = {};
  own_colour.release();
  target.release();
  report.base_s = watch.lap();

  // Luminance of an output frame, which lies in a slot of the blender; once.
  const auto merged = [&](int slot, const std::optional<CarriedFrame>& brought) {
    const cv::Mat field = blender.take(slot);
    cv::Mat luma;
    if (brought)
      show_carried(*brought, base_luma, luma);
    else
      base_luma.copyTo(luma);
    if (moving_boundary) luma = pull_push(luma, alpha);
    add_enlarged(field, canvas, placement.piece_scale, luma);
    return luma;
  };
  const auto carried_at = [&](int output) {
    return carried ? std::optional(carried->at(output)) : std::nullopt;
  };
  std::map<int, cv::Mat> ready;  // by output frame: merged already, for the model
  std::optional<AppearanceModel> model;
  const auto model_of = [&](std::span<const cv::Mat> frames) {
    return AppearanceModel(target_luma, alpha, frames, options.appearance);
  };
  if (options.matching == AppearanceMatching::kSequence) {
    throw_if_stopped(stop);
    notify("match", 0, 1);
    std::vector<cv::Mat> lumas(samples.size());
    oneapi::tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
      lumas[i] = merged(in_one ? samples[i] : static_cast<int>(i), carried_at(samples[i]));
    });
    model.emplace(model_of(lumas));
    if (in_one)
      for (std::size_t i = 0; i < samples.size(); ++i) ready[samples[i]] = lumas[i];
    notify("match", 1, 1);
  }
  report.appearance_s = watch.lap();

  // Frames: matched, coloured, laid into the picture through the matte.
  const auto render = [&](cv::Mat luma, const cv::Mat& fluid, const std::optional<CarriedFrame>& brought) {
    if (model)
      luma = model->apply(luma);
    else if (options.matching == AppearanceMatching::kFrame)
      luma = model_of(std::span(&luma, 1)).apply(luma);
    return finisher.finish(luma, fluid, brought ? &*brought : nullptr);
  };

  // Made of whole frames, a loop begins after the transition that changes the picture least (else its
  // timelines see to the seam).
  std::vector<int> order = all;
  if (whole_loop)
    std::rotate(order.begin(),
                order.begin() +
                    (std::min_element(change.begin(), change.end()) - change.begin() + 1) % options.frames,
                order.end());
  std::optional<BoundarySequence> boundary;
  if (moving_boundary)
    boundary.emplace(boundary_of(snapshot, settings, placement, layers, alpha, motion, order, options));
  Handover handover(sink);
  for (int first = 0; first < options.frames; first += batch) {
    const int count = std::min(batch, options.frames - first);
    const std::span<const int> outputs = std::span(order).subspan(first, count);
    if (!in_one) {
      for (const auto& layer : layers) blend(*layer, outputs);
      report.blend_s += watch.lap();
    }
    for (int done = 0; done < count;) {
      throw_if_stopped(stop);
      std::vector<cv::Mat> finished(std::min(kRendered, count - done)), mattes(finished.size(), alpha);
      if (boundary)
        for (cv::Mat& fluid : mattes) {
          fluid = boundary->next();
          if (options.matte_sink) options.matte_sink(fluid);
        }
      oneapi::tbb::parallel_for(std::size_t{0}, finished.size(), [&](std::size_t i) {
        const int output = outputs[done + i];
        const auto found = ready.find(output);
        const std::optional<CarriedFrame> brought = carried_at(output);
        const cv::Mat luma = found != ready.end()
                                 ? std::exchange(found->second, {})
                                 : merged(in_one ? output : done + static_cast<int>(i), brought);
        finished[i] = render(luma, mattes[i], brought);
      });
      handover.take(std::move(finished));
      done += kRendered;
      notify("render", first + std::min(done, count), options.frames);
    }
    report.render_s += watch.lap();
  }
  handover.wait();
  report.render_s += watch.lap();
  for (const auto& layer : layers) report.decode_s += layer->read_s();
  report.blend_s -= report.decode_s;
  report.total_s = total.seconds();
  return report;
}

}  // namespace freshet::synth::animate
