#include "media/frame/frame.h"

#include <cstdlib>

#include "freshet/error.h"
#include "media/frame/libav.h"

namespace freshet::media {
namespace {

constexpr std::size_t kAlignment = 64;  // a cache line; swscale's widest loads need 32

[[noreturn]] void refuse(const PixelLayout& layout, const std::string& fault) {
  throw Error(ErrorKind::kInput,
              "pixel layout " + layout.format + " " + std::to_string(layout.width) + "x" +
                  std::to_string(layout.height),
              fault);
}

// One or two bytes per sample: two where every component of the plane lies in a 16-bit word of its own.
int sample_bytes(const AVPixFmtDescriptor& description, int plane) {
  for (int i = 0; i < description.nb_components; ++i) {
    const AVComponentDescriptor& component = description.comp[i];
    if (component.plane == plane && (component.depth <= 8 || component.depth > 16 || component.step % 2 != 0))
      return 1;
  }
  return 2;
}

}  // namespace

std::vector<Plane> plane_shapes(const PixelLayout& layout) {
  const AVPixelFormat format = av_get_pix_fmt(layout.format.c_str());
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(format);
  if (!description) refuse(layout, "FFmpeg knows no such format");
  constexpr std::uint64_t kNotPlain =
      AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_HWACCEL;
  if (description->flags & kNotPlain) refuse(layout, "the format has no plain planes");
  if (description->flags & AV_PIX_FMT_FLAG_BE) refuse(layout, "samples must be little endian");
  if (layout.width < 1 || layout.height < 1 ||
      av_image_check_size2(layout.width, layout.height, std::int64_t{1} << 28, format, 0, nullptr) < 0)
    refuse(layout, "the size is out of range");

  int row_bytes[4] = {};
  if (av_image_fill_linesizes(row_bytes, format, layout.width) < 0)
    refuse(layout, "the size is out of range");
  std::vector<Plane> planes(static_cast<std::size_t>(av_pix_fmt_count_planes(format)));
  for (std::size_t i = 0; i < planes.size(); ++i) {
    Plane& plane = planes[i];
    const bool chroma = i == 1 || i == 2;
    plane.bytes_per_sample = sample_bytes(*description, static_cast<int>(i));
    plane.width = row_bytes[i] / plane.bytes_per_sample;
    plane.height = chroma ? AV_CEIL_RSHIFT(layout.height, description->log2_chroma_h) : layout.height;
    plane.stride = row_bytes[i];
  }
  return planes;
}

Frame make_frame(const PixelLayout& layout) {
  Frame frame;
  frame.layout = layout;
  frame.planes = plane_shapes(layout);
  std::size_t bytes = 0;
  for (Plane& plane : frame.planes) {
    plane.stride = static_cast<std::ptrdiff_t>((static_cast<std::size_t>(plane.stride) + kAlignment - 1) /
                                               kAlignment * kAlignment);
    bytes += static_cast<std::size_t>(plane.stride) * static_cast<std::size_t>(plane.height);
  }
  // One line more than asked for: swscale reads past the end of a row.
  std::shared_ptr<std::byte> memory(
      static_cast<std::byte*>(std::aligned_alloc(kAlignment, bytes + kAlignment)), std::free);
  if (!memory)
    throw Error(ErrorKind::kIo, "frame memory", "no room for " + std::to_string(bytes) + " bytes",
                "Close other programs or use smaller frames");
  std::byte* next = memory.get();
  for (Plane& plane : frame.planes) {
    plane.data = next;
    next += plane.stride * plane.height;
  }
  frame.storage = std::move(memory);
  return frame;
}

}  // namespace freshet::media
