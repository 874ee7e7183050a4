// media/video/stream_file.h — one encoded stream muxed into one file. Private to this room.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>

#include "media/frame/file_format.h"
#include "media/frame/filter_graph.h"
#include "media/frame/frame.h"
#include "media/frame/libav.h"
#include "media/video/video_writer.h"
#include "platform/unfinished_files.h"

namespace freshet::media {

/// Opened lazily by the first frame, which alone gives the pixel format; the file is made at once, under a
/// temporary name. Faults of FFmpeg and of the disk become Error{kIo} naming the target.
class StreamFile {
 public:
  /// coding   of a film.
  StreamFile(std::filesystem::path path, Coding coding, const VideoWriterOptions& options);
  ~StreamFile();  // removes the temporary file unless finish() has moved it into place
  StreamFile(const StreamFile&) = delete;
  StreamFile& operator=(const StreamFile&) = delete;

  /// CV_8UC3 or CV_8UC4, all alike; FFV1, ProRes and H.264 of 10 bits also CV_16UC3 and CV_16UC4.
  void write(const cv::Mat& picture);
  /// Native planes (FFV1). Formats that FFV1 lacks are repacked without loss where that is possible.
  void write(const Frame& frame);
  void finish();

 private:
  struct CloseContainer {
    void operator()(AVFormatContext* container) const;
  };

  /// What the encoder and the muxer are told beside the context's own fields; they take out what they know.
  struct CoderOptions {
    AVDictionary *coding = nullptr, *muxing = nullptr;

    CoderOptions() = default;
    CoderOptions(CoderOptions&& other) noexcept
        : coding(std::exchange(other.coding, nullptr)), muxing(std::exchange(other.muxing, nullptr)) {}
    ~CoderOptions();
  };

  void open(const PixelLayout& coded);
  /// Of the context, what is the coding's own.
  CoderOptions set_coding();
  void convert_and_encode(const PixelLayout& layout, const Frame& source, const PixelLayout& coded);
  void encode(const AVFrame* frame);
  void write_to_palette(const cv::Mat& picture);
  [[noreturn]] void fail(int code, const std::string& doing);

  std::filesystem::path path_, temporary_;
  std::optional<UnfinishedFile> unfinished_;
  Coding coding_;
  VideoWriterOptions options_;
  std::unique_ptr<AVFormatContext, CloseContainer> container_;
  AVStream* stream_ = nullptr;
  AvOwner<AVCodecContext> context_;
  AvOwner<AVPacket> packet_;
  PixelLayout first_;  // of the first picture or frame as given
  std::int64_t frames_ = 0;
  std::optional<FilterGraph> palette_;  // of a GIF: holds all frames until the colours of all are known
};

}  // namespace freshet::media
