#include "synth/animate/still/lost_contrast.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

/// How far detail of a band agrees whose places lie apart by the root of `squared` px: 1 / (1 + q + q^2 / 2) in place of
/// exp(-q).
[[gnu::always_inline]] inline float agreement(float squared, float unit) {
  const float q = squared * unit;
  return 1 / (1 + q * (1 + 0.5f * q));
}

/// Squares of lengths, CV_32F.
cv::Mat squared_lengths(const cv::Mat& vectors) {
  cv::Mat out(vectors.size(), CV_32F);
  for (int y = 0; y < out.rows; ++y) {
    const auto* from = vectors.ptr<cv::Vec2f>(y);
    auto* to = out.ptr<float>(y);
    for (int x = 0; x < out.cols; ++x) to[x] = from[x].dot(from[x]);
  }
  return out;
}

/// Weights and distances of what is mixed, sampled as the copies' maps.
struct Term {
  cv::Mat weight, squared;

  /// Adds how far it agrees, weighed, to a row of sums.
  void add(int y, float unit, float* sums) const {
    const auto *w = weight.ptr<float>(y), *d = squared.ptr<float>(y);
    for (int x = 0; x < weight.cols; ++x) sums[x] += w[x] * agreement(d[x], unit);
  }
};

/// Of one level's variance.
struct LevelShares {
  double anew, standing;  // how much comes anew, and how much stands, 0..1
  double most;            // gain
  double agreement_px;
};

/// What the copies of one frame have in common, with each other and with the picture where it lies.
class Mixture {
 public:
  explicit Mixture(std::span<const CopyMap> copies)
      : own_(cv::Mat::zeros(copies.front().weight.size(), CV_32F)) {
    for (std::size_t i = 0; i < copies.size(); ++i) {
      cv::accumulateSquare(copies[i].weight, own_);
      stood_.push_back({copies[i].weight, squared_lengths(copies[i].source)});
      for (std::size_t j = i + 1; j < copies.size(); ++j) {
        const cv::Mat weight = copies[i].weight.mul(copies[j].weight, 2);
        double most = 0;
        cv::minMaxLoc(weight, nullptr, &most);
        if (most > 0) pairs_.push_back({weight, squared_lengths(copies[i].source - copies[j].source)});
      }
    }
  }

  cv::Size size() const { return own_.size(); }

  /// What the mixture of copies, and what the picture where it lies, is multiplied by. where: as restore_contrast has it.
  void gains(const LevelShares& level, const cv::Mat& where, cv::Mat& carried, cv::Mat& stands) const {
    const auto unit = static_cast<float>(1 / (2 * level.agreement_px * level.agreement_px));
    const auto anew = static_cast<float>(level.anew), share = static_cast<float>(level.standing),
               most = static_cast<float>(level.most);
    std::vector<float> variance(own_.cols), covariance(own_.cols);
    for (int y = 0; y < own_.rows; ++y) {
      std::copy_n(own_.ptr<float>(y), own_.cols, variance.data());
      std::fill(covariance.begin(), covariance.end(), 0.0f);
      for (const Term& pair : pairs_) pair.add(y, unit, variance.data());
      for (const Term& copy : stood_) copy.add(y, unit, covariance.data());
      const auto* place = where.empty() ? nullptr : where.ptr<float>(y);
      auto *of_copies = carried.ptr<float>(y), *of_picture = stands.ptr<float>(y);
      for (int x = 0; x < own_.cols; ++x) {
        const float kept = std::sqrt(1 - anew * (place ? place[x] : 1.0f));
        const float gain = std::min(1 / std::sqrt(variance[x]), most);
        const float alike = std::min(1.0f, covariance[x] * gain);
        const float own = share * (1 - alike);
        const float left = std::sqrt(1 - own * own * (1 - alike * alike)) - own * alike;
        of_copies[x] = kept * gain * left;
        of_picture[x] = kept * own;
      }
    }
  }

 private:
  cv::Mat own_;              // sums of squared weights
  std::vector<Term> pairs_;  // 2 a_i a_j, between two copies' sources
  std::vector<Term> stood_;  // a_i, from a place to the copy's source
};

/// Times `gain` a band that is sampled as the maps are, and larger.
void multiply_by(const cv::Mat& gain, int step, int level, cv::Mat& band) {
  // Maps are sampled in the middles of squares of step px, as resize takes it.
  const cv::Size covered(gain.cols * step >> level, gain.rows * step >> level);
  cv::Mat wide;
  cv::resize(gain, wide, {std::max(covered.width, band.cols), std::max(covered.height, band.rows)}, 0, 0,
             cv::INTER_LINEAR);
  cv::multiply(band, wide(cv::Rect({}, band.size())), band);
}

}  // namespace

cv::Mat restore_contrast(cv::Mat& luma, std::span<const CopyMap> copies, int step,
                         std::span<const double> renewed, const cv::Mat& where,
                         const StandingDetail& standing, double begun, const LostContrastOptions& options) {
  const int levels = standing.levels();
  const Mixture mixture(copies);
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(luma, levels, bands);
  const auto mean_place = where.empty() ? 1.0 : cv::mean(where)[0];
  cv::Mat carried(mixture.size(), CV_32F), stands(mixture.size(), CV_32F), own;
  for (int level = 0; level < levels; ++level) {
    const auto at = static_cast<std::size_t>(level);
    const LevelShares shares{.anew = at < renewed.size() ? renewed[at] : 0.0,
                             .standing = standing.share(level),
                             .most = options.max_gain,
                             .agreement_px = options.agreement_px * (1 << level)};
    mixture.gains(shares, where, carried, stands);
    multiply_by(carried, step, level, bands[at]);
    standing.band(level).copyTo(own);
    multiply_by(stands, step, level, own);
    bands[at] += own;
    standing.match(bands[at], level, std::sqrt(1 - shares.anew * mean_place), begun);
  }
  mixture.gains({.anew = 0,
                 .standing = standing.share(levels),
                 .most = 1,
                 .agreement_px = options.agreement_px * (1 << levels)},
                {}, carried, stands);
  cv::subtract(standing.band(levels), bands.back(), own);
  multiply_by(stands, step, levels, own);
  bands.back() += own;
  luma = vision::collapse(bands);
  return stands;
}

}  // namespace freshet::synth::animate
