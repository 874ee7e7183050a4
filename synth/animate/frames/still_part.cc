#include "synth/animate/frames/still_part.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <oneapi/tbb/parallel_invoke.h>

#include "synth/animate/motion/motion_field.h"
#include "synth/sampling/pull_push.h"

namespace freshet::synth::animate {
namespace {

/// CV_32FC3, 1 is white.
cv::Mat in_units(const cv::Mat& picture) {
  cv::Mat out = picture;
  if (picture.depth() == CV_8U) picture.convertTo(out, CV_32F, 1.0 / 255);
  return out;
}

}  // namespace

StillPart read_still(const Animation& animation) {
  StillPart still;
  const FrameOptions& options = animation.options;
  if (options.moving())
    still.behind = outline::behind_fluid(animation.picture, animation.matte, options.outline);
  still.target = in_units(animation.picture);
  still.luma = luma_of(still.target);
  animation.matte.convertTo(still.alpha, CV_32F, 1.0 / 255);
  oneapi::tbb::parallel_invoke(
      [&] {
        still.assigned_motion = motion_field(animation.snapshot, animation.settings, animation.placement,
                                             animation.picture.size());
        still.asked_motion = apply_guide(still.assigned_motion, options.guide, still.alpha);
      },
      [&] { still.colours = colours_of(still, animation.placement.piece_scale); });
  return still;
}

ColourModel colours_of(const StillPart& still, double piece_scale) {
  return fit_colour(still.target, still.luma, still.alpha, static_cast<int>(std::lround(12 * piece_scale)));
}

bool places_class(const Animation& animation, const std::string& name) {
  std::size_t of_class = 0;
  for (const PlacedPatch& patch : animation.placement.patches)
    of_class += animation.snapshot.clip(patch.clip).class_name == name ? 1 : 0;
  return 2 * of_class > animation.placement.patches.size();
}

Exposure expose(const Animation& animation, const StillPart& still, const BaseImageOptions& options) {
  BaseImageOptions enlarged = options;
  enlarged.max_length_px *= animation.placement.piece_scale;
  enlarged.max_sigma_px *= animation.placement.piece_scale;
  std::array<cv::Mat, 3> own;
  {
    cv::Mat modelled;
    apply_colour(still.colours, still.luma, modelled);
    cv::split(still.target - modelled, own.data());
  }
  // The model keeps luma: two of the three colours tell the third, and one pass blurs all.
  cv::Mat together;
  cv::merge(std::vector<cv::Mat>{still.luma, own[0], own[2]}, together);
  std::array<cv::Mat, 3> blurred;
  cv::split(base_image(together, still.alpha, still.asked_motion, enlarged), blurred.data());
  const cv::Mat green = -(kBlueLuma * blurred[1] + kRedLuma * blurred[2]) / kGreenLuma;
  Exposure exposure{.luma = blurred[0], .colour = {}};
  cv::merge(std::vector<cv::Mat>{blurred[1], green, blurred[2]}, exposure.colour);
  return exposure;
}

FrameFinisher finisher_of(const Animation& animation, const StillPart& still, const cv::Mat& own_colour,
                          const ColourCurve& curve, const ColourRange& range) {
  if (!animation.options.moving())
    return FrameFinisher(still.colours, curve, own_colour, still.target, range);
  return FrameFinisher({.slope = sampling::pull_push(still.colours.slope, still.alpha),
                        .offset = sampling::pull_push(still.colours.offset, still.alpha)},
                       curve, sampling::pull_push(own_colour, still.alpha), still.behind, range);
}

}  // namespace freshet::synth::animate
