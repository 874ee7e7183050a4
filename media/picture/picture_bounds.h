// media/picture/picture_bounds.h — what a picture's file claims, before anything is decoded or allocated for it: memory
// and time stay in proportion to its pixels. Private to this room. EXR has bounds of its own (exr_stream.h).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::media {

/// Width and height in the header of a PNG, JPEG, BMP, TIFF, WebP, PNM, PAM, PFM, Radiance, Sun raster or JPEG 2000.
/// Nothing for other formats and broken headers.
std::optional<cv::Size> claimed_size(std::span<const std::uint8_t> bytes);

/// The file as a decoder may be given it: a PNG without all that its pixels do not need (png_chunks.h).
/// Throws   Error{kInput, where}: it has no size that we can read, more than 2^28 pixels, more than 2^14 for each of
///          its bytes (and 2^24), a JPEG more than 100 scans or a second frame, a TIFF tags, strips or tiles that claim
///          far more than there is, a JPEG 2000 more tiles or components than pixels are worth.
/// Cost     O(bytes).
std::vector<std::uint8_t> bounded_picture(std::vector<std::uint8_t> bytes, const std::string& where);

}  // namespace freshet::media
