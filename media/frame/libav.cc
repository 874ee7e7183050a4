#include "media/frame/libav.h"

extern "C" {
#include <libavutil/log.h>
}

#include <cstdarg>
#include <cstdio>
#include <mutex>
#include <new>

namespace freshet::media {
namespace {

// Per thread, so that two readers do not explain each other's faults. A decoder's own threads log into
// theirs, which nobody reads: the code that the decoder returns has to do then.
thread_local std::string last_line;

void keep_line(void*, int level, const char* format, std::va_list arguments) {
  if (level > AV_LOG_ERROR) return;
  char line[256];
  const int length = std::vsnprintf(line, sizeof line, format, arguments);
  if (length <= 0) return;
  std::string text(line);
  while (!text.empty() && (text.back() == '\n' || text.back() == '.' || text.back() == ' ')) text.pop_back();
  if (!text.empty()) last_line = std::move(text);
}

}  // namespace

AvOwner<AVFrame> new_frame() {
  AvOwner<AVFrame> frame(av_frame_alloc());
  if (!frame) throw std::bad_alloc();
  return frame;
}

AvOwner<AVPacket> new_packet() {
  AvOwner<AVPacket> packet(av_packet_alloc());
  if (!packet) throw std::bad_alloc();
  return packet;
}

void quiet_libav() {
  static std::once_flag once;
  std::call_once(once, [] { av_log_set_callback(keep_line); });
  last_line.clear();
}

std::string libav_fault(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof text);
  return last_line.empty() ? std::string(text) : std::string(text) + ": " + last_line;
}

}  // namespace freshet::media
