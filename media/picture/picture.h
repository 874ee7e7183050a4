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

/// Reads a picture as 8-bit BGR, as read_still does. Throws Error{kInput} naming the file: missing, not a picture,
/// empty, or above 1 << 28 pixels. EXIF orientation is honoured.
Picture read_picture(const std::filesystem::path& path);

/// A picture with all that its file holds of it, upright.
struct Still {
  cv::Mat bgr;    // CV_8UC3, sRGB code
  cv::Mat deep;   // what bgr was reduced from: CV_16UC3, or CV_32FC3 of linear light (EXR); empty: it was not
  cv::Mat alpha;  // CV_8U; empty: none, or opaque everywhere
  std::string reduction;             // for a person, where bgr alone is used; empty: nothing was reduced
  std::vector<std::string> notices;  // for a person
};
/// EXR is taken to be linear light of Rec. 709's primaries; all else sRGB, or brought to it from the file's ICC
/// profile. Throws as read_picture, and Error{kInput} for a profile or primaries that we cannot honour.
Still read_still(const std::filesystem::path& path);
/// deep, or bgr, as CV_32FC3: sRGB code, 1 is white.
cv::Mat coded_picture(const Still& still);

/// A matte and what was done to the file's picture to get it.
struct Matte {
  cv::Mat alpha;
  std::vector<std::string> notices;
};
/// How much is fluid, as a file says it: its alpha where it is not opaque, else its grey; CV_8U of the file's size.
/// Throws as read_picture, and Error{kInput} for a picture in colour.
Matte read_grey(const std::filesystem::path& path);
/// Reads a matte: CV_8U of `size`, 255 where the fluid is; values below 8 are 0, so that what is meant to be black
/// leaves the picture as it is. The file's alpha where it is not opaque, else its grey; 16 bits are reduced to 8, and
/// a matte of another size but the picture's shape is scaled: notices say so.
/// Throws as read_picture, and Error{kInput} when it has another shape, is a picture in colour, is black or white
/// everywhere, or has hardly any black but one grey over much of it: that stands for nothing, and all would move. A
/// soft matte without black is taken, with a notice.
Matte read_matte(const std::filesystem::path& path, cv::Size size);
/// The same of a picture's own alpha. path   names it in messages.
Matte matte_of_alpha(const cv::Mat& alpha, const std::filesystem::path& path);

/// What read_matte does to a matte, for those that come by other ways: CV_8U, brought to `size`.
void scale_matte(cv::Mat& alpha, cv::Size size);
/// Values below 8 become 0: they are what JPEG or a soft brush leaves around, and no eye would see them move.
void settle_dark(cv::Mat& alpha);
/// Whether a matte has the picture's shape: the ratios of their sides differ by at most a hundredth.
bool has_shape_of(cv::Size matte, cv::Size picture);

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
