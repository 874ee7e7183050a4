// Luminance and BGR of a frame (declared in media/frame/frame.h), and BGRA (in media/frame/bgra.h).
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/bgra.h"
#include "media/frame/frame.h"
#include "media/frame/scaler.h"

namespace freshet::media {
namespace {

// luma = (code >> shift - black) / span, 0..1.
struct LumaCode {
  int shift = 0;
  double black = 0, per_span = 0;
};

const AVPixFmtDescriptor& describe(const PixelLayout& layout) {
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(av_get_pix_fmt(layout.format.c_str()));
  if (!description)
    throw Error(ErrorKind::kInput, "pixel layout " + layout.format, "FFmpeg knows no such format");
  return *description;
}

// Limited range runs from 16 to 235 at 8 bits, scaled by powers of two above; full range uses every code.
LumaCode luma_code(const PixelLayout& layout) {
  const AVComponentDescriptor& luma = describe(layout).comp[0];
  const double scale = std::ldexp(1.0, luma.depth - 8);
  if (full_range(layout)) return {luma.shift, 0, 1 / (256 * scale - 1)};
  return {luma.shift, 16 * scale, 1 / (219 * scale)};
}

float luma_of(const LumaCode& code, int sample) {
  const double luma = ((sample >> code.shift) - code.black) * code.per_span;
  return static_cast<float>(std::clamp(luma, 0.0, 1.0));
}

std::vector<float> luma_table(const PixelLayout& layout, int bytes_per_sample) {
  const LumaCode code = luma_code(layout);
  std::vector<float> table(bytes_per_sample == 1 ? 256 : 65536);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = luma_of(code, static_cast<int>(i));
  return table;
}

template <class Sample, class Value>
void map_samples(const cv::Mat& samples, const std::vector<Value>& table, cv::Mat& out) {
  for (int y = 0; y < samples.rows; ++y) {
    const Sample* from = samples.ptr<Sample>(y);
    Value* to = out.ptr<Value>(y);
    for (int x = 0; x < samples.cols; ++x) to[x] = table[from[x]];
  }
}

cv::Mat view_of(const Plane& plane) {
  return cv::Mat(plane.height, plane.width, plane.bytes_per_sample == 1 ? CV_8U : CV_16U, plane.data,
                 static_cast<std::size_t>(plane.stride));
}

// Weights of R and B; G has the rest.
struct LumaWeights {
  double red = 0.299, blue = 0.114;
};

LumaWeights luma_weights(int matrix) {
  switch (matrix) {
    case AVCOL_SPC_BT709:
      return {0.2126, 0.0722};
    case AVCOL_SPC_FCC:
      return {0.30, 0.11};
    case AVCOL_SPC_SMPTE240M:
      return {0.212, 0.087};
    case AVCOL_SPC_BT2020_NCL:
    case AVCOL_SPC_BT2020_CL:
      return {0.2627, 0.0593};
    default:
      return {};
  }
}

cv::Mat shown(const Frame& frame, const char* format, int type) {
  cv::Mat picture(frame.layout.height, frame.layout.width, type);
  PixelLayout layout;
  layout.format = format;
  layout.width = frame.layout.width;
  layout.height = frame.layout.height;
  layout.range = AVCOL_RANGE_JPEG;
  Image target;
  target.data[0] = picture.data;
  target.stride[0] = static_cast<int>(picture.step[0]);
  convert(frame.layout, image_of(frame), layout, target);
  return picture;
}

}  // namespace

bool luma_in_plane_0(const PixelLayout& layout) {
  const AVPixFmtDescriptor& description = describe(layout);
  if (description.flags &
      (AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_HWACCEL |
       AV_PIX_FMT_FLAG_BAYER | AV_PIX_FMT_FLAG_BE | AV_PIX_FMT_FLAG_FLOAT))
    return false;
  if (std::string_view(description.name).starts_with("xyz")) return false;
  for (int i = 1; i < description.nb_components; ++i)
    if (description.comp[i].plane == 0) return false;  // interleaved: yuyv422, ya8
  return description.comp[0].depth <= 16;
}

cv::Mat luma_from_plane(const PixelLayout& layout, const cv::Mat& samples) {
  if (!luma_in_plane_0(layout) || (samples.type() != CV_8UC1 && samples.type() != CV_16UC1))
    throw Error(ErrorKind::kUsage, "pixel layout " + layout.format,
                "plane 0 is not luminance in 8 or 16 bits");
  cv::Mat luma(samples.size(), CV_32F);
  if (samples.depth() == CV_8U) {
    map_samples<std::uint8_t>(samples, luma_table(layout, 1), luma);
    return luma;
  }
  // Most regions are far smaller than a table of 65536 entries.
  const LumaCode code = luma_code(layout);
  for (int y = 0; y < samples.rows; ++y) {
    const auto* from = samples.ptr<std::uint16_t>(y);
    auto* to = luma.ptr<float>(y);
    for (int x = 0; x < samples.cols; ++x) to[x] = luma_of(code, from[x]);
  }
  return luma;
}

cv::Mat to_luma(const Frame& frame) {
  const PixelLayout& layout = frame.layout;
  if (luma_in_plane_0(layout)) {
    const Plane& plane = frame.planes[0];
    const std::vector<float> exact = luma_table(layout, plane.bytes_per_sample);
    std::vector<std::uint8_t> table(exact.size());
    std::transform(exact.begin(), exact.end(), table.begin(),
                   [](float luma) { return static_cast<std::uint8_t>(std::lround(luma * 255)); });
    const cv::Mat samples = view_of(plane);
    cv::Mat luma(samples.size(), CV_8U);
    if (plane.bytes_per_sample == 1)
      map_samples<std::uint8_t>(samples, table, luma);
    else
      map_samples<std::uint16_t>(samples, table, luma);
    return luma;
  }
  const cv::Mat bgr = to_bgr(frame);
  const LumaWeights weights = luma_weights(layout.matrix);
  constexpr int kBits = 16;
  const int red = static_cast<int>(std::lround(weights.red * (1 << kBits)));
  const int blue = static_cast<int>(std::lround(weights.blue * (1 << kBits)));
  const int green = (1 << kBits) - red - blue;
  cv::Mat luma(bgr.size(), CV_8U);
  for (int y = 0; y < bgr.rows; ++y) {
    const std::uint8_t* from = bgr.ptr(y);
    std::uint8_t* to = luma.ptr(y);
    for (int x = 0; x < bgr.cols; ++x, from += 3)
      to[x] = static_cast<std::uint8_t>(
          (blue * from[0] + green * from[1] + red * from[2] + (1 << (kBits - 1))) >> kBits);
  }
  return luma;
}

cv::Mat to_bgr(const Frame& frame) {
  if (frame.planes.size() == 1 && luma_in_plane_0(frame.layout)) {
    cv::Mat bgr;
    cv::cvtColor(to_luma(frame), bgr, cv::COLOR_GRAY2BGR);
    return bgr;
  }
  return shown(frame, "bgr24", CV_8UC3);
}

bool has_alpha(const PixelLayout& layout) { return (describe(layout).flags & AV_PIX_FMT_FLAG_ALPHA) != 0; }

cv::Mat to_bgra(const Frame& frame) {
  if (has_alpha(frame.layout)) return shown(frame, "bgra", CV_8UC4);
  cv::Mat bgra;
  cv::cvtColor(to_bgr(frame), bgra, cv::COLOR_BGR2BGRA);
  return bgra;
}

bool is_transparent(const cv::Mat& bgra) {
  cv::Mat alpha;
  cv::extractChannel(bgra, alpha, 3);
  double least = 0;
  cv::minMaxLoc(alpha, &least);
  return least < (bgra.depth() == CV_16U ? 65535 : 255);
}

}  // namespace freshet::media
