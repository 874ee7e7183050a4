// media/picture/colour_profile.h — ICC profiles of picture files, and their colours brought to sRGB. Private to this
// room.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::media {

/// The profile in a TIFF; empty where there is none.
std::vector<std::uint8_t> tiff_profile(std::span<const std::uint8_t> bytes);

/// Brings the colours of a picture from its profile's space to sRGB, which all the rest works in; what sRGB lacks is
/// clipped. A profile that is sRGB's in effect (within 1 %), and one of grey, changes nothing.
/// icc      the profile. bgr   CV_8UC3 or CV_16UC3, changed in place.
/// Returns  what was done, for a person; empty: nothing.
/// Throws   Error{kInput} for a profile that is damaged or neither RGB's nor grey's (a print's CMYK).
/// Source   Little CMS, relative colorimetric.
std::string bring_to_srgb(std::span<const std::uint8_t> icc, cv::Mat& bgr,
                          const std::filesystem::path& where);

}  // namespace freshet::media
