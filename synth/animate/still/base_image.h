// synth/animate/still/base_image.h — the picture as a long exposure: the still ground of moving differences.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

struct BaseImageOptions {
  double shutter_s = 0.35;    // exposure: the blur along the motion is shutter * speed long
  double max_length_px = 96;  // and no longer than this
  double gaussian_s = 0.035;  // sigma of the further Gaussian blur is this times the speed
  double max_sigma_px = 12;
};

/// A still is an instant: its flames and splashes, left sharp, would stand frozen under the differences.
///
/// picture   CV_32F or CV_32FC3, 0..1.
/// matte     CV_32F, 0..1: only fluid is blurred into fluid; what is outside neither changes nor bleeds in.
/// motion    CV_32FC2, px/s.
/// Returns   the picture blurred along its motion (a line integral, centred), then by a Gaussian in
///           proportion to speed, which removes the edges that the line integral leaves.
///           Unblurred where nothing moves.
/// Cost      O(pixels of the fluid * blur length); all threads. Memory: 16 bytes per pixel for each of up to
///           8 widths, less for wide ones.
/// Source    Okabe et al. 2011, Sec. 6, "Recovery of Color Appearance"; Brostow and Essa 2001.
cv::Mat base_image(const cv::Mat& picture, const cv::Mat& matte, const cv::Mat& motion,
                   const BaseImageOptions& options);

}  // namespace freshet::synth::animate
