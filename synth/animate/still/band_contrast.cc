#include "synth/animate/still/band_contrast.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

constexpr int kWideCell = 16;       // px
constexpr double kWideReach = 1.5;  // sigma, cells
constexpr int kCloseCell = 2;       // samples of the level
constexpr double kCloseReach = 1;   // sigma, cells

/// Larger, to a band's size.
cv::Mat enlarged(const cv::Mat& cells, cv::Size size) {
  cv::Mat wide;
  cv::resize(cells, wide, size, 0, 0, cv::INTER_LINEAR);
  return wide;
}

/// Mean squares of a band, CV_32F, sampled in its own cells: squares of 16 px, or of two samples of the level.
/// level  0 for the finest.
cv::Mat local_power(const cv::Mat& band, int level, Neighbourhood neighbourhood) {
  const bool wide = neighbourhood == Neighbourhood::kWide;
  const int cell = wide ? std::max(1, kWideCell >> level) : kCloseCell;
  const double reach = wide ? kWideReach : kCloseReach;
  cv::Mat squares, cells;
  cv::multiply(band, band, squares);
  cv::resize(squares, cells, {(band.cols + cell - 1) / cell, (band.rows + cell - 1) / cell}, 0, 0,
             cv::INTER_AREA);
  cv::GaussianBlur(cells, cells, {}, reach, reach, cv::BORDER_REFLECT_101);
  return cells;
}

}  // namespace

BandContrast::BandContrast(const cv::Mat& luma, int levels, Neighbourhood neighbourhood,
                           const cv::Mat& where) {
  levels = vision::levels_within(luma.size(), levels);
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(luma, levels, bands);
  for (int level = 0; level < levels; ++level) {
    cv::Mat power = local_power(bands[level], level, neighbourhood), counts;
    if (!where.empty()) {
      cv::resize(where, counts, power.size(), 0, 0, cv::INTER_AREA);
      cv::multiply(power, counts, power);
    }
    cv::sqrt(power, power);
    amplitude_.push_back(power);
  }
}

void BandContrast::take_share(cv::Mat& detail, std::span<const double> shares, double max_gain,
                              double noise) const {
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(detail, levels(), bands);
  for (int level = 0; level < levels(); ++level) {
    cv::Mat found = local_power(bands[level], level, Neighbourhood::kWide);
    const double share = static_cast<std::size_t>(level) < shares.size() ? shares[level] : shares.back();
    cv::sqrt(found + noise * noise, found);
    const cv::Size size = bands[level].size();
    cv::Mat gain = enlarged(amplitude_[level], size);
    cv::divide(gain, enlarged(found, size), gain, std::sqrt(share));
    cv::multiply(bands[level], cv::min(gain, max_gain), bands[level]);
  }
  bands.back().setTo(0);
  detail = vision::collapse(bands);
}

}  // namespace freshet::synth::animate
