#include "synth/transfer/files/exemplar_motion.h"

#include <opencv2/imgproc.hpp>

#include "vision/flow.h"

namespace freshet::synth::transfer {
namespace {

cv::Mat grey_over_black(const cv::Mat& bgra) {
  const double unit = bgra.depth() == CV_8U ? 1.0 / 255 : bgra.depth() == CV_16U ? 1.0 / 65535 : 1;
  cv::Mat values, grey, alpha;
  bgra.convertTo(values, CV_32F, unit);
  cv::cvtColor(values, grey, cv::COLOR_BGRA2GRAY);
  cv::extractChannel(values, alpha, 3);
  cv::Mat(255 * grey.mul(alpha)).convertTo(grey, CV_8U);
  return grey;
}

}  // namespace

cv::Mat motion_between(const cv::Mat& from, const cv::Mat& to) {
  return vision::optical_flow(grey_over_black(from), grey_over_black(to),
                              {.method = vision::FlowMethod::kTvL1});
}

}  // namespace freshet::synth::transfer
