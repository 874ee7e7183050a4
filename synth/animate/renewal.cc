#include "synth/animate/renewal.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <oneapi/tbb/parallel_for.h>

#include "synth/animate/still/band_contrast.h"

namespace freshet::synth::animate {
namespace {

constexpr double kNoise = 0.003;  // luma: of what is fainter, the more is coding noise

double kept_per_frame(const RenewalOptions& options) {
  return std::pow(0.5, 1 / (options.half_life_s * options.fps));
}

}  // namespace

Renewal::Renewal(const Placement& placement, const PiecesCanvas& canvas, const cv::Mat& luma,
                 Blender& blender, const RenewalOptions& options)
    : canvas_(canvas),
      blender_(blender),
      options_(options),
      kept_(kept_per_frame(options)),
      power_(placement.patches.size()),
      carried_(canvas.rect(), canvas.scale(), kept_) {
  const cv::Mat still = canvas.cut(luma);
  oneapi::tbb::parallel_for(std::size_t{0}, power_.size(), [&](std::size_t p) {
    const cv::Point at = placement.patches[p].piece - canvas.rect().tl();
    power_[p] = blender.band_power(still(cv::Rect(at, cv::Size(placement.side, placement.side))));
  });
}

double Renewal::share(std::size_t level) const {
  return options_.share * std::min(1.0, static_cast<double>(1 << level) / 3);
}

void Renewal::scale(ClipLayer& layer, std::span<const int> samples) {
  for (const auto& [patch, power] : layer.detail_power(samples, blender_)) {
    std::vector<float> gains(power.size());
    for (std::size_t level = 0; level < power.size(); ++level) {
      const double wanted = share(level) * (1 - kept_ * kept_) * power_[patch][level];
      const double found = power[level] + kNoise * kNoise;
      gains[level] = static_cast<float>(std::min(std::sqrt(wanted / found), options_.max_gain));
    }
    blender_.scale(patch, gains);
  }
}

cv::Mat Renewal::advance(const cv::Mat& displacement, int step, const cv::Mat& fresh) {
  return carried_.advance(displacement, step, fresh).clone();
}

void Renewal::show(cv::Mat& detail, const cv::Mat& luma, std::span<const double> shares,
                   const cv::Mat& where) const {
  BandContrast(canvas_.cut(luma), kLevels, Neighbourhood::kClose, where)
      .take_share(detail, shares, options_.max_gain, kNoise);
}

}  // namespace freshet::synth::animate
