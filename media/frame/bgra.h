// media/frame/bgra.h — frames with transparency as pictures.
#pragma once

#include <opencv2/core.hpp>

#include "media/frame/frame.h"

namespace freshet::media {

/// Whether a layout has a plane or a component of alpha.
bool has_alpha(const PixelLayout& layout);

/// 8-bit BGRA, CV_8UC4: colours as to_bgr() gives them, alpha as the frame has it, 255 where its layout has
/// none. Straight alpha is taken to be straight: nothing is divided.
cv::Mat to_bgra(const Frame& frame);

/// Whether any pixel of a BGRA picture of 8 or 16 bits is not opaque. A sequence of mattes is read by its alpha where
/// this holds of any of its pictures, by its grey else.
bool is_transparent(const cv::Mat& bgra);

}  // namespace freshet::media
