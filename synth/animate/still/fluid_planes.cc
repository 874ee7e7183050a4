#include "synth/animate/still/fluid_planes.h"

#include <array>
#include <vector>

#include "synth/sampling/pull_push.h"

namespace freshet::synth::animate {
namespace {

constexpr float kTrusted = 8;  // of a matte of 1 / 8

}  // namespace

FluidPlanes fluid_planes(const cv::Mat& picture, const cv::Mat& luma, const cv::Mat& matte) {
  std::array<cv::Mat, 3> bgr, planes;
  cv::split(picture, bgr.data());
  cv::Mat values;
  cv::merge(std::vector<cv::Mat>{luma, bgr[0] - luma, bgr[2] - luma}, values);
  const cv::Mat trusted = cv::min(kTrusted * matte, 1.0);
  cv::split(sampling::pull_push(values, trusted), planes.data());
  return {.luma = planes[0], .blue = planes[1], .red = planes[2], .trusted = trusted};
}

}  // namespace freshet::synth::animate
