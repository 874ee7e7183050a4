#include "synth/animate/forms/forms_renderer.h"

#include <algorithm>
#include <map>
#include <utility>

#include "freshet/error.h"
#include "synth/animate/forms/form_frames.h"
#include "synth/animate/forms/forms_plan.h"
#include "synth/animate/forms/handed_frame.h"
#include "synth/animate/forms/own_flames.h"

namespace freshet::synth::animate {
namespace {

bool is_fire(const store::Snapshot& snapshot, store::ClipId clip) {
  return snapshot.clip(clip).class_name == kFire;
}

/// Those of the placement first, by how many pieces show them.
std::vector<store::ClipId> clips_of(const Animation& animation, const FormsOptions& options) {
  std::map<store::ClipId, std::size_t> placed;
  for (const PlacedPatch& patch : animation.placement.patches) ++placed[patch.clip];
  std::vector<store::ClipId> clips;
  for (const store::ClipId clip : animation.snapshot.clips()) {
    const std::string& name = animation.snapshot.clip(clip).name;
    const bool excluded =
        std::find(options.excluded.begin(), options.excluded.end(), name) != options.excluded.end();
    if (is_fire(animation.snapshot, clip) && !excluded && (!options.placed_only || placed.contains(clip)))
      clips.push_back(clip);
  }
  std::stable_sort(clips.begin(), clips.end(),
                   [&](store::ClipId a, store::ClipId b) { return placed[a] > placed[b]; });
  return clips;
}

FormsPlan plan_of(const Animation& animation, const StillPart& still, const FormsOptions& options) {
  animation.tell("choosing forms", 0, 1);
  const FrameOptions& frames = animation.options;
  return plan_forms(animation.snapshot, animation.settings.flow_step, still.target, still.alpha,
                    clips_of(animation, options),
                    {.frames = frames.frames, .fps = frames.fps, .speed = mean_speed(animation.placement)},
                    frames.tiles.get());
}

class FormsRenderer final : public Renderer {
 public:
  FormsRenderer(Animation& animation, const StillPart& still, FormsPlan plan, const FormsOptions& options)
      : animation_(animation),
        picture_(still.target),
        plan_(std::move(plan)),
        frames_(still.target, still.alpha, plan_.still, plan_.forms, plan_.players,
                {.frames = animation.options.frames,
                 .fps = animation.options.fps,
                 .loop = animation.options.loop,
                 .handover_s = options.handover_s,
                 .lighting = options.lighting}) {
    AnimateReport& report = animation_.report;
    report.method = "forms";
    report.flames = "clips";
    report.forms_fit = plan_.fit;
    report.forms_lack = plan_.lack;
    for (std::size_t f = 0; f < plan_.forms.size(); ++f)
      report.forms.push_back(
          {.clip = plan_.clips[f], .first = plan_.forms[f].first, .fit = plan_.forms[f].fit});
    std::vector<store::ClipId> different = plan_.clips;
    std::sort(different.begin(), different.end());
    report.clips =
        static_cast<std::size_t>(std::unique(different.begin(), different.end()) - different.begin());
    report.base_s += animation_.watch.lap();
  }

  int batch() const override { return std::min(kBatch, animation_.options.frames); }
  cv::Mat motion(int) const override { return cv::Mat::zeros(picture_.size(), CV_32FC2); }
  cv::Mat step(int output) const override { return frames_.step(output); }
  void read(std::span<const int> outputs) override {
    const int beyond = animation_.options.motion_sink ? 1 : 0;  // leads to the frame after them
    frames_.load(outputs.front(), static_cast<int>(outputs.size()) + beyond);
    animation_.report.decode_s += animation_.watch.lap();
  }
  void prepare(std::span<const int>, std::span<const cv::Mat>, std::size_t) override {}

  cv::Mat finish(int output, const cv::Mat& matte) override {
    return handed_on(frames_.frame(output), picture_, matte, animation_.options.form);
  }

 private:
  static constexpr int kBatch = 16;  // frames: a slab of a clip's tiles

  Animation& animation_;
  const cv::Mat picture_;  // CV_32FC3
  FormsPlan plan_;
  FormFrames frames_;
};

std::unique_ptr<Renderer> of_own(Animation& animation, const StillPart& still, PartedStill parted,
                                 const FormsOptions& options) {
  animation.report.method = "forms";
  animation.report.flames = "own";
  return own_flames(animation, still, std::move(parted),
                    {.carried = options.carried,
                     .handover_s = options.handover_s,
                     .lighting = options.lighting,
                     .clips = clips_of(animation, options),
                     .pace = mean_speed(animation.placement)});
}

}  // namespace

std::unique_ptr<Renderer> make_renderer(Animation& animation, const StillPart& still,
                                        const FormsOptions& options) {
  if (animation.options.moving())
    throw Error(ErrorKind::kInput, "forms of clips",
                "they bring an outline of their own, and a moving one was asked",
                "Leave out --boundary moving, or add --method carried");
  if (options.flames == Flames::kOwn) {
    PartedStill parted = part(still.target, still.alpha);
    if (parted.contrast <= 0)
      throw Error(ErrorKind::kInput, "forms of the picture's own flames",
                  "no flames are found in the picture", "Add --method carried");
    return of_own(animation, still, std::move(parted), options);
  }
  FormsPlan plan = plan_of(animation, still, options);
  if (plan.forms.empty())
    throw Error(ErrorKind::kInput, "forms of clips", plan.lack,
                "Add --method carried, or ingest clips of flames before a dark ground");
  return std::make_unique<FormsRenderer>(animation, still, std::move(plan), options);
}

std::unique_ptr<Renderer> fire_renderer(Animation& animation, const StillPart& still,
                                        const FormsOptions& options) {
  if (!places_class(animation, kFire)) return nullptr;
  PartedStill parted = part(still.target, still.alpha);
  if (parted.contrast < kLeastContrast) return nullptr;
  animation.report.by_itself = true;
  return options.flames == Flames::kOwn ? of_own(animation, still, std::move(parted), options)
                                        : make_renderer(animation, still, options);
}

}  // namespace freshet::synth::animate
