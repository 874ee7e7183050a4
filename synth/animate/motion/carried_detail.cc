#include "synth/animate/motion/carried_detail.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/sampling/coarse_samples.h"

namespace freshet::synth::animate {
namespace {

constexpr int kStrip = 64;  // rows

}  // namespace

CarriedDetail::CarriedDetail(const cv::Rect& canvas, double scale, double kept)
    : canvas_(canvas), scale_(scale), kept_(kept) {}

const cv::Mat& CarriedDetail::advance(const cv::Mat& displacement, int step, const cv::Mat& fresh) {
  if (detail_.empty()) {
    detail_ = fresh.clone();
    return detail_;
  }
  // Where each place of the canvas was a frame ago: px of the canvas.
  cv::Mat carried(canvas_.size(), CV_32F);
  const int strips = (canvas_.height + kStrip - 1) / kStrip;
  oneapi::tbb::parallel_for(0, strips, [&](int strip) {
    const int top = strip * kStrip, rows = std::min(kStrip, canvas_.height - top);
    cv::Mat where;
    cv::warpAffine(displacement, where,
                   sampling::samples_from_pixels(step, scale_, canvas_.tl() + cv::Point(0, top)),
                   {canvas_.width, rows}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    const auto per_px = static_cast<float>(1 / scale_);
    for (int y = 0; y < rows; ++y) {
      auto* to = where.ptr<cv::Vec2f>(y);
      for (int x = 0; x < canvas_.width; ++x)
        to[x] = {static_cast<float>(x) - per_px * to[x][0], static_cast<float>(top + y) - per_px * to[x][1]};
    }
    cv::Mat part = carried.rowRange(top, top + rows);
    cv::remap(detail_, part, where, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_CONSTANT, cv::Scalar(0));
  });
  cv::scaleAdd(carried, kept_, fresh, detail_);
  return detail_;
}

}  // namespace freshet::synth::animate
