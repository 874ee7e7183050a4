// synth/animate/still/glitter.h — the sparkles of a still's water, parted from the water that they lie on.
#pragma once

#include <array>
#include <span>

#include <opencv2/core.hpp>

#include "synth/animate/motion/copy_maps.h"
#include "synth/animate/still/carried_base.h"

namespace freshet::synth::animate {

/// Where a low sun or a moon stands in water, a sparkle is a facet of a wave that mirrors it for a moment. In two clips
/// of it (a moon on a sea, a sunset on a lake, at 640 px) what is smaller than 17 px is half another after .1 s (lake,
/// sparkles of 2 px across) to .25 s (sea, 6 px), and has gone a pixel or two by then; where how many are lit stays.
/// Carried along, sparkles slide. So the picture is parted into its ground and the light of its sparkles, and that
/// light into
///
/// - its usual strength, which belongs to the place;
/// - the sparkles over it, whose copies stay where they are and go over to others soon (CopyMaps).
///
/// Lengths are those of a picture of 640 px, others in proportion.
/// Source: none in Okabe et al. 2011.
class Glitter {
 public:
  /// Finds sparkles: detail that is strong (from .13 of white on, .18: surely), lies level as ripples do, and is as
  /// bright as its ground again. Nothing glitters where they hold less than a tenth of the light above the ground.
  /// picture  CV_32FC3, BGR, 1 is white; luma CV_32F, its luma_of; matte CV_32F, 0..1, of its size.
  /// share    of that light that is to glitter, 0..1.
  /// Cost     a dozen passes over the picture, one thread. Memory: 28 bytes a pixel.
  Glitter(const cv::Mat& picture, const cv::Mat& luma, const cv::Mat& matte, double share);

  bool any() const { return !where_.empty(); }
  /// CV_32F, 0..1: how far a place glitters. Empty, as all that follows, where none does.
  const cv::Mat& where() const { return where_; }
  /// The picture without its sparkles, CV_32FC3, and its luma.
  const cv::Mat& ground() const { return ground_; }
  const cv::Mat& ground_luma() const { return ground_luma_; }
  void release_ground() {
    ground_.release();
    ground_luma_.release();
  }
  /// Over which sparkles are alike across, px: 2 for crumbs of light, 6 where they run together (of 640 px).
  double size_px() const { return size_px_; }
  /// CV_32F, the picture's size, -1/4 .. 7/4: a quarter of the sparkles over their usual strength, less 1. Its mean
  /// is 0 where it glitters. It takes the place of luma in what is carried.
  const cv::Mat& texture() const { return texture_; }
  /// Adds the light of a frame's sparkles to its luma and, where it brings its colour, to that (or null).
  /// texture  what its copies bring. Mixed, they agree in nothing, and get back what contrast they lose.
  /// step     px of the picture between samples of the maps. Safe from many threads.
  void add(const cv::Mat& texture, std::span<const CopyMap> copies, int step, cv::Mat& luma,
           CarriedFrame* frame) const;

 private:
  double size_px_ = 0;
  cv::Mat where_, ground_, ground_luma_, texture_;
  cv::Mat usual_;      // CV_32F: the usual strength
  cv::Mat brightest_;  // CV_32F: of the still's luma around a place; no sparkle is brighter
  // CV_32F, of half the width and height: the light's blue and red less its luma, over that.
  std::array<cv::Mat, 2> colour_;
};

}  // namespace freshet::synth::animate
