#include "synth/animate/forms/forms_plan.h"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

namespace freshet::synth::animate {
namespace {

constexpr std::uint32_t kMostFormFrames = 480;  // of a clip that are looked at
constexpr double kMostShare = 0.75;  // where more of the fluid shines, flames are no light over a ground
constexpr double kWallTop = 0.08,
                 kWallSides = 0.04;  // of the picture: a fire that meets these has no form of its own

bool is_wall(const PartedStill& still, std::span<const ChosenForm> forms) {
  double cut = 0, all = 0;
  for (const ChosenForm& form : forms) {
    all += form.seat.share;
    const bool sides = form.seat.left < kWallSides * still.level.cols &&
                       form.seat.right > (1 - kWallSides) * still.level.cols;
    if (form.seat.top < kWallTop * still.level.rows || sides) cut += form.seat.share;
  }
  return cut > 0.5 * all;
}

std::string lack_of(const FormsPlan& plan) {
  if (plan.still.contrast <= 0) return "no flames are found in the picture";
  if (plan.forms.empty()) return "no clip has flames before a dark ground";
  if (plan.still.contrast < kLeastContrast) return "the flames are hardly lighter than what is around them";
  if (plan.still.share > kMostShare) return "the fluid is all flames, without a ground";
  if (is_wall(plan.still, plan.forms)) return "the picture cuts the flames";
  if (plan.fit < kFormsFit)
    return fmt::format("no clip's flames are like the picture's (fit {:.2f}, {:.2f} at least)", plan.fit,
                       kFormsFit);
  return "";
}

}  // namespace

FormsPlan plan_forms(const store::Snapshot& snapshot, int flow_step, const cv::Mat& picture,
                     const cv::Mat& alpha, std::span<const store::ClipId> clips, const FormPlaying& playing,
                     stored::DecodedTiles* tiles) {
  FormsPlan plan;
  plan.still = part(picture, alpha);
  if (plan.still.contrast > 0) {
    std::vector<ClipForms> forms;
    for (const store::ClipId clip : clips) {
      if (forms.size() == kFormsClips) break;
      // A form begins at the latest a third into a clip that is short (choose_forms).
      if (plays(snapshot, clip, snapshot.clip(clip).frame_count / 3, playing))
        forms.push_back(clip_forms(snapshot, clip, kMostFormFrames));
    }
    plan.forms = choose_forms(plan.still, forms, playing.frames / playing.fps * playing.speed);
    for (const ChosenForm& form : plan.forms) plan.clips.push_back(forms[form.clip].clip);
    plan.fit = overall_fit(plan.forms);
  }
  plan.lack = lack_of(plan);
  for (std::size_t f = 0; f < plan.forms.size(); ++f)
    plan.players.push_back(
        std::make_unique<FormPlayer>(snapshot, plan.clips[f], flow_step, plan.forms[f], playing, tiles));
  return plan;
}

}  // namespace freshet::synth::animate
