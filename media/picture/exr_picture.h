// media/picture/exr_picture.h — pictures of linear light in OpenEXR files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::media {

struct ExrPicture {
  cv::Mat light;  // CV_32FC3, B, G, R: as the file has them, unbounded
  cv::Mat alpha;  // CV_32F; empty where the file has none
};

/// Channels R, G, B (or Y alone, for all three) and A of the first part.
/// where   names the file in messages.
/// Throws  Error{kInput}: damaged, no such channels, above 1 << 28 pixels or more than its bytes can hold, a data
///         window that is not the display window, primaries that are not Rec. 709's.
ExrPicture decode_exr_picture(const std::vector<std::uint8_t>& bytes, const std::filesystem::path& where);

enum class ExrSamples { kHalf, kFloat };

/// light   CV_32FC3 or CV_32FC4, the colours times alpha, as the format wants them. ZIP, Rec. 709 primaries.
/// Throws  Error{kUsage} for another type; Error{kIo} as write_picture.
void write_exr_picture(const std::filesystem::path& path, const cv::Mat& light, ExrSamples samples);

/// A layer in a file of many.
struct ExrPart {
  std::string name;     // no other part's
  cv::Mat light;        // as of write_exr_picture
  cv::Mat motion = {};  // to the next frame: CV_32FC2, px, y down; empty: not known
};

/// The first part's channels are R, G, B and A, as of a picture, and so it is read by whoever knows of no parts. Those
/// of others stand behind the part's name, "oak.R": compositors make a layer of each. Motion is oak.forward.u and
/// oak.forward.v, y up, as write_motion writes it. Throws as write_exr_picture.
void write_exr_parts(const std::filesystem::path& path, std::span<const ExrPart> parts, ExrSamples samples);

/// depth   CV_32F: the one channel, Z, of 32 bits, as compositors have it. Throws as write_exr_picture.
void write_exr_depth(const std::filesystem::path& path, const cv::Mat& depth);

}  // namespace freshet::media
