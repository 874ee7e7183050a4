// synth/stills/between/flow_pair.h — the flow between two stills of a scene that lie far apart, both ways.
#pragma once

#include <opencv2/core.hpp>

#include "synth/sampling/bilinear.h"

namespace freshet::synth::stills {

/// Flow between two stills, both ways, as 16-bit numbers of kUnit px: half the bytes of floats.
struct FlowPair {
  static constexpr float kUnit = 1.0f / 32;  // px of the pictures it was found on
  cv::Mat forth, back;                       // CV_16SC2: what lies at p in one lies at p + flow in the other
};

/// from, to   CV_8UC3 of one size, at least 64 px a side.
/// DIS at a quarter of the size (what has gone far is near there), then at full size from what that found,
/// each way for itself.
/// Source   in place of Bergen et al. 1992, which Lin et al. 2007 take. Cost   CPU seconds for 1280 x 960:
///          .3.
FlowPair flow_between(const cv::Mat& from, const cv::Mat& to);

/// At a place between its pixels, px; beyond the border as at it.
inline cv::Vec2f flow_at(const cv::Mat& flow, float x, float y) {
  return FlowPair::kUnit * sampling::bilinear<cv::Vec2f, cv::Vec2s>(flow, x, y);
}

/// CV_32FC2, px, as integers of the unit. Saturates at +-1023 px.
cv::Mat as_flow_integers(const cv::Mat& flow);

}  // namespace freshet::synth::stills
