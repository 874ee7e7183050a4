#include "synth/animate/paper/paper_renderer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "synth/animate/frames/clip_batches.h"
#include "synth/animate/frames/enlarge.h"
#include "synth/animate/frames/pieces_canvas.h"
#include "synth/animate/motion/motion_sequence.h"
#include "synth/sampling/pull_push.h"

namespace freshet::synth::animate {
namespace {

/// Lengths in px are meant for pieces of their own size: enlarged ones are matched as widely.
AppearanceOptions enlarged(AppearanceOptions options, double scale) {
  options.region_px = static_cast<int>(std::lround(options.region_px * scale));
  options.levels += static_cast<int>(std::lround(std::log2(scale)));
  return options;
}

class PaperRenderer final : public Renderer {
 public:
  PaperRenderer(Animation& animation, const StillPart& still, const PaperOptions& options)
      : animation_(animation),
        luma_(still.luma),
        alpha_(still.alpha),
        matching_(options.matching),
        appearance_(enlarged(options.appearance, animation.placement.piece_scale)),
        canvas_(animation.placement, animation.picture.size()),
        batches_(animation, animation.placement, options.resampling, ClipDetail::kDifference, options.blend) {
    measure_clips(options.resampling);
    animation.tell("base", 0, 0);
    const Exposure exposure = expose(animation, still, options.base);
    exposure_ = animation.options.moving() ? sampling::pull_push(exposure.luma, still.alpha) : exposure.luma;
    finisher_.emplace(finisher_of(animation, still, exposure.colour));
    animation.report.base_s += animation.watch.lap();
    if (matching_ == AppearanceMatching::kSequence) match();
  }

  int batch() const override { return batches_.batch(); }
  int first() const override { return first_; }
  cv::Mat motion(int output) const override { return sequence_->at(output); }
  cv::Mat step(int output) const override { return sequence_->at(output) / animation_.options.fps; }

  void read(std::span<const int> outputs) override { batches_.read(outputs); }

  void prepare(std::span<const int> outputs, std::span<const cv::Mat>, std::size_t passed) override {
    for (const int output : outputs.first(passed)) batches_.blender().drop(batches_.slot(output));
  }

  cv::Mat finish(int output, const cv::Mat& matte) override {
    const auto found = ready_.find(output);
    cv::Mat luma = found != ready_.end() ? std::exchange(found->second, {}) : merged(output);
    if (matching_ != AppearanceMatching::kNone)
      luma = model_ ? model_->apply(luma) : model_of(std::span(&luma, 1)).apply(luma);
    return animation_.options.form == FrameForm::kFluid ? finisher_->finish_fluid(luma, matte, nullptr)
                                                        : finisher_->finish(luma, matte, nullptr);
  }

 private:
  /// The averages of every clip's patches, then their differences, and how they move where that is asked for.
  void measure_clips(Resampling resampling) {
    const FrameOptions& frames = animation_.options;
    // Made of whole frames, a loop begins after the transition that changes the picture least (else its
    // timelines see to the seam).
    const bool whole_loop = frames.loop && resampling == Resampling::kNearest;
    std::vector<double> change(static_cast<std::size_t>(frames.frames), 0.0);
    std::optional<MotionSums> motion;
    if (frames.moving() || frames.motion_sink)
      motion.emplace(animation_.snapshot, animation_.settings, animation_.placement,
                     animation_.picture.size(), frames.frames, frames.tiles.get());
    batches_.begin(frames.frames, matching_ == AppearanceMatching::kSequence,
                   [&](ClipLayer& layer, std::span<const int> kept) {
                     layer.measure(kept, whole_loop ? &change : nullptr);
                     if (motion) add_motion(animation_, layer, *motion);
                   });
    if (motion) sequence_.emplace(std::move(*motion).means());
    if (whole_loop)
      first_ = static_cast<int>((std::min_element(change.begin(), change.end()) - change.begin() + 1) %
                                frames.frames);
  }

  /// Luminance of an output frame; once.
  cv::Mat merged(int output) {
    cv::Mat luma = exposure_.clone();
    add_enlarged(batches_.blender().take(batches_.slot(output)), canvas_.rect(), canvas_.scale(), luma);
    return luma;
  }

  AppearanceModel model_of(std::span<const cv::Mat> frames) const {
    return AppearanceModel(luma_, alpha_, frames, appearance_);
  }

  /// One model of contrast and levels for the whole animation.
  void match() {
    animation_.throw_if_stopped();
    animation_.tell("match", 0, 1);
    const std::span<const int> samples = batches_.samples();
    std::vector<cv::Mat> lumas(samples.size());
    oneapi::tbb::parallel_for(std::size_t{0}, samples.size(),
                              [&](std::size_t i) { lumas[i] = merged(samples[i]); });
    model_.emplace(model_of(lumas));
    if (batches_.in_one())
      for (std::size_t i = 0; i < samples.size(); ++i) ready_[samples[i]] = lumas[i];
    animation_.tell("match", 1, 1);
    animation_.report.appearance_s = animation_.watch.lap();
  }

  Animation& animation_;
  const cv::Mat luma_, alpha_;  // of the still
  const AppearanceMatching matching_;
  const AppearanceOptions appearance_;
  const PiecesCanvas canvas_;
  ClipBatches batches_;
  int first_ = 0;
  std::optional<MotionSequence> sequence_;
  cv::Mat exposure_;  // luma
  std::optional<FrameFinisher> finisher_;
  std::optional<AppearanceModel> model_;
  std::map<int, cv::Mat> ready_;  // by output frame: luminance made already, for the model
};

}  // namespace

std::unique_ptr<Renderer> make_renderer(Animation& animation, const StillPart& still,
                                        const PaperOptions& options) {
  animation.report.method = "paper";
  return std::make_unique<PaperRenderer>(animation, still, options);
}

}  // namespace freshet::synth::animate
