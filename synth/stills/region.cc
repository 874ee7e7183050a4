#include "synth/stills/region.h"

#include <opencv2/imgproc.hpp>

namespace freshet::synth::stills {

std::string to_string(RegionKind kind) {
  switch (kind) {
    case RegionKind::kSlow:
      return "slow";
    case RegionKind::kStanding:
      return "standing";
    default:
      return "independent";
  }
}

std::vector<cv::Mat> region_weights(const std::vector<Region>& regions, double grown, double feather) {
  std::vector<cv::Mat> weights(regions.size());
  if (regions.empty()) return weights;
  cv::Mat sum(regions[0].mask.size(), CV_32F, cv::Scalar(0));
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (regions[i].kind == RegionKind::kStanding) continue;
    const cv::Mat outside = regions[i].mask == 0;
    cv::Mat away(outside.size(), CV_32F, cv::Scalar(0));
    if (cv::countNonZero(outside) > 0 && cv::countNonZero(outside) < static_cast<int>(outside.total()))
      cv::distanceTransform(outside, away, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
    cv::Mat weight = 1 - (away - grown) / (feather + 1);
    weight = cv::min(cv::max(weight, 0), 1);
    weights[i] = weight;
    if (regions[i].kind == RegionKind::kIndependent) sum += weight;
  }
  // A slow region takes what is left: its stills have in them what moves beside it, and would show it as a ghost.
  const cv::Mat left = cv::max(1 - sum, 0);
  sum = cv::max(sum, 1);
  for (std::size_t i = 0; i < regions.size(); ++i)
    if (regions[i].kind == RegionKind::kIndependent)
      cv::divide(weights[i], sum, weights[i]);
    else if (!weights[i].empty())
      weights[i] = cv::min(weights[i], left);
  return weights;
}

}  // namespace freshet::synth::stills
