// studio/clip_strip.h — a clip, or one of its patches, as a strip of small frames that a page can play.
#pragma once

#include <array>
#include <string>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "vision/variant.h"

namespace freshet::studio {

inline constexpr int kStripFrames = 24;  // at most; spread evenly over the clip's first two seconds

/// Frames side by side, CV_8UC3: each at most `width` px wide, with the clip's shape. Throws Error{kDamaged}.
cv::Mat clip_strip(const store::Snapshot& snapshot, store::ClipId clip, int width);

/// The same of a patch alone, as its variant shows it: `side` px wide and high. patch   px, in the variant's frame.
/// Throws Error{kInput} when the patch lies outside of it.
cv::Mat patch_strip(const store::Snapshot& snapshot, store::ClipId clip, const vision::Variant& variant,
                    const cv::Rect& patch, int side);

/// Where a patch's corners lie in its clip's frame, 0..1 of its width and height; from upper left, clockwise as the
/// patch is seen.
std::array<cv::Point2d, 4> patch_in_clip(const store::ClipRecord& clip, const vision::Variant& variant,
                                         const cv::Rect& patch);

/// As JPEG.
std::string encoded(const cv::Mat& picture);

}  // namespace freshet::studio
