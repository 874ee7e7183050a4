// synth/outline/moving_outline.h — the fluid's moving outline: a matte per frame, and its background.
#pragma once

#include <functional>

#include <opencv2/core.hpp>

#include "synth/outline/background.h"
#include "synth/outline/dynamic_matte.h"

namespace freshet::synth::outline {

enum class Outline {
  kStatic,  // the still picture's matte, in every frame
  kMoving,  // carried along by the fluid, with softer rims
};

struct MovingOutlineOptions {
  Outline kind = Outline::kStatic;
  DynamicMatteOptions matte;
  cv::Mat held;  // CV_8U, the picture's size, 255 where something stands before the fluid; or empty
  /// CV_8UC3 or CV_32FC3 (1 is white), the picture's size: what lies behind the fluid; empty: inpainted.
  cv::Mat background;
  InpaintOptions inpaint;
};

/// What a frame is laid on where the fluid was. CV_32FC3, 0..1: the background inside the matte, and the
/// picture itself outside. Where the matte is fractional the picture is already a mixture, so the background
/// takes over early, in full from a matte of 1/8.
/// picture  CV_8UC3, or CV_32FC3: 1 is white.
/// matte    CV_8U.
/// Throws   Error{kInput} for a background of another size, or a matte that leaves none to be seen.
cv::Mat behind_fluid(const cv::Mat& picture, const cv::Mat& matte, const MovingOutlineOptions& options);

/// Mattes of the frames one after the other, first the still one; asked for in order.
class MatteSequence {
 public:
  /// motion   velocity in frame i, CV_32FC2, px/s, as MotionSequence::at.
  /// ring     0, or the number of frames after which the motion begins again. The matte is then brought to
  ///          its own period first, and so has no seam; it no longer begins as the still one.
  /// held     MovingOutlineOptions::held: alpha is less that already. The fluid goes on behind it, as it is beside
  ///          it, and comes out on the other side.
  MatteSequence(const cv::Mat& alpha, const cv::Mat& mean_motion, double fps,
                const DynamicMatteOptions& options, std::function<cv::Mat(int)> motion, int ring = 0,
                const cv::Mat& held = {});
  /// CV_32F, 0..1; shares nothing with later ones.
  cv::Mat next();

 private:
  cv::Mat seen_;  // CV_32F, 0..1: 1 less what is held; empty: all is seen
  DynamicMatte matte_;
  std::function<cv::Mat(int)> motion_;
  int frame_ = 0;
};

}  // namespace freshet::synth::outline
