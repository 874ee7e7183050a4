// synth/animate/frames/still_part.h — what of an animation stands still: the picture in the forms that frames are made
// from.
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "synth/animate/frames/animation.h"
#include "synth/animate/still/base_image.h"
#include "synth/animate/still/colour_curve.h"
#include "synth/animate/still/colour_model.h"
#include "synth/animate/still/colour_range.h"
#include "synth/animate/still/finished_frame.h"

namespace freshet::synth::animate {

/// All of the picture's size.
struct StillPart {
  cv::Mat target, luma;     // the picture, CV_32FC3, and its luma, CV_32F; 1 is white
  cv::Mat alpha;            // the matte, CV_32F 0..1
  cv::Mat behind;           // with a moving outline: behind_fluid
  cv::Mat assigned_motion;  // CV_32FC2, px/s: the patches' own
  cv::Mat asked_motion;     // the same as it is asked (apply_guide)
  ColourModel colours;

  /// Once a renderer has been made: what frames do not need, 36 bytes a pixel, and 20 more unless an outline moves.
  void release_for_frames(bool moving) {
    colours = {};
    assigned_motion.release();
    luma.release();
    if (moving) return;
    target.release();
    asked_motion.release();
  }
};
/// Throws   as behind_fluid, before any other work.
StillPart read_still(const Animation& animation);

/// Colour from luminance over 12 px of a piece of its own size. still  its target, luma and alpha.
ColourModel colours_of(const StillPart& still, double piece_scale);

/// The classes of fluid that falls, glitters and ripples, that leaps, and that drifts.
inline constexpr const char *kWater = "water", *kFire = "fire", *kClouds = "clouds";

/// Whether more than half of the patches are of clips of this class.
bool places_class(const Animation& animation, const std::string& name);

/// The picture as a long exposure along its motion.
struct Exposure {
  cv::Mat luma;    // CV_32F
  cv::Mat colour;  // CV_32FC3, BGR: what colour does beside luminance (StillPart::colours)
};
/// Lengths of the options are px of a piece's own size.
Exposure expose(const Animation& animation, const StillPart& still, const BaseImageOptions& options);

/// The last step of frames. With a moving outline the fluid's layers go on beyond the still matte, for it to uncover.
/// curve   of what is carried; empty where nothing is.
/// range   of the picture's fluid; empty: no limit.
FrameFinisher finisher_of(const Animation& animation, const StillPart& still, const cv::Mat& own_colour,
                          const ColourCurve& curve = {}, const ColourRange& range = {});

}  // namespace freshet::synth::animate
