// synth/animate/still/carried_base.h — the picture's own detail, carried along by the assigned motion.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

struct CarriedBaseOptions {
  double fraction = 1;  // of the picture that is carried, 0..1; the rest is the long exposure
  double life_s = 3;    // how long one copy of the picture is carried before a fresh one takes over
  /// No copy is carried further than this to either side: where the fluid is faster than that allows, less of
  /// the picture is carried.
  double max_px = 160;
  double edge_px = 32;  // over which a copy fades towards the matte's edge
  int loop_frames = 0;  // > 0: the sequence repeats after so many frames
};

/// What was carried to each place of the picture in one frame, compact: it is kept for as long as it repeats.
struct CarriedFrame {
  static constexpr int kOne = 1 << 14;
  cv::Mat luma;  // CV_16S, 1 / kOne, the picture's size
  /// CV_16S, 1 / kOne, of half the width and height, rounded up. blue and red: less luma; a flame brings its
  /// own colour with it. fraction: of the base there, 0..1, against the long exposure.
  cv::Mat blue, red, fraction;
};

/// What lies still below the moving differences, made to move. The paper's long exposure blurs away the
/// picture's flames and splashes, or leaves them standing frozen; here they go with the flow.
///
/// Three copies of the picture are carried along the motion field, each from half a life before its place to
/// half a life beyond, a third of a life apart. Their weights (1 + cos) / 3 always sum to 1 and their squares
/// to 1/2, so that neither the level nor the contrast pulses. What is shown repeats every third of a life. In
/// a loop that period is changed to the nearest one that divides the loop. A copy brings only what is fluid;
/// where it would bring what is not, the long exposure shows.
///
/// Source   the carrying of textures by flow with regeneration, after Max and Becker 1995 and Neyret 2003
///          ("advected textures"); not in Okabe et al. 2011.
class CarriedBase {
 public:
  /// picture   CV_32FC3, BGR, 0..1.
  /// luma      CV_32F, its luma_of.
  /// matte     CV_32F, 0..1.
  /// motion    CV_32FC2, px/s, all of one size.
  /// Memory    at most 98 maps at a quarter of the picture's width and height, and a few planes: 65 bytes per
  ///           pixel with the defaults at 25 frames per second (60 MB at 1280 x 720).
  CarriedBase(const cv::Mat& picture, const cv::Mat& luma, const cv::Mat& matte, const cv::Mat& motion,
              double fps, const CarriedBaseOptions& options);

  /// Output frame i >= 0. Safe from many threads; no scratch to speak of.
  CarriedFrame frame(int i) const;
  /// Frames after which frame() repeats.
  int period() const { return period_; }
  static int period(double fps, const CarriedBaseOptions& options);
  /// Of a CarriedFrame of a picture.
  static std::size_t frame_bytes(cv::Size picture);

 private:
  /// Displacements from a place to its source, px: CV_32F at a quarter.
  struct Map {
    cv::Mat u, v;
  };
  struct Scratch;
  void carry(const cv::Rect& cell, int i, CarriedFrame& out, Scratch& scratch) const;

  // The picture as pairs of luma and weight: how far it is fluid, faded towards the matte's edge. At half its
  // width and height, fours of blue - luma, red - luma, weight and 0. Each has a margin. Beyond the matte the
  // fluid's own values go on: what a copy brings from there counts little, and it is not rock.
  cv::Mat fluid_, colour_;  // CV_32FC2, CV_32FC4
  /// CV_32F, at half size: the maximum that the carried picture counts; the place's own weight.
  cv::Mat max_fraction_, own_;
  std::vector<cv::Rect> cells_;  // px, where anything is carried
  // Every stride_ frames from a copy's own time on: fluid that has come, and fluid that is yet to come.
  std::vector<Map> past_, future_;
  std::vector<std::int32_t> map_x_, map_y_;     // by column, row: the sample of a map before it
  std::vector<float> fraction_x_, fraction_y_;  // of the one after that
  int life_ = 0, period_ = 1, stride_ = 1;      // frames
  cv::Size size_, half_;
};

/// Row y of a frame's values at half size, between their samples: width floats each.
void colour_row(const CarriedFrame& frame, int y, int width, float* blue, float* red, float* fraction);

/// Luma of the base: the carried picture over the long exposure.
/// exposure   CV_32F: base_image of the picture.
/// out        CV_32F.
void show_carried(const CarriedFrame& frame, const cv::Mat& exposure, cv::Mat& out);

}  // namespace freshet::synth::animate
