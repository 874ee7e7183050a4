// synth/sampling/patch_window.h — a patch cut out of a frame of its clip, as its variant shows it.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "vision/variant.h"

namespace freshet::synth::sampling {

/// Cuts side x side windows out of frames that have already been reduced to the variant's scale
/// (area_reduction.h), so that all patches of one clip share the reduction. Upright windows are
/// copied or mirrored, turned ones are interpolated bicubically: bilinear interpolation costs a third
/// of the finest band's contrast.
class PatchWindow {
 public:
  /// source   size of the clip's frames.
  /// patch    px, top-left corner in the variant's frame.
  PatchWindow(cv::Size source, const vision::Variant& variant, cv::Point patch, int side);
  /// Pixels of the source frame that a window needs, with the interpolation's margin; inside the frame.
  cv::Rect needed() const { return needed_; }
  /// Pixels of the reduced frame that cut() reads.
  cv::Rect read() const { return read_; }
  /// reduced   CV_32F, of the size reduced_to_scale.
  /// out       CV_32F, side x side.
  void cut(const cv::Mat& reduced, cv::Mat& out) const;

 private:
  int side_ = 0;
  bool upright_ = false, mirrored_ = false;
  cv::Rect window_;                  // upright: where in the reduced frame
  std::vector<std::int32_t> x_, y_;  // turned: places in the reduced frame (cubic.h)
  bool inside_ = false;              // turned: all samples around all places exist
  cv::Rect needed_, read_;
};

/// The size of a frame at a variant's scale, as vision::warp_to_variant reduces it.
cv::Size reduced_to_scale(cv::Size frame, float scale);

}  // namespace freshet::synth::sampling
