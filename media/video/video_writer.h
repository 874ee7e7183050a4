// media/video/video_writer.h — a video, an animated picture or a numbered sequence, by the name's ending.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include "media/frame/frame.h"
#include "media/picture/exr_picture.h"
#include "media/video/output_format.h"

namespace freshet::media {

struct VideoWriterOptions {
  std::int64_t fps_num = 25, fps_den = 1;
  int crf = 16;                   // H.264 quality, 0 (lossless) .. 51; lower is better and larger
  int bits = 8;                   // of H.264: 8, or 10 (High 10, which browsers do not play)
  std::int64_t first_number = 0;  // of a sequence
  ExrSamples exr = ExrSamples::kHalf;
  bool own_times = false;  // native frames stand at their time_s, to a millisecond, not at the rate (.mkv)
};

/// What a file of this name makes of frames of this size, for a person: padding to even sides, sides that many
/// players do not show. Empty: nothing to say, or a name that VideoWriter refuses.
std::string size_notice(const std::filesystem::path& path, cv::Size size);

/// The ending says what is written, as output_format() has it:
///   .mp4           H.264 High, yuv420p, BT.709 tagged, faststart: plays in a browser. Odd sizes are padded
///                  by repeating the last column or row.
///   .mkv           FFV1 level 3, lossless
///   .mov           ProRes 4444, 10 bits, alpha 16, BT.709 tagged
///   .webp, .png or .apng: animated
///   .gif           animated, 256 colours for all frames, which are held until the last (4 bytes a pixel); times in
///                  1/100 s
///   a pattern      holding %05d (or another %0Nd, or ####), with a picture ending: one file per frame
/// A file is written beside the target and renamed on finish, so that a broken run leaves no half file; a
/// sequence is written frame by frame.
/// Throws   Error{kUsage} for an ending it does not know, or a size that the codec cannot take, Error{kIo} for a folder
///          that does not exist or a full disk.
class VideoWriter {
 public:
  VideoWriter(const std::filesystem::path& path, cv::Size size, const VideoWriterOptions& options = {});
  VideoWriter(VideoWriter&&) noexcept;
  ~VideoWriter();
  /// What the format holds, and nothing that it would lose: CV_8U or CV_16U of sRGB code, BGR or BGRA with straight
  /// alpha; or, into formats of light alone, CV_32F of linear light, colours times alpha.
  void write(const cv::Mat& picture);
  /// A frame in native planes, written unchanged with its colour tags, aspect and rotation (.mkv only): the
  /// lossless way back out of a store. Layouts that FFV1 lacks hold the same samples in another order (rgb24
  /// and gbrp in bgr0, rgb48le in gbrp16le, nv12 in yuv420p), else Error{kUsage}. In a sequence gray16le and
  /// rgb48le keep their 16 bits, the rest is to_bgr(). Frames follow each other at the given rate, whatever
  /// their time_s, unless own_times; these ascend then, from 0.
  void write(const Frame& frame);
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::media
