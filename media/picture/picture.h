// media/picture/picture.h — still pictures and mattes from and to files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::media {

struct Picture {
  cv::Mat bgr;  // CV_8UC3
  // For a person: "16 bits per channel reduced to 8", "alpha channel ignored".
  std::vector<std::string> notices;
};

/// Reads a picture as 8-bit BGR. Throws Error{kInput} naming the file: missing, not a picture, empty, or
/// above 1 << 28 pixels. EXIF orientation is honoured.
Picture read_picture(const std::filesystem::path& path);

/// A matte and what was done to the file's picture to get it.
struct Matte {
  cv::Mat alpha;
  std::vector<std::string> notices;
};
/// Reads a matte: CV_8U, 255 where the fluid is. Colour is reduced to grey, 16 bits to 8, alpha is
/// ignored; notices say so. Throws as read_picture, and Error{kInput} when its size is not `size`
/// or nothing in it is above 0.
Matte read_matte(const std::filesystem::path& path, cv::Size size);

/// A picture whose samples are numbers: all of its bits, and its alpha.
/// values   CV_16UC4: blue, green, red, alpha. 8 bits are widened (255 becomes 65535); alpha is 65535 where
/// the file has none. Throws as read_picture. EXIF orientation is not looked at.
struct DeepPicture {
  cv::Mat values;
  bool grey = false;  // blue, green and red are equal everywhere
  std::vector<std::string> notices;
};
DeepPicture read_deep_picture(const std::filesystem::path& path);

/// By extension (.png, .jpg, ...).
/// Throws   Error{kIo}: folder missing, disk full; Error{kUsage}: unknown ending.
void write_picture(const std::filesystem::path& path, const cv::Mat& picture);
/// Throws what write_picture would for this name: for those who compute long before they write.
void check_picture_name(const std::filesystem::path& path);

}  // namespace freshet::media
