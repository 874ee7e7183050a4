#include "media/frame/frame_warp.h"

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/libav.h"

namespace freshet::media {
namespace {

/// How a plane's samples lie.
struct PlaneGrid {
  int components = 0;          // of each sample, interleaved
  int log2_x = 0, log2_y = 0;  // one sample for 2^n pixels
  int depth = 8, shift = 0;    // bits; of a word
};

PlaneGrid grid_of(const AVPixFmtDescriptor& description, int plane, const PixelLayout& layout) {
  PlaneGrid grid;
  int step = 0;
  bool even = true;
  for (int i = 0; i < description.nb_components; ++i) {
    const AVComponentDescriptor& component = description.comp[i];
    if (component.plane != plane) continue;
    ++grid.components;
    grid.depth = component.depth;
    grid.shift = component.shift;
    even = even && (step == 0 || step == component.step);
    step = component.step;
    const bool chroma = (i == 1 || i == 2) && (description.flags & AV_PIX_FMT_FLAG_RGB) == 0;
    grid.log2_x = chroma ? description.log2_chroma_w : 0;
    grid.log2_y = chroma ? description.log2_chroma_h : 0;
  }
  const int bytes = grid.depth > 8 ? 2 : 1;
  if (grid.components == 3 && step == 4 * bytes) grid.components = 4;  // "rgb0": one is unused
  if (!even || grid.components < 1 || step != grid.components * bytes || grid.depth > 16)
    throw Error(ErrorKind::kInput, "pixel format " + layout.format,
                "its frames cannot be moved in their own planes",
                "Convert it first: ffmpeg -i CLIP -pix_fmt yuv420p -c:v ffv1 OUT.mkv");
  return grid;
}

}  // namespace

Frame warped(const Frame& frame, const SourceFromResult& m, cv::Size size) {
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(av_get_pix_fmt(frame.layout.format.c_str()));
  PixelLayout layout = frame.layout;
  layout.width = size.width;
  layout.height = size.height;
  Frame result = make_frame(layout);
  result.time_s = frame.time_s;
  for (std::size_t p = 0; p < frame.planes.size(); ++p) {
    const Plane& from = frame.planes[p];
    Plane& to = result.planes[p];
    const PlaneGrid grid = grid_of(*description, static_cast<int>(p), layout);
    // Pixel = scale * sample + offset.
    const double scale_x = 1 << grid.log2_x, scale_y = 1 << grid.log2_y, offset_y = (scale_y - 1) / 2;
    const cv::Matx33d pixel(scale_x, 0, 0, 0, scale_y, offset_y, 0, 0, 1);
    const cv::Matx33d whole(m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), 0, 0, 1);
    const cv::Matx33d sample = pixel.inv() * whole * pixel;
    const int type = CV_MAKETYPE(from.bytes_per_sample == 2 ? CV_16U : CV_8U, grid.components);
    const cv::Mat source(from.height, from.width / grid.components, type, from.data,
                         static_cast<std::size_t>(from.stride));
    cv::Mat target(to.height, to.width / grid.components, type, to.data, static_cast<std::size_t>(to.stride));
    cv::warpAffine(source, target, cv::Mat(sample).rowRange(0, 2), target.size(),
                   cv::INTER_LANCZOS4 | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    // Its lobes may go beyond what the bits hold.
    if (from.bytes_per_sample == 2 && grid.depth + grid.shift < 16)
      cv::min(target, cv::Scalar::all((1 << (grid.depth + grid.shift)) - 1), target);
  }
  return result;
}

}  // namespace freshet::media
