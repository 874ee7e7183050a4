// synth/animate/carried_base.h — the picture's own detail, carried along by the assigned motion.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth {

struct CarriedBaseOptions {
  double share = 1;     // of the picture that is carried, 0..1; the rest is the long exposure
  double life_s = 3;    // how long one copy of the picture is carried before a fresh one takes over
  double max_px = 160;  // and no copy is carried further than this to either side: where the fluid is faster
                        // than that allows, less of the picture is carried
  double edge_px = 32;  // over which a copy fades towards the matte's edge
  int loop_frames = 0;  // > 0: the sequence repeats after so many frames
};

/// What lies still below the moving differences, made to move. The paper's long exposure blurs away the
/// picture's flames and splashes, or leaves them standing frozen; here they go with the flow.
///
/// Three copies of the picture are carried along the motion field, each from half a life before its place to
/// half a life beyond, a third of a life apart. Their weights (1 + cos) / 3 always sum to 1 and their squares
/// to 1/2, so that neither the level nor the contrast pulses. What is shown repeats every third of a life, or
/// of what comes nearest to it and divides a loop. A copy brings only what is fluid; where it
/// would bring what is not, the long exposure shows. Source: the carrying of textures by flow with
/// regeneration, after Max and Becker 1995 and Neyret 2003
/// ("advected textures"); not in Okabe et al. 2011.
class CarriedBase {
 public:
  /// picture   CV_32FC3, BGR, 0..1; luma CV_32F, its luma_of; matte CV_32F, 0..1.
  /// exposure  CV_32F: base_image of the picture: what shows where nothing can be carried.
  /// motion    CV_32FC2, px/s, all of one size.
  /// Memory    at most 98 maps at a quarter of the picture's width and height, and four planes: 55 bytes a
  /// pixel with the
  ///           defaults at 25 frames a second (50 MB at 1280 x 720).
  CarriedBase(const cv::Mat& picture, const cv::Mat& luma, const cv::Mat& matte, const cv::Mat& exposure,
              const cv::Mat& motion, double fps, const CarriedBaseOptions& options);

  /// Luma of the base at output frame i >= 0: CV_32F. Safe from many threads.
  /// colour   if not null: CV_32FC4 of what was carried to each pixel: its luma, its blue and its red less
  /// that
  ///          luma, and its share of the base there, 0..1. A flame brings its own colour with it.
  cv::Mat frame(int i, cv::Mat* colour = nullptr) const;

 private:
  cv::Mat fluid_;             // CV_32FC4: luma, blue - luma, red - luma, 1: each times the matte, faded
  cv::Mat exposure_, share_;  // CV_32F; share: of the carried picture against the exposure
  // Displacement from a place to its source, px, CV_32FC2 at a quarter, every stride_ frames from a copy's
  // own time on: fluid that has come, and fluid that is yet to come.
  std::vector<cv::Mat> past_, future_;
  int life_ = 0, stride_ = 1;  // frames
  cv::Size size_;
};

}  // namespace freshet::synth
