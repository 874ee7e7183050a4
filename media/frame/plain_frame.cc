#include "media/frame/plain_frame.h"

#include <cstring>

namespace freshet::media {
namespace {

bool is_jpeg_range(AVPixelFormat format) {
  return format == AV_PIX_FMT_YUVJ420P || format == AV_PIX_FMT_YUVJ422P || format == AV_PIX_FMT_YUVJ444P ||
         format == AV_PIX_FMT_YUVJ440P || format == AV_PIX_FMT_YUVJ411P;
}

AVPixelFormat without_jpeg_range(AVPixelFormat format) {
  switch (format) {
    case AV_PIX_FMT_YUVJ420P:
      return AV_PIX_FMT_YUV420P;
    case AV_PIX_FMT_YUVJ422P:
      return AV_PIX_FMT_YUV422P;
    case AV_PIX_FMT_YUVJ444P:
      return AV_PIX_FMT_YUV444P;
    case AV_PIX_FMT_YUVJ440P:
      return AV_PIX_FMT_YUV440P;
    case AV_PIX_FMT_YUVJ411P:
      return AV_PIX_FMT_YUV411P;
    default:
      return format;
  }
}

// 16-bit words are swapped; formats that keep a pixel in 32 bits (x2rgb10, floats) are not ours to swap.
bool in_16_bit_words(const AVPixFmtDescriptor& description) {
  for (int i = 0; i < description.nb_components; ++i)
    if (description.comp[i].depth > 16 || description.comp[i].depth <= 8) return false;
  return std::strncmp(description.name, "x2", 2) != 0;
}

void copy_rows(const std::uint8_t* source, std::ptrdiff_t source_stride, const Plane& plane) {
  const std::size_t bytes =
      static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.bytes_per_sample);
  for (int y = 0; y < plane.height; ++y)
    std::memcpy(plane.data + y * plane.stride, source + y * source_stride, bytes);
}

void copy_swapped(const std::uint8_t* source, std::ptrdiff_t source_stride, const Plane& plane) {
  const int bytes = plane.width * plane.bytes_per_sample;
  for (int y = 0; y < plane.height; ++y) {
    const std::uint8_t* from = source + y * source_stride;
    auto* to = reinterpret_cast<std::uint8_t*>(plane.data + y * plane.stride);
    for (int i = 0; i + 1 < bytes; i += 2) {
      to[i] = from[i + 1];
      to[i + 1] = from[i];
    }
  }
}

// A palette entry is a native 32-bit 0xAARRGGBB, in memory B, G, R, A.
void look_up(const AVFrame& source, const Plane& plane) {
  for (int y = 0; y < plane.height; ++y) {
    const std::uint8_t* from = source.data[0] + static_cast<std::ptrdiff_t>(y) * source.linesize[0];
    std::byte* to = plane.data + y * plane.stride;
    for (int x = 0; x < plane.width / 4; ++x) std::memcpy(to + 4 * x, source.data[1] + 4 * from[x], 4);
  }
}

void spread_bits(const AVFrame& source, const Plane& plane) {
  const std::uint8_t flip = source.format == AV_PIX_FMT_MONOWHITE ? 0xFF : 0x00;
  for (int y = 0; y < plane.height; ++y) {
    const std::uint8_t* from = source.data[0] + static_cast<std::ptrdiff_t>(y) * source.linesize[0];
    std::byte* to = plane.data + y * plane.stride;
    for (int x = 0; x < plane.width; ++x)
      to[x] = ((from[x >> 3] ^ flip) >> (7 - (x & 7))) & 1 ? std::byte{255} : std::byte{0};
  }
}

}  // namespace

AVPixelFormat plain_format(AVPixelFormat format) {
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(format);
  if (!description || (description->flags & AV_PIX_FMT_FLAG_HWACCEL)) return AV_PIX_FMT_NONE;
  if (format == AV_PIX_FMT_PAL8) return AV_PIX_FMT_BGRA;
  if (format == AV_PIX_FMT_MONOWHITE || format == AV_PIX_FMT_MONOBLACK) return AV_PIX_FMT_GRAY8;
  if (description->flags & (AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM)) return AV_PIX_FMT_NONE;
  if (description->flags & AV_PIX_FMT_FLAG_BE)
    return in_16_bit_words(*description) ? av_pix_fmt_swap_endianness(format) : AV_PIX_FMT_NONE;
  return without_jpeg_range(format);
}

namespace {

/// Decoders put there what the file says (MPEG-2: any byte), and to load what an enumeration does not have is
/// undefined.
template <class Enumeration>
int number_of(const Enumeration& coded) {
  int number = 0;
  static_assert(sizeof coded == sizeof number);
  std::memcpy(&number, &coded, sizeof number);
  return number;
}

}  // namespace

PixelLayout layout_of(const AVFrame& frame) {
  const auto format = static_cast<AVPixelFormat>(frame.format);
  PixelLayout layout;
  const char* name = av_get_pix_fmt_name(plain_format(format));
  layout.format = name ? name : "none";
  layout.width = frame.width;
  layout.height = frame.height;
  layout.range = is_jpeg_range(format) ? static_cast<int>(AVCOL_RANGE_JPEG) : number_of(frame.color_range);
  layout.matrix = number_of(frame.colorspace);
  layout.primaries = number_of(frame.color_primaries);
  layout.transfer = number_of(frame.color_trc);
  if (frame.sample_aspect_ratio.num > 0 && frame.sample_aspect_ratio.den > 0) {
    layout.sar_num = frame.sample_aspect_ratio.num;
    layout.sar_den = frame.sample_aspect_ratio.den;
  }
  return layout;
}

Frame plain_frame(AvOwner<AVFrame> source, const PixelLayout& layout) {
  const auto format = static_cast<AVPixelFormat>(source->format);
  const bool palette = format == AV_PIX_FMT_PAL8;
  const bool bits = format == AV_PIX_FMT_MONOWHITE || format == AV_PIX_FMT_MONOBLACK;
  const bool swap = (av_pix_fmt_desc_get(format)->flags & AV_PIX_FMT_FLAG_BE) != 0;
  bool upside_down = false;
  Frame frame;
  frame.layout = layout;
  frame.planes = plane_shapes(layout);
  for (std::size_t i = 0; i < frame.planes.size(); ++i) upside_down |= source->linesize[i] < 0;

  if (!palette && !bits && !swap && !upside_down) {
    for (std::size_t i = 0; i < frame.planes.size(); ++i) {
      frame.planes[i].data = reinterpret_cast<std::byte*>(source->data[i]);
      frame.planes[i].stride = source->linesize[i];
    }
    frame.storage = std::shared_ptr<AVFrame>(source.release(), AvDeleter{});
    return frame;
  }

  frame = make_frame(layout);
  if (palette) {
    look_up(*source, frame.planes[0]);
  } else if (bits) {
    spread_bits(*source, frame.planes[0]);
  } else {
    for (std::size_t i = 0; i < frame.planes.size(); ++i)
      (swap ? copy_swapped : copy_rows)(source->data[i], source->linesize[i], frame.planes[i]);
  }
  return frame;
}

}  // namespace freshet::media
