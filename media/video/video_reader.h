// media/video/video_reader.h — frames of a video, animated picture or numbered sequence, in one forward pass.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "media/frame/frame.h"
#include "media/frame/repair.h"

namespace freshet::media {

/// What a container claims before anything is decoded. Counts and durations are claims, not facts.
struct VideoInfo {
  PixelLayout layout;
  std::string codec, container;
  std::int64_t fps_num = 0, fps_den = 1;  // average rate
  std::int64_t claimed_frames = 0;        // 0: unknown
  double claimed_duration_s = 0;          // 0: unknown
  std::string repairs{};                  // FFmpeg's filters that changed its frames; empty: none
  int turned = 0;                         // degrees clockwise, to stand upright (Repairs::upright)
};

/// One forward pass over the first video stream. Decodes with FFmpeg's libraries, bit exact for any number of
/// threads, in the decoder's own planes; alpha of VP8/VP9 in WebM is kept. A picture sequence is opened by a
/// pattern ("f%05d.png", wherever its numbers start) or as a folder of equal pictures, in natural order.
///
/// Planes   are shared with the decoder: read only. Formats without plain little-endian planes are converted
///          without loss: pal8 to bgra, monow and monob to gray, big-endian words to little-endian ones; the
///          "yuvj" names become "yuv" with range 2.
/// Times    are the stamps less the first. A missing or backward stamp counts as one frame of the average
///          rate, so that times always grow. A sequence runs at 25 frames per second, by its numbers.
/// Throws   Error{kInput} naming the file: missing, empty, not a video, no video stream (audio only),
///          unsupported codec, no decodable frame, a folder without pictures. Animated WebP is among what
///          FFmpeg 5.1 cannot decode. Whatever else is wrong is reported by complaint().
/// Safety   opens no file but its own, whatever a playlist inside it says; refuses frames above 2^26 pixels.
/// Logging  FFmpeg's log is kept in memory and goes into our messages; nothing is printed. Its callback is
///          one for the process.
/// Cost     the first frame is decoded when opened, since only a frame shows its layout. 1280 x 720 H.264:
///          about 270 frames per second on two cores.
class VideoReader {
 public:
  /// threads   of the decoder, 0: one per core.
  /// repairs   made to each frame; of files, not of picture sequences (Error{kInput}).
  explicit VideoReader(const std::filesystem::path& path, int threads = 0, const Repairs& repairs = {});
  VideoReader(VideoReader&&) noexcept;
  ~VideoReader();
  const VideoInfo& info() const;
  /// The next frame, or nothing at the end. Throws Error{kInput} when size or format change mid-stream.
  std::optional<Frame> next();
  /// After the end: what was lost, for a person ("file is truncated: 11 of 50 frames"), or empty.
  const std::string& complaint() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::media
