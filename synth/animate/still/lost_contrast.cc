#include "synth/animate/still/lost_contrast.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"
#include "synth/sampling/widened_rows.h"
#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

/// How far detail of a band agrees whose places lie apart by the root of `squared` px: 1 / (1 + q + q^2 / 2) in place
/// of exp(-q).
[[gnu::always_inline]] inline float agreement(float squared, float unit) {
  const float q = squared * unit;
  return 1 / (1 + q * (1 + 0.5f * q));
}

FRESHET_WIDE void square_lengths(const float* pairs, int n, float* to) {
  for (int x = 0; x < n; ++x) to[x] = pairs[2 * x] * pairs[2 * x] + pairs[2 * x + 1] * pairs[2 * x + 1];
}

/// Squares of lengths, CV_32F.
cv::Mat squared_lengths(const cv::Mat& vectors) {
  cv::Mat out(vectors.size(), CV_32F);
  for (int y = 0; y < out.rows; ++y) square_lengths(vectors.ptr<float>(y), out.cols, out.ptr<float>(y));
  return out;
}

FRESHET_WIDE void add_agreement(const float* weight, const float* squared, float unit, int n, float* sums) {
  for (int x = 0; x < n; ++x) sums[x] += weight[x] * agreement(squared[x], unit);
}

/// Weights and distances of what is mixed, sampled as the copies' maps.
struct Term {
  cv::Mat weight, squared;

  /// Adds how far it agrees, weighed, to a row of sums.
  void add(int y, float unit, float* sums) const {
    add_agreement(weight.ptr<float>(y), squared.ptr<float>(y), unit, weight.cols, sums);
  }
};

/// Of one level's variance.
struct LevelShares {
  double anew, standing;  // how much comes anew, and how much stands, 0..1
  double most;            // gain
  double agreement_px;
};

/// What a mixture of this variance, and the picture of this covariance with it, is multiplied by.
/// places: how much of what comes anew each place leaves.
FRESHET_WIDE void share_out(const float* variance, const float* covariance, const float* places, float anew,
                            float share, float most, int n, float* of_copies, float* of_picture) {
  for (int x = 0; x < n; ++x) {
    const float kept = std::sqrt(1 - anew * places[x]);
    const float found = 1 / std::sqrt(variance[x]);
    const float gain = most < found ? most : found;
    const float both = covariance[x] * gain;
    const float alike = both < 1.0f ? both : 1.0f;
    const float own = share * (1 - alike);
    const float left = std::sqrt(1 - own * own * (1 - alike * alike)) - own * alike;
    of_copies[x] = kept * gain * left;
    of_picture[x] = kept * own;
  }
}

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

  /// What the mixture of copies, and what the picture where it lies, is multiplied by. where: as restore_contrast has
  /// it.
  void gains(const LevelShares& level, const cv::Mat& where, cv::Mat& carried, cv::Mat& stands) const {
    const auto unit = static_cast<float>(1 / (2 * level.agreement_px * level.agreement_px));
    const auto anew = static_cast<float>(level.anew), share = static_cast<float>(level.standing),
               most = static_cast<float>(level.most);
    std::vector<float> variance(own_.cols), covariance(own_.cols);
    const std::vector<float> everywhere(where.empty() ? own_.cols : 0, 1.0f);
    for (int y = 0; y < own_.rows; ++y) {
      std::copy_n(own_.ptr<float>(y), own_.cols, variance.data());
      std::fill(covariance.begin(), covariance.end(), 0.0f);
      for (const Term& pair : pairs_) pair.add(y, unit, variance.data());
      if (share > 0)
        for (const Term& copy : stood_) copy.add(y, unit, covariance.data());
      share_out(variance.data(), covariance.data(), where.empty() ? everywhere.data() : where.ptr<float>(y),
                anew, share, most, own_.cols, carried.ptr<float>(y), stands.ptr<float>(y));
    }
  }

 private:
  cv::Mat own_;              // sums of squared weights
  std::vector<Term> pairs_;  // 2 a_i a_j, between two copies' sources
  std::vector<Term> stood_;  // a_i, from a place to the copy's source
};

/// A gain that is sampled as the maps are, for a band: larger, and cut to the band's size. Maps are sampled in the
/// middles of squares of step px, as resize takes it.
sampling::WidenedRows rows_of(const cv::Mat& gain, int step, int level, cv::Size band) {
  const cv::Size covered(gain.cols * step >> level, gain.rows * step >> level);
  return {gain, {std::max(covered.width, band.width), std::max(covered.height, band.height)}};
}

FRESHET_WIDE void mix_row(const sampling::WidenedRows::Row& carried, const sampling::WidenedRows::Row& stands,
                          const float* own, int n, float* band) {
  const float a = carried.of_upper, b = carried.of_lower, c = stands.of_upper, d = stands.of_lower;
  const float *cu = carried.upper, *cl = carried.lower, *su = stands.upper, *sl = stands.lower;
  for (int x = 0; x < n; ++x) band[x] = band[x] * (cu[x] * a + cl[x] * b) + own[x] * (su[x] * c + sl[x] * d);
}

/// band = band * carried + own * stands.
void mix(const cv::Mat& carried, const cv::Mat& stands, const cv::Mat& own, int step, int level,
         cv::Mat& band) {
  sampling::WidenedRows of_band = rows_of(carried, step, level, band.size()),
                        of_own = rows_of(stands, step, level, band.size());
  for (int y = 0; y < band.rows; ++y)
    mix_row(of_band.at(y), of_own.at(y), own.ptr<float>(y), band.cols, band.ptr<float>(y));
}

FRESHET_WIDE void add_row(const sampling::WidenedRows::Row& share, const float* own, int n, float* band) {
  const float a = share.of_upper, b = share.of_lower;
  const float *u = share.upper, *l = share.lower;
  for (int x = 0; x < n; ++x) band[x] += (own[x] - band[x]) * (u[x] * a + l[x] * b);
}

/// band += (own - band) * share.
void bring_to(const cv::Mat& own, const cv::Mat& share, int step, int level, cv::Mat& band) {
  sampling::WidenedRows of_own = rows_of(share, step, level, band.size());
  for (int y = 0; y < band.rows; ++y) add_row(of_own.at(y), own.ptr<float>(y), band.cols, band.ptr<float>(y));
}

FRESHET_WIDE void scale_row(const sampling::WidenedRows::Row& carried, const float* magnitude, int n,
                            float* band) {
  const float a = carried.of_upper, b = carried.of_lower;
  const float *u = carried.upper, *l = carried.lower;
  for (int x = 0; x < n; ++x) band[x] *= magnitude[x] * (u[x] * a + l[x] * b);
}

}  // namespace

void restore_contrast(cv::Mat& luma, std::span<const CopyMap> copies, int step,
                      std::span<const double> renewed, const cv::Mat& where, const StandingDetail& standing,
                      double begun, const LostContrastOptions& options) {
  const int levels = standing.levels();
  const Mixture mixture(copies);
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(luma, levels, bands);
  const auto mean_place = where.empty() ? 1.0 : cv::mean(where)[0];
  cv::Mat carried(mixture.size(), CV_32F), stands(mixture.size(), CV_32F);
  std::vector<float> matched;
  for (int level = 0; level < levels; ++level) {
    const auto at = static_cast<std::size_t>(level);
    const LevelShares shares{.anew = at < renewed.size() ? renewed[at] : 0.0,
                             .standing = standing.share(level),
                             .most = options.max_gain,
                             .agreement_px = options.agreement_px * (1 << level)};
    mixture.gains(shares, where, carried, stands);
    mix(carried, stands, standing.band(level), step, level, bands[at]);
    matched.push_back(standing.match(bands[at], level, std::sqrt(1 - shares.anew * mean_place), begun));
  }
  mixture.gains({.anew = 0,
                 .standing = standing.share(levels),
                 .most = 1,
                 .agreement_px = options.agreement_px * (1 << levels)},
                {}, carried, stands);
  bring_to(standing.band(levels), stands, step, levels, bands.back());
  luma = vision::collapse(std::move(bands), matched);
}

void lay_texture(cv::Mat& luma, std::span<const CopyMap> copies, int step, std::span<const double> renewed,
                 const cv::Mat& where, const StandingLayout& layout, const LostContrastOptions& options) {
  const Mixture mixture(copies);
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(luma, layout.levels(), bands);
  cv::Mat carried(mixture.size(), CV_32F), none(mixture.size(), CV_32F);
  for (int level = 0; level < layout.levels(); ++level) {
    const auto at = static_cast<std::size_t>(level);
    mixture.gains({.anew = at < renewed.size() ? renewed[at] : 0.0,
                   .standing = 0,
                   .most = options.max_gain,
                   .agreement_px = options.agreement_px * (1 << level)},
                  where, carried, none);
    cv::Mat& band = bands[at];
    sampling::WidenedRows gains = rows_of(carried, step, level, band.size());
    for (int y = 0; y < band.rows; ++y)
      scale_row(gains.at(y), layout.magnitude(level).ptr<float>(y), band.cols, band.ptr<float>(y));
    layout.lay(band, level);
  }
  layout.stands(layout.levels()).copyTo(bands.back());
  luma = vision::collapse(std::move(bands));
}

}  // namespace freshet::synth::animate
