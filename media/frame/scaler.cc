#include "media/frame/scaler.h"

#include <string>
#include <tuple>
#include <utility>
#include <vector>

extern "C" {
#include <libavutil/opt.h>
}

#include "freshet/error.h"

namespace freshet::media {
namespace {

struct Key {
  int from_format, to_format, width, height, from_matrix, to_matrix;
  bool from_full, to_full;
  auto operator<=>(const Key&) const = default;
};

AvOwner<SwsContext> make_context(const Key& key) {
  quiet_libav();
  AvOwner<SwsContext> context(sws_alloc_context());
  if (!context) return nullptr;
  void* options = context.get();
  av_opt_set_int(options, "srcw", key.width, 0);
  av_opt_set_int(options, "srch", key.height, 0);
  av_opt_set_int(options, "dstw", key.width, 0);
  av_opt_set_int(options, "dsth", key.height, 0);
  av_opt_set_int(options, "src_format", key.from_format, 0);
  av_opt_set_int(options, "dst_format", key.to_format, 0);
  av_opt_set_int(options, "sws_flags", SWS_BILINEAR | SWS_ACCURATE_RND | SWS_BITEXACT | SWS_FULL_CHR_H_INT,
                 0);
  av_opt_set_int(options, "threads", 1, 0);
  av_opt_set(options, "sws_dither", "none", 0);
  sws_setColorspaceDetails(context.get(), sws_getCoefficients(key.from_matrix), key.from_full,
                           sws_getCoefficients(key.to_matrix), key.to_full, 0, 1 << 16, 1 << 16);
  return sws_init_context(context.get(), nullptr, nullptr) < 0 ? nullptr : std::move(context);
}

SwsContext* context_for(const Key& key) {
  constexpr std::size_t kKept = 4;
  thread_local std::vector<std::pair<Key, AvOwner<SwsContext>>> kept;
  for (auto& [old_key, context] : kept)
    if (old_key == key) return context.get();
  AvOwner<SwsContext> context = make_context(key);
  if (!context) return nullptr;
  if (kept.size() == kKept) kept.erase(kept.begin());
  kept.emplace_back(key, std::move(context));
  return kept.back().second.get();
}

}  // namespace

Image image_of(const Frame& frame) {
  Image image;
  for (std::size_t i = 0; i < frame.planes.size() && i < 4; ++i) {
    image.data[i] = reinterpret_cast<std::uint8_t*>(frame.planes[i].data);
    image.stride[i] = static_cast<int>(frame.planes[i].stride);
  }
  return image;
}

bool full_range(const PixelLayout& layout) {
  if (layout.range == AVCOL_RANGE_JPEG) return true;
  if (layout.range == AVCOL_RANGE_MPEG) return false;
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(av_get_pix_fmt(layout.format.c_str()));
  return description && (description->nb_components < 3 || (description->flags & AV_PIX_FMT_FLAG_RGB));
}

int known_matrix(const PixelLayout& layout) {
  switch (layout.matrix) {
    case AVCOL_SPC_BT709:
    case AVCOL_SPC_FCC:
    case AVCOL_SPC_BT470BG:
    case AVCOL_SPC_SMPTE170M:
    case AVCOL_SPC_SMPTE240M:
    case AVCOL_SPC_BT2020_NCL:
    case AVCOL_SPC_BT2020_CL:
      return layout.matrix;
    default:
      return layout.height >= 720 ? AVCOL_SPC_BT709 : AVCOL_SPC_SMPTE170M;
  }
}

void convert(const PixelLayout& from, const Image& source, const PixelLayout& to, const Image& target) {
  const Key key{.from_format = av_get_pix_fmt(from.format.c_str()),
                .to_format = av_get_pix_fmt(to.format.c_str()),
                .width = from.width,
                .height = from.height,
                .from_matrix = known_matrix(from),
                .to_matrix = known_matrix(to),
                .from_full = full_range(from),
                .to_full = full_range(to)};
  SwsContext* context = context_for(key);
  if (!context || sws_scale(context, source.data.data(), source.stride.data(), 0, from.height,
                            target.data.data(), target.stride.data()) != from.height)
    throw Error(ErrorKind::kInput, "pixel layout " + from.format,
                "no conversion to " + to.format + " is known",
                "Convert the video to yuv420p or rgb24 with ffmpeg");
}

}  // namespace freshet::media
