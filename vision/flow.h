// vision/flow.h — dense optical flow between neighbouring frames.
#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace freshet::vision {

enum class FlowMethod { kDis, kTvL1 };

struct FlowOptions {
  FlowMethod method = FlowMethod::kDis;  // DIS, medium preset
  /// TV-L1 as Okabe et al. 2011, Sec. 4 set it: theta 1.0, lambda 0.8, 25 iterations, 5 warps. Their
  /// intensity scale is not stated; OpenCV's, and so this lambda's, is 0..255.
  double tvl1_lambda = 0.8, tvl1_theta = 1.0;
  int tvl1_iterations = 25, tvl1_warps = 5;
};
FlowMethod parse_flow_method(const std::string& name);  // "dis", "tv-l1"; Error{kUsage}

/// from, to   CV_8U, same size, at least 16 x 16 px.
/// Returns    CV_32FC2, px per frame, x right, y down: what lies at p in `from` lies at p + flow(p) in `to`.
/// Frames are continued by reflection to a size that DIS survives (64 px, multiples of 8) and the flow is cut
/// back. TV-L1 is ours (vision/flow/tv_l1.h), never from an earlier flow.
///
/// Deterministic, and measured the same for 1, 2, 4 and 8 OpenCV threads (4.6, DIS). cv::setNumThreads is
/// global, so the program sets it to 1 when it starts, not this function. Flow then runs on the calling
/// thread alone, and frames are shared out among threads by whoever calls it.
///
/// Cost       CPU seconds for 640 x 480: DIS 0.035, TV-L1 0.16.
cv::Mat optical_flow(const cv::Mat& from, const cv::Mat& to, const FlowOptions& options = {});

/// DIS again, from an earlier flow of the two: CV_32FC2, of their size. For frames that lie far apart, whose coarse
/// flow was found on reduced ones.
cv::Mat refined_flow(const cv::Mat& from, const cv::Mat& to, const cv::Mat& initial);

/// Flow as kept in a store: CV_16SC1 planes of 1/64 px (of the source, whatever the step), reduced by `step`
/// (area average; 1 keeps every pixel) to ceil(side / step); blocks over the edge repeat the last pixel.
/// Saturates at +-511 px.
void quantize_flow(const cv::Mat& flow, int step, cv::Mat& u, cv::Mat& v);
inline constexpr float kFlowUnit = 1.0f / 64;  // px

}  // namespace freshet::vision
