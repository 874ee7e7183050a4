// media/frame/frame_warp.h — frames moved, turned and scaled in their own planes.
#pragma once

#include <opencv2/core.hpp>

#include "media/frame/frame.h"

namespace freshet::media {

/// Where pixel centre (x, y) of the result lies in the source: source = m * (x, y, 1).
using SourceFromResult = cv::Matx23d;

/// A frame of its layout, but of another size, resampled with Lanczos's kernel of 8 x 8 (cv::INTER_LANCZOS4), each
/// plane for itself; chroma that is subsampled lies left and centred (MPEG-2). What lies outside of the source is its
/// edge's.
/// size     even where chroma is subsampled.
/// Throws   Error{kInput} for formats whose samples lie packed unevenly (yuyv422, rgb565, ...).
Frame warped(const Frame& frame, const SourceFromResult& m, cv::Size size);

}  // namespace freshet::media
