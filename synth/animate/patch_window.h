// synth/animate/patch_window.h — how one patch is cut out of a frame of its clip, as its variant shows it.
#pragma once

#include <opencv2/core.hpp>

#include "vision/variant.h"

namespace freshet::synth {

/// Cuts side x side windows out of frames that have already been reduced to the variant's scale
/// (reduce_to_scale), so that all patches of one clip share the reduction. Upright windows are copied or
/// mirrored, turned ones are interpolated bicubically: bilinear interpolation costs a third of the finest
/// band's contrast.
class PatchWindow {
 public:
  /// source   size of the clip's frames. patch: px, top-left corner in the variant's frame.
  PatchWindow(cv::Size source, const vision::Variant& variant, cv::Point patch, int side);
  /// Pixels of the source frame that a window needs, with the interpolation's margin; inside the frame.
  cv::Rect needed() const { return needed_; }
  /// reduced   CV_32F. out CV_32F, side x side.
  void cut(const cv::Mat& reduced, cv::Mat& out) const;

 private:
  int side_ = 0;
  bool upright_ = false, mirrored_ = false;
  cv::Rect window_;  // upright: where in the reduced frame
  cv::Mat x_, y_;    // turned: fixed-point maps into the reduced frame
  cv::Rect needed_;
};

/// A frame at a variant's scale; area average, as vision::warp_to_variant reduces it.
void reduce_to_scale(const cv::Mat& frame, float scale, cv::Mat& out);

}  // namespace freshet::synth
