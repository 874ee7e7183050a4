// media/frame/scaler.h — conversion between pixel layouts of equal size by swscale. Private to this room.
#pragma once

#include <array>
#include <cstdint>

#include "media/frame/frame.h"
#include "media/frame/libav.h"

namespace freshet::media {

/// Planes as swscale takes them; borrowed.
struct Image {
  std::array<std::uint8_t*, 4> data{};
  std::array<int, 4> stride{};
};
Image image_of(const Frame& frame);

/// Whether YUV or grey codes use all values. As tagged; untagged grey and RGB are full, untagged YUV limited.
bool full_range(const PixelLayout& layout);

/// AVColorSpace of a layout; where it is not tagged BT.709 from 720 rows on, BT.601 below, as players do.
int known_matrix(const PixelLayout& layout);

/// Bit exact on every processor and for any number of threads: accurate rounding, chroma interpolated
/// linearly for each pixel, no dither. Contexts are kept per thread (the last four pairs of layouts). Throws
/// Error{kInput} when swscale cannot.
void convert(const PixelLayout& from, const Image& source, const PixelLayout& to, const Image& target);

}  // namespace freshet::media
