// media/frame/frame_part.h — a rectangle of a frame that is to be shown as the whole frame shows it.
#pragma once

#include <opencv2/core.hpp>

#include "media/frame/frame.h"

namespace freshet::media {

/// The layout of a rectangle of a frame, for to_bgr: an untagged matrix goes by the whole frame's height.
PixelLayout layout_of_part(const PixelLayout& whole, cv::Size part);

}  // namespace freshet::media
