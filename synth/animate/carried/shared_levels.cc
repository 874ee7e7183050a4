#include "synth/animate/carried/shared_levels.h"

namespace freshet::synth::animate {
namespace {

constexpr double kLeast = 1e-4;       // luma: a deviation below is none
constexpr std::size_t kCounted = 64;  // frames at most, evenly spread, by which deviations are told
constexpr double kHere = 1;           // pieces: sigma

}  // namespace

SharedLevels::SharedLevels(const Placement& placement, int frames, double reach)
    : lattice_(placement), reach_(reach) {
  for (int i = 0; i < frames; ++i) levels_.push_back(lattice_.none());
}

void SharedLevels::set(std::size_t patch, int output, float level) {
  levels_[static_cast<std::size_t>(output)].at<float>(lattice_.at(patch)) = level;
}

void SharedLevels::settle() {
  const std::size_t every = (levels_.size() + kCounted - 1) / kCounted,
                    counted = (levels_.size() + every - 1) / every;
  const double share = 1 / static_cast<double>(counted);
  cv::Mat variance = lattice_.none(), deviation;
  for (std::size_t i = 0; i < levels_.size(); i += every) variance += share * levels_[i].mul(levels_[i]);
  cv::sqrt(variance, deviation);
  weights_ = variance + kLeast * kLeast;
  all_weights_ = lattice_.over_canvas(weights_, reach_);
  wanted_ = weighed_mean(deviation);
  found_ = cv::Mat::zeros(all_weights_.size(), CV_32F);
  for (std::size_t i = 0; i < levels_.size(); i += every) {
    const cv::Mat shown = weighed_mean(levels_[i]);
    found_ += share * shown.mul(shown);
  }
  cv::sqrt(found_, found_);
  found_ = cv::max(found_, kLeast);
}

cv::Mat SharedLevels::at(int output) const {
  return lattice_.over_canvas(levels_[static_cast<std::size_t>(output)], reach_);
}

cv::Mat SharedLevels::here(int output) const {
  return lattice_.over_canvas(levels_[static_cast<std::size_t>(output)], kHere);
}

cv::Mat SharedLevels::liveliest(int output, double deviation) const {
  const cv::Mat gain = cv::min(cv::min(wanted_, deviation) / found_, kMostGain);
  return gain.mul(weighed_mean(levels_[static_cast<std::size_t>(output)]));
}

cv::Mat SharedLevels::weighed_mean(const cv::Mat& values) const {
  return lattice_.over_canvas(values.mul(weights_), reach_) / all_weights_;
}

}  // namespace freshet::synth::animate
