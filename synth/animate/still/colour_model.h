// synth/animate/still/colour_model.h — colour from luminance, as the picture itself pairs them nearby.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// Differences carry their own clip's colours: laid on as they are they made pink casts on grey
/// cascades. So only luminance is transferred, and each place is coloured by the picture's local
/// relation of colour to luminance.
///
/// colour - luma = slope * luma + offset, by least squares in a window around each pixel, weighted by the
/// matte (He, Sun, Tang 2010: the guided filter, its guide the luminance). Adding luma back keeps it exactly.
struct ColourModel {
  cv::Mat slope, offset;  // CV_32FC3, BGR
};

/// bgr     CV_32FC3, 0..1.
/// luma    CV_32F, 0..1.
/// matte   CV_32F.
/// radius  px, of the window.
/// ridge   the variance of luma below which colour is taken as constant.
ColourModel fit_colour(const cv::Mat& bgr, const cv::Mat& luma, const cv::Mat& matte, int radius = 12,
                       double ridge = 4e-4);

/// bgr of a luminance picture; CV_32FC3, may lie outside 0..1.
void apply_colour(const ColourModel& model, const cv::Mat& luma, cv::Mat& bgr);

/// ITU-R BT.601 luma of BGR in 0..1.
inline constexpr float kBlueLuma = 0.114f, kGreenLuma = 0.587f, kRedLuma = 0.299f;
cv::Mat luma_of(const cv::Mat& bgr);
inline float luma_of(const cv::Vec3f& bgr) {
  return kBlueLuma * bgr[0] + kGreenLuma * bgr[1] + kRedLuma * bgr[2];
}

}  // namespace freshet::synth::animate
