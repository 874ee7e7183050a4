#include "media/frame/frame_md5.h"

extern "C" {
#include <libavutil/md5.h>
#include <libavutil/mem.h>
}

#include <array>
#include <cinttypes>
#include <cstdio>
#include <memory>
#include <new>

#include "platform/text.h"

namespace freshet::media {

std::string frame_md5(const Frame& frame) {
  const auto release = [](AVMD5* context) { av_free(context); };
  const std::unique_ptr<AVMD5, decltype(release)> md5(av_md5_alloc(), release);
  if (!md5) throw std::bad_alloc();
  av_md5_init(md5.get());
  for (const Plane& plane : frame.planes)
    for (int y = 0; y < plane.height; ++y)
      av_md5_update(md5.get(), reinterpret_cast<const std::uint8_t*>(plane.data + y * plane.stride),
                    static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.bytes_per_sample));
  std::array<std::uint8_t, 16> digest{};
  av_md5_final(md5.get(), digest.data());
  return hex(digest);
}

std::int64_t packed_size(const PixelLayout& layout) {
  std::int64_t bytes = 0;
  for (const Plane& plane : plane_shapes(layout))
    bytes += std::int64_t{plane.width} * plane.height * plane.bytes_per_sample;
  return bytes;
}

std::string framemd5_header(const PixelLayout& layout, std::int64_t tb_num, std::int64_t tb_den) {
  char text[512];
  std::snprintf(text, sizeof text,
                "#format: frame checksums\n#version: 2\n#hash: MD5\n#tb 0: %" PRId64 "/%" PRId64
                "\n#media_type 0: video\n#codec_id 0: rawvideo\n#dimensions 0: %dx%d\n#sar 0: %d/%d\n"
                "#stream#, dts,        pts, duration,     size, hash\n",
                tb_num, tb_den, layout.width, layout.height, layout.sar_num, layout.sar_den);
  return text;
}

std::string framemd5_line(const Frame& frame, std::int64_t pts, std::int64_t duration) {
  char text[160];
  std::snprintf(text, sizeof text, "0, %10" PRId64 ", %10" PRId64 ", %8" PRId64 ", %8" PRId64 ", %s", pts,
                pts, duration, packed_size(frame.layout), frame_md5(frame).c_str());
  return text;
}

}  // namespace freshet::media
