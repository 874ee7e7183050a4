#include "synth/animate/carried/renewal.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/animate/placement/piece_values.h"
#include "synth/animate/still/band_contrast.h"

namespace freshet::synth::animate {
namespace {

constexpr double kNoise = 0.003;  // luma: of what is fainter, the more is coding noise
// Of the canvas's finest band a third of what is found is taken, of the next two thirds; of the picture's finest, which
// the canvas has not, nothing (placement.h, halved). What flow does not explain of the finest detail is mostly the
// clip's noise, and between samples at half the size their reading: rapids looked like sandpaper, flames had crumbs on
// their edges.
constexpr double kTrustedFrom = 3;
constexpr double kMostAnew = 0.6;
constexpr double kReach = 1;  // sigma, pieces: neighbours renew alike

double kept_per_frame(double half_life_s, double fps) { return std::pow(0.5, 1 / (half_life_s * fps)); }

}  // namespace

Renewal::Renewal(const Placement& placement, const PiecesCanvas& canvas, const cv::Mat& luma,
                 Blender& blender, double fps, const RenewalOptions& options)
    : placement_(placement),
      canvas_(canvas),
      blender_(blender),
      options_(options),
      kept_(kept_per_frame(options.half_life_s, fps)),
      power_(placement.patches.size()),
      anew_(placement.patches.size()),
      carried_(canvas.rect(), canvas.scale(), kept_) {
  const cv::Mat still = canvas.cut(luma);
  oneapi::tbb::parallel_for(std::size_t{0}, power_.size(), [&](std::size_t p) {
    const cv::Point at = placement.patches[p].piece - canvas.rect().tl();
    power_[p] = blender.band_power(still(cv::Rect(at, cv::Size(placement.side, placement.side))));
  });
}

/// Of each band's variance, what comes anew.
std::vector<double> Renewal::anew_of(const ClipLayer::DetailPower& power) const {
  std::vector<double> anew(power.shown.size(), 0.0);
  const double unexplained = 1.5 - 2 * kept_ + 0.5 * kept_ * kept_;
  for (std::size_t level = 0; level < anew.size(); ++level) {
    const double noise = kNoise * kNoise, shown = power.shown[level] - noise;
    if (shown <= noise) continue;
    const double trusted = std::min(1.0, static_cast<double>(1 << level) / kTrustedFrom);
    const double found = std::max(0.0, power.anew[level] - noise) / (unexplained * shown);
    anew[level] = options_.share * std::min(trusted * found, kMostAnew);
  }
  return anew;
}

void Renewal::measure(ClipLayer& layer, std::span<const int> samples) {
  for (const auto& [patch, power] : layer.detail_power(samples, blender_)) {
    anew_[patch] = anew_of(power);
    std::vector<float> gains(power.anew.size());
    for (std::size_t level = 0; level < gains.size(); ++level) {
      const double wanted = anew_[patch][level] * (1 - kept_ * kept_) * power_[patch][level];
      const double found = power.anew[level] + kNoise * kNoise;
      gains[level] = static_cast<float>(std::min(std::sqrt(wanted / found), options_.max_gain));
    }
    blender_.scale(patch, gains);
  }
}

void Renewal::settle() {
  shares_.assign(static_cast<std::size_t>(blender_.levels()), 0.0);
  double power = 0, anew = 0;
  for (std::size_t p = 0; p < anew_.size(); ++p)
    for (std::size_t level = 0; level < anew_[p].size(); ++level) {
      shares_[level] += anew_[p][level] / static_cast<double>(anew_.size());
      anew += anew_[p][level] * power_[p][level];
      power += power_[p][level];
    }
  overall_ = power > 0 ? anew / power : 0;
  const double all = std::accumulate(shares_.begin(), shares_.end(), 0.0);
  const PieceValues lattice(placement_);
  cv::Mat relative = lattice.none();
  for (std::size_t p = 0; p < anew_.size() && all > 0; ++p)
    relative.at<float>(lattice.at(p)) =
        static_cast<float>(std::accumulate(anew_[p].begin(), anew_[p].end(), 0.0) / all);
  places_ = lattice.over_canvas(relative, kReach);
  const double most = *std::max_element(shares_.begin(), shares_.end());
  if (most > 0) places_ = cv::min(places_, kMostAnew / most);
}

cv::Mat Renewal::advance(const cv::Mat& displacement, int step, const cv::Mat& fresh) {
  return carried_.advance(displacement, step, fresh).clone();
}

std::vector<cv::Mat> Renewal::counts_of(const cv::Mat& where) {
  return BandContrast::counts_of(where, kLevels, Neighbourhood::kClose);
}

double Renewal::share_of_picture(int level) const {
  const double at = level - std::log2(canvas_.scale()), below = std::floor(at);
  // Of bands that are not the canvas's nothing comes anew.
  const auto of_canvas = [this](double canvas_level) {
    return canvas_level < 0 || canvas_level >= kLevels ? 0.0 : share(static_cast<std::size_t>(canvas_level));
  };
  return of_canvas(below) + (at - below) * (of_canvas(below + 1) - of_canvas(below));
}

void Renewal::show(cv::Mat& detail, const cv::Mat& luma, double begun,
                   std::span<const cv::Mat> counts) const {
  std::vector<double> shares(kLevels);
  for (std::size_t level = 0; level < shares.size(); ++level) shares[level] = begun * share(level);
  BandContrast(canvas_.cut(luma), kLevels, Neighbourhood::kClose, counts)
      .take_share(detail, shares, options_.max_gain, kNoise);
}

}  // namespace freshet::synth::animate
