// synth/animate/forms/parted_still.h — a picture of fire as what shines, and what it shines on.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// picture = ground + light, of light (light.h), everywhere and to rounding. Logs, rims and chimneys are ground; so are
/// embers, which glow and have no flame's form.
struct PartedStill {
  cv::Mat ground;       // CV_32FC3: continued below the flames from the dark around them
  cv::Mat light;        // CV_32FC3, its luma 0 and more, a colour of it also less; 0 outside of the matte
  cv::Mat level;        // CV_32F, 0..1: of the light's luma, where flames and their glow are; else 0
  cv::Mat before;       // CV_32F, 0..1: what is dark between the feet of flames, and so may stand before them
  double share = 0;     // of the matte that shines, 0..1
  double contrast = 0;  // mean level of what shines less that of what lies around it, 0..1; 0: nothing does
};

/// Levels that flames lose behind what may stand before them (PartedStill::before).
inline constexpr float kLostBehind = 0.6f;

/// What shines is warm (red before green before blue, or white within what is so), not pale as what it lights (blue
/// above .6 of red over 2.4 % of the longer side, and not white), and lighter than the threshold that parts the fluid
/// and its surroundings best (Otsu 1979). Blue gas flames are not found. Embers are redder than the upper half of their
/// fire is where it is as bright, and not the orange of flames.
/// picture  CV_32FC3, sRGB code, 1 is white.
/// alpha    CV_32F, 0..1, of its size.
PartedStill part(const cv::Mat& picture, const cv::Mat& alpha);

}  // namespace freshet::synth::animate
