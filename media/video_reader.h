// media/video_reader.h — frames of any video, animated picture or numbered picture sequence, one forward
// pass.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "media/frame.h"

namespace freshet::media {

/// What a container claims before anything is decoded. Counts and durations are claims, not facts.
struct VideoInfo {
  PixelLayout layout;
  std::string codec, container;
  std::int64_t fps_num = 0, fps_den = 1;  // average rate
  std::int64_t claimed_frames = 0;        // 0: unknown
  double claimed_duration_s = 0;          // 0: unknown
  bool variable_frame_rate = false;       // as far as the header tells
};

/// One forward pass over the first video stream. Decodes with FFmpeg's libraries, bit exact, in its native
/// planes; alpha of VP8/VP9 in WebM kept. A picture sequence is opened by a pattern ("f%05d.png") or a
/// folder. Throws Error{kInput} naming the file: not a video, no video stream (audio only), unsupported
/// codec.
class VideoReader {
 public:
  explicit VideoReader(const std::filesystem::path& path, int threads = 0);
  VideoReader(VideoReader&&) noexcept;
  ~VideoReader();
  const VideoInfo& info() const;
  /// The next frame, or nothing at the end. Throws Error{kInput} when size or format change mid-stream.
  std::optional<Frame> next();
  /// After the end: what was lost, for a person ("file is truncated: 11 of 50 frames"); empty when nothing
  /// was.
  const std::string& complaint() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// True for names that a folder walk should try to read as a clip (by extension).
bool looks_like_video(const std::filesystem::path& path);

}  // namespace freshet::media
