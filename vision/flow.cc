#include "vision/flow.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "freshet/error.h"
#include "vision/flow/tv_l1.h"

namespace freshet::vision {
namespace {

constexpr int kMinSide = 16;
// DIS has crashed on small and on oddly sized frames (opencv#14554, #20185, opencv_contrib#1476): it is given
// frames of 64 px or more whose sides halve three times without a remainder.
constexpr int kSafeSide = 64, kSafeMultiple = 8;

int safe_side(int side) {
  return std::max(kSafeSide, (side + kSafeMultiple - 1) / kSafeMultiple * kSafeMultiple);
}

cv::Mat extended(const cv::Mat& picture, cv::Size size) {
  if (picture.size() == size) return picture;
  cv::Mat larger;
  cv::copyMakeBorder(picture, larger, 0, size.height - picture.rows, 0, size.width - picture.cols,
                     cv::BORDER_REFLECT_101);
  return larger;
}

void expect_frames(const cv::Mat& from, const cv::Mat& to) {
  if (from.type() != CV_8UC1 || to.type() != CV_8UC1 || from.size() != to.size()) {
    throw Error(ErrorKind::kUsage, "flow", "two 8-bit planes of one size expected");
  }
  if (from.cols < kMinSide || from.rows < kMinSide) {
    throw Error(ErrorKind::kInput, "flow",
                "frames of " + std::to_string(from.cols) + " x " + std::to_string(from.rows) +
                    " px, at least 16 x 16 expected");
  }
}

[[noreturn]] void refuse(const cv::Mat& from, const cv::Exception& fault) {
  throw Error(ErrorKind::kInput, "flow",
              "OpenCV refused frames of " + std::to_string(from.cols) + " x " + std::to_string(from.rows) +
                  " px (" + fault.err + ")");
}

}  // namespace

FlowMethod parse_flow_method(const std::string& name) {
  if (name == "dis") return FlowMethod::kDis;
  if (name == "tv-l1") return FlowMethod::kTvL1;
  throw Error(ErrorKind::kUsage, "flow method", "\"" + name + "\" is not known", "Choose dis or tv-l1");
}

cv::Mat optical_flow(const cv::Mat& from, const cv::Mat& to, const FlowOptions& options) {
  expect_frames(from, to);
  const cv::Size safe(safe_side(from.cols), safe_side(from.rows));
  cv::Mat flow;
  try {
    if (options.method == FlowMethod::kTvL1) {
      return tv_l1_flow(from, to,
                        {.lambda = options.tvl1_lambda,
                         .theta = options.tvl1_theta,
                         .iterations = options.tvl1_iterations,
                         .warps = options.tvl1_warps});
    }
    cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM)
        ->calc(extended(from, safe), extended(to, safe), flow);
  } catch (const cv::Exception& fault) {
    refuse(from, fault);
  }
  return flow.size() == from.size() ? flow : flow(cv::Rect(cv::Point(), from.size())).clone();
}

cv::Mat refined_flow(const cv::Mat& from, const cv::Mat& to, const cv::Mat& initial) {
  expect_frames(from, to);
  if (initial.type() != CV_32FC2 || initial.size() != from.size())
    throw Error(ErrorKind::kUsage, "flow", "an earlier flow of the frames' size expected");
  const cv::Size safe(safe_side(from.cols), safe_side(from.rows));
  cv::Mat flow;
  cv::copyMakeBorder(initial, flow, 0, safe.height - from.rows, 0, safe.width - from.cols,
                     cv::BORDER_REPLICATE);
  try {
    cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM)
        ->calc(extended(from, safe), extended(to, safe), flow);
  } catch (const cv::Exception& fault) {
    refuse(from, fault);
  }
  return flow.size() == from.size() ? flow : flow(cv::Rect(cv::Point(), from.size())).clone();
}

void quantize_flow(const cv::Mat& flow, int step, cv::Mat& u, cv::Mat& v) {
  if (flow.type() != CV_32FC2 || flow.empty() || step < 1 || step > 64) {
    throw Error(ErrorKind::kUsage, "flow", "a CV_32FC2 map and a step of 1 to 64 px expected");
  }
  cv::Mat reduced = flow;
  if (step > 1) {
    const cv::Size size((flow.cols + step - 1) / step, (flow.rows + step - 1) / step);
    cv::Mat whole = flow;
    if (size * step != flow.size()) {
      cv::copyMakeBorder(flow, whole, 0, size.height * step - flow.rows, 0, size.width * step - flow.cols,
                         cv::BORDER_REPLICATE);
    }
    cv::resize(whole, reduced, size, 0, 0, cv::INTER_AREA);
  }
  cv::Mat planes[2];
  cv::split(reduced, planes);
  planes[0].convertTo(u, CV_16S, 1 / kFlowUnit);
  planes[1].convertTo(v, CV_16S, 1 / kFlowUnit);
}

}  // namespace freshet::vision
