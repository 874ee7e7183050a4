#include "media/frame/frame_part.h"

#include "media/frame/scaler.h"

namespace freshet::media {

PixelLayout layout_of_part(const PixelLayout& whole, cv::Size part) {
  PixelLayout layout = whole;
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(av_get_pix_fmt(whole.format.c_str()));
  if (description && (description->flags & AV_PIX_FMT_FLAG_RGB) == 0) layout.matrix = known_matrix(whole);
  layout.width = part.width;
  layout.height = part.height;
  return layout;
}

}  // namespace freshet::media
