// media/frame/libav.h — FFmpeg's C handles with owners, and its faults as text. Private to this room.
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <memory>
#include <string>

namespace freshet::media {

struct AvDeleter {
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(SwsContext* context) const { sws_freeContext(context); }
};
template <class T>
using AvOwner = std::unique_ptr<T, AvDeleter>;

AvOwner<AVFrame> new_frame();
AvOwner<AVPacket> new_packet();

/// Routes FFmpeg's log, which is one for the whole process, into memory; nothing is printed from then on.
/// Cheap after the first call. Every entry into FFmpeg from this room calls it first.
void quiet_libav();

/// The text of an AVERROR code, and after a colon the last error line that FFmpeg logged on this thread
/// since quiet_libav() was called ("Invalid data found when processing input: moov atom not found").
std::string libav_fault(int code);

}  // namespace freshet::media
