// media/frame/png_chunks.h — a PNG with only the chunks that its pixels need. Private to this room.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace freshet::media {

/// A PNG's chunks, or some of an APNG's, in their order, without those that say nothing of the pixels, the colour or
/// the way up. FFmpeg and libpng unpack all text and every profile that they meet, and a chunk of a megabyte unpacks to
/// a gigabyte. Kept of those that describe are the first of each kind; of packed pixels no more than pixels of this
/// size take when they are stored unpacked.
/// png   with or without the eight bytes that a file begins with. What is cut short is kept as it is.
/// Throws   Error{kInput, where}: the colour profile unpacks to more than 16 MiB.
/// Cost   O(bytes), and the unpacking of the profile.
std::vector<std::uint8_t> pixel_chunks(std::span<const std::uint8_t> png, const std::string& where);

}  // namespace freshet::media
