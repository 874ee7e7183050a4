// vision/variant.h — the ways in which one clip is looked at: scaled, rotated, flipped.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::vision {

/// One way to look at a clip. Applied in this order: scale, rotate, flip left to right.
struct Variant {
  float scale = 1;         // of the source's size
  float rotation_deg = 0;  // counter-clockwise as seen on the screen
  bool flip = false;
  bool operator==(const Variant&) const = default;
};

/// All combinations, scale-major, then rotation, then flip: a variant's place in
/// the list is its number on disk.
/// Source   Okabe et al. 2011, Sec. 4: 3 scales x 3 rotations x flip = 18.
std::vector<Variant> make_variants(const std::vector<float>& scales, const std::vector<float>& rotations_deg,
                                   bool flips);

/// The frame in which a variant's patches have their coordinates: the bounding box of the scaled, rotated
/// source, rounded up to whole pixels, centre on centre. A flipped variant's frame is the mirror image of its
/// twin's. Throws Error{kInput} for frames above 32767 px per side, Error{kUsage} for a scale outside 0..16.
struct VariantFrame {
  cv::Size size;                             // px
  cv::Matx23d source_from_variant;           // pixel centres: source px = M * (variant px, 1)
  cv::Matx22d variant_from_source_velocity;  // scale and turn of a velocity, x right, y down
};
VariantFrame variant_frame(cv::Size source, const Variant& variant);

/// The source picture as the variant shows it, bilinear after an area reduction to the variant's scale (so
/// that half scale does not alias). Outside the source: edge pixels repeated. Any type of cv::warpAffine,
/// whose coordinates are rounded to 1/32 px; unrotated variants of whole size are not warped at all, and a
/// flipped variant is its twin's mirror image bit for bit.
cv::Mat warp_to_variant(const cv::Mat& source, const Variant& variant);
/// 255 where a variant's pixel is interpolated from pixels of the source alone; CV_8U.
cv::Mat valid_mask(cv::Size source, const Variant& variant);

}  // namespace freshet::vision
