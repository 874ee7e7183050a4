// media/frame/frame.h — a picture in memory as a decoder gave it, and its colours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::media {

/// How samples are laid out and what they mean. Values as FFmpeg and ITU-T H.273 number them.
struct PixelLayout {
  std::string format;  // FFmpeg's name: "yuv420p", "gray10le", "gbrp", ...
  int width = 0, height = 0;
  int range = 0;   // AVColorRange: 0 unknown, 1 limited, 2 full
  int matrix = 2;  // AVColorSpace: 1 BT.709, 2 unknown, 5/6 BT.601, ...
  int primaries = 2, transfer = 2;
  int rotation = 0;              // degrees clockwise that a player turns the picture by: 0, 90, 180, 270
  int sar_num = 1, sar_den = 1;  // sample aspect ratio
};

struct Plane {
  int width = 0, height = 0;  // samples
  int bytes_per_sample = 1;   // 1 or 2 (little endian); interleaved formats count each component as a sample
  std::ptrdiff_t stride = 0;  // bytes
  std::byte* data = nullptr;
};

/// One frame: native planes, owned together.
struct Frame {
  PixelLayout layout;
  std::vector<Plane> planes;
  double time_s = 0;              // presentation time from the clip's first frame
  std::shared_ptr<void> storage;  // what the planes point into
};

/// Shapes of the planes of a layout, without memory (data null, stride packed). Throws Error{kInput} for a
/// format that has no plain planes (palettes and bit-packed formats are converted by the reader).
std::vector<Plane> plane_shapes(const PixelLayout& layout);
/// An empty frame with memory of its own.
Frame make_frame(const PixelLayout& layout);

/// Luminance, full range, W x H: CV_8U. The Y plane with its range expanded and depth reduced; from RGB by
/// the layout's matrix (BT.601 where unknown). Not rotated.
cv::Mat to_luma(const Frame& frame);
/// The same for a region of a luma plane already read from a store: 8- or 16-bit samples to CV_32F in 0..1.
/// Valid for layouts whose plane 0 is luminance (luma_in_plane_0).
cv::Mat luma_from_plane(const PixelLayout& layout, const cv::Mat& samples);
bool luma_in_plane_0(const PixelLayout& layout);
/// 8-bit BGR, CV_8UC3, as a player shows it: range and matrix honoured, not rotated, alpha ignored. An
/// untagged matrix is BT.709 from 720 rows on and BT.601 below; untagged range is limited for YUV, full for
/// grey and RGB. By swscale with accurate rounding: the same bits on every machine and thread.
cv::Mat to_bgr(const Frame& frame);

}  // namespace freshet::media
