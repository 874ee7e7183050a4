// synth/animate/still/carried_base.h — the picture's own detail, carried along by the assigned motion.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/motion/copy_maps.h"
#include "synth/animate/still/continued.h"

namespace freshet::synth::animate {

struct CarriedBaseOptions {
  /// Of the picture that is carried, 0..1; the rest is the long exposure.
  double fraction = 1;
  /// Of the surroundings that give a place its look: sigma, px.
  double look_px = 20;
  /// How much of a difference between looks counts against a copy, 0..1.
  double looks = 1;
  /// Over which a copy fades towards the matte's edge, px.
  double edge_px = 32;
  /// px of the picture between samples of the copies' maps: 4, 8 or 16.
  int step = 4;
};

/// CarriedBaseOptions::step for pieces that are enlarged by this much, >= 1: 4, or at most 16 / 3 px of a piece's own
/// size, as the motion is told for squares of 8 of these (MotionSequence).
int step_of_maps(double piece_scale);

/// What was carried to each place of the picture in one frame, compact: it is kept for as long as it repeats.
struct CarriedFrame {
  static constexpr int kOne = 1 << 14;
  cv::Mat luma;  // CV_16S, 1 / kOne, the picture's size
  /// CV_16S, 1 / kOne, of half the width and height, rounded up. blue and red: less luma; a flame brings its
  /// own colour with it. fraction: of the base there, 0..1, against the long exposure.
  cv::Mat blue, red, fraction;
};

/// What lies still below the moving differences, made to move. The paper's long exposure blurs away the
/// picture's flames and splashes, or leaves them standing frozen; here they go with the flow: copies of the
/// picture (CopyMaps) are read where their maps say and mixed. A copy brings only what is fluid; where it would
/// bring what is not, another copy or the long exposure shows.
class CarriedBase {
 public:
  /// fluid     the picture's, which may go on beyond its sides (continued.h).
  /// texture   CV_32F, of its size: carried in place of the picture's luma, without colour (StandingLayout::texture);
  ///           empty: the picture is carried.
  /// Memory    some 30 bytes a pixel.
  CarriedBase(const ContinuedFluid& fluid, const CarriedBaseOptions& options, const cv::Mat& texture = {});

  /// What the copies bring. Safe from many threads; no scratch to speak of.
  CarriedFrame frame(std::span<const CopyMap> copies) const;
  /// Each sample's place as CopyMaps takes them.
  const CopyPlaces& places() const { return places_; }

 private:
  struct Scratch;
  struct Copy {            // of one frame
    cv::Mat weight, u, v;  // CV_32F
  };
  void limit_weights(const cv::Rect& cell, const cv::Rect& half, Scratch& scratch) const;
  void carry(const cv::Rect& cell, std::span<const Copy> copies, CarriedFrame& out, Scratch& scratch) const;

  bool whole(const cv::Rect& read) const;
  // The picture's luma and weight (how far it is fluid, faded towards the matte's edge), and at half its width and
  // height fours of blue - luma, red - luma, weight and 0; each with a margin. Beyond the matte the fluid's own values
  // go on: what a copy brings from there counts little, and it is not rock.
  cv::Mat luma_, weight_, colour_;  // CV_32F, CV_32F, CV_32FC4
  cv::Mat faded_;                   // CV_32S: 255 for each block before it that holds a weight below 1
  CopyPlaces places_;
  cv::Mat own_;  // CV_32F, at half, of the picture: the place's own weight
  float fraction_ = 1;
  bool carries_colour_ = true;
  int step_ = 4;
  std::vector<cv::Rect> cells_;      // px, where anything is carried
  std::vector<std::int32_t> map_y_;  // by row: the sample of a map before it
  std::vector<float> fraction_y_;    // of the one after that
  cv::Rect picture_;                 // in luma_, less its margin
  cv::Size size_, half_;
};

/// Row y of a frame's values at half size, between their samples: width floats each.
void colour_row(const CarriedFrame& frame, int y, int width, float* blue, float* red, float* fraction);

/// Luma of the base: the carried picture over the long exposure.
/// exposure   CV_32F: base_image of the picture; empty: 0.
/// out        CV_32F.
void show_carried(const CarriedFrame& frame, const cv::Mat& exposure, cv::Mat& out);

}  // namespace freshet::synth::animate
