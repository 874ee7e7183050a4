// media/frame/decoder.h — the first video stream of one file, demuxed and decoded. Private to this room.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "media/frame/libav.h"

namespace freshet::media {

/// Of a still picture, in any format: a hostile header asks for more.
inline constexpr std::int64_t kMaxPicturePixels = std::int64_t{1} << 28;

struct DecoderOptions {
  bool strict = false;   // checksums are checked and the first fault ends the stream
  int threads = 0;       // of the decoder; 0: one per core. Pixels are the same for any number
  bool picture = false;  // a still picture: its header is not probed first, one thread decodes it
};

/// Frames of one file in presentation order. Opens that one file and nothing that it may name (playlists,
/// external tracks). Throws Error{kInput} naming the file, at any call also where the disk or memory fails: what is
/// left out for that is not the file's damage. (FFmpeg's reader of Matroska passes over packets without memory, and
/// says nothing.)
class Decoder {
 public:
  explicit Decoder(const std::filesystem::path& path, const DecoderOptions& options);

  /// The next decoded frame, null at the end. Damaged packets are passed over and counted.
  AvOwner<AVFrame> next();

  /// The presentation stamps of all packets that are left, in the stream's time base, as they lie; those that an edit
  /// list hides and those without one left out. In place of next(): nothing comes after it.
  std::vector<std::int64_t> packet_stamps();

  const AVStream& stream() const { return *stream_; }
  const AVFormatContext& container() const { return *container_; }
  AVCodecID codec() const { return stream_->codecpar->codec_id; }

  /// Frames that the container lists for the stream, 0 when it lists none.
  std::int64_t listed_frames() const;

  std::int64_t damaged_packets() const { return damaged_packets_; }
  std::int64_t damaged_frames() const { return damaged_frames_; }  // delivered, but with decoding errors
  /// The first fault met, as FFmpeg words it; empty when there was none.
  const std::string& fault() const { return fault_; }

 private:
  struct File;  // the bytes, and FFmpeg's window on them
  struct CloseContainer {
    void operator()(AVFormatContext* container) const { avformat_close_input(&container); }
  };

  void open_container();
  void open_codec(const DecoderOptions& options);
  void keep_pixel_chunks(AVCodecParameters& parameters) const;
  int read_packet();
  int send_packet();
  void feed();
  void note(int code);
  void refuse_if_machine_failed(int code) const;

  std::string name_;
  bool picture_;
  std::shared_ptr<File> file_;  // outlives container_
  std::unique_ptr<AVFormatContext, CloseContainer> container_;
  AVStream* stream_ = nullptr;
  AvOwner<AVCodecContext> context_;
  AvOwner<AVPacket> packet_;
  bool drained_ = false;
  int faults_in_a_row_ = 0;
  std::int64_t damaged_packets_ = 0, damaged_frames_ = 0;
  std::string fault_;
};

/// Throws Error{kInput} when there is no such file, it is not a regular file, empty or unreadable.
void require_file(const std::filesystem::path& path);

}  // namespace freshet::media
