#include "synth/animate/still/standing_detail.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

constexpr int kColourStep = 8;  // of half the picture: what is finer goes with the fluid
constexpr double kMatchedBy = 1.4;

cv::Size coarse_size(cv::Size half) {
  return {(half.width + kColourStep - 1) / kColourStep, (half.height + kColourStep - 1) / kColourStep};
}

}  // namespace

StandingDetail::StandingDetail(const FluidPlanes& planes, const cv::Mat& matte, std::vector<double> shares)
    : shares_(std::move(shares)) {
  vision::laplacian_pyramid(planes.luma, levels(), bands_);
  for (int level = 0; level < levels(); ++level) {
    cv::Mat within;
    cv::resize(matte, within, band(level).size(), 0, 0, cv::INTER_AREA);
    within_.push_back(within);
    magnitude_.push_back(cv::Mat(cv::abs(band(level))).dot(within));
  }
  const cv::Size half((matte.cols + 1) / 2, (matte.rows + 1) / 2);
  const std::array<const cv::Mat*, 2> colours{&planes.blue, &planes.red};
  for (std::size_t k = 0; k < colour_.size(); ++k) {
    cv::Mat reduced;
    cv::resize(*colours[k], reduced, half, 0, 0, cv::INTER_AREA);
    reduced.convertTo(colour_[k], CV_16S, CarriedFrame::kOne);
  }
}

float StandingDetail::match(const cv::Mat& band, int level, double kept, double strength) const {
  const auto at = static_cast<std::size_t>(level);
  const double found = cv::Mat(cv::abs(band)).dot(within_[at]);
  if (found <= 0) return 1;
  return static_cast<float>(
      std::pow(std::clamp(kept * magnitude_[at] / found, 1 / kMatchedBy, kMatchedBy), strength));
}

void StandingDetail::colour(CarriedFrame& frame, const cv::Mat& stands) const {
  const cv::Size half = frame.blue.size(), coarse = coarse_size(half);
  const cv::Mat empty = frame.fraction <= 0;
  const std::array<cv::Mat*, 2> planes{&frame.blue, &frame.red};
  cv::Mat share, away, wide;
  cv::resize(stands, share, coarse, 0, 0, cv::INTER_LINEAR);
  for (std::size_t k = 0; k < planes.size(); ++k) {
    cv::subtract(colour_[k], *planes[k], away, cv::noArray(), CV_32F);
    away.setTo(0, empty);
    cv::resize(away, wide, coarse, 0, 0, cv::INTER_AREA);
    cv::resize(wide.mul(share), away, half, 0, 0, cv::INTER_LINEAR);
    cv::add(*planes[k], away, *planes[k], cv::noArray(), CV_16S);
  }
}

}  // namespace freshet::synth::animate
