#include "synth/stills/between/flow_pair.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "vision/flow.h"

namespace freshet::synth::stills {
namespace {

constexpr int kCoarse = 4;  // the first flow is found at 1 / kCoarse of the size

cv::Mat grey(const cv::Mat& bgr) {
  cv::Mat out;
  cv::cvtColor(bgr, out, cv::COLOR_BGR2GRAY);
  return out;
}

cv::Mat flow_one_way(const cv::Mat& from, const cv::Mat& to) {
  const cv::Size coarse(std::max(64, from.cols / kCoarse), std::max(64, from.rows / kCoarse));
  if (coarse.width >= from.cols || coarse.height >= from.rows) return vision::optical_flow(from, to);
  cv::Mat small_from, small_to, flow;
  cv::resize(from, small_from, coarse, 0, 0, cv::INTER_AREA);
  cv::resize(to, small_to, coarse, 0, 0, cv::INTER_AREA);
  cv::resize(vision::optical_flow(small_from, small_to), flow, from.size(), 0, 0, cv::INTER_LINEAR);
  cv::multiply(flow,
               cv::Scalar(static_cast<double>(from.cols) / coarse.width,
                          static_cast<double>(from.rows) / coarse.height),
               flow);
  return vision::refined_flow(from, to, flow);
}

}  // namespace

FlowPair flow_between(const cv::Mat& from, const cv::Mat& to) {
  const cv::Mat one = grey(from), two = grey(to);
  return {as_flow_integers(flow_one_way(one, two)), as_flow_integers(flow_one_way(two, one))};
}

cv::Mat as_flow_integers(const cv::Mat& flow) {
  cv::Mat out;
  flow.convertTo(out, CV_16S, 1 / FlowPair::kUnit);
  return out;
}

}  // namespace freshet::synth::stills
