#include "synth/animate/still/standing_detail.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "vision/dot.h"
#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

constexpr double kMatchedBy = 1.4;

}  // namespace

StandingDetail::StandingDetail(const FluidPlanes& planes, const cv::Mat& matte, std::vector<double> shares)
    : shares_(std::move(shares)) {
  vision::laplacian_pyramid(planes.luma, levels(), bands_);
  for (int level = 0; level < levels(); ++level) {
    cv::Mat within;
    cv::resize(matte, within, band(level).size(), 0, 0, cv::INTER_AREA);
    within_.push_back(within);
    magnitude_.push_back(vision::dot_of_magnitudes(band(level), within));
  }
}

float StandingDetail::match(const cv::Mat& band, int level, double kept, double strength) const {
  const auto at = static_cast<std::size_t>(level);
  const double found = vision::dot_of_magnitudes(band, within_[at]);
  if (found <= 0) return 1;
  return static_cast<float>(
      std::pow(std::clamp(kept * magnitude_[at] / found, 1 / kMatchedBy, kMatchedBy), strength));
}

}  // namespace freshet::synth::animate
