#include "synth/animate/still/band_contrast.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"
#include "synth/sampling/widened_rows.h"
#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

constexpr int kWideCell = 16;       // px
constexpr double kWideReach = 1.5;  // sigma, cells
constexpr int kCloseCell = 2;       // samples of the level
constexpr double kCloseReach = 1;   // sigma, cells

/// Square cells of a band, px, in which its power is measured.
int cell_of(int level, Neighbourhood neighbourhood) {
  return neighbourhood == Neighbourhood::kWide ? std::max(1, kWideCell >> level) : kCloseCell;
}

cv::Size cells_of(cv::Size band, int cell) {
  return {(band.width + cell - 1) / cell, (band.height + cell - 1) / cell};
}

FRESHET_WIDE void amplify_row(const sampling::WidenedRows::Row& wanted,
                              const sampling::WidenedRows::Row& found, float share, float most, int n,
                              float* band) {
  const float a = wanted.of_upper, b = wanted.of_lower, c = found.of_upper, d = found.of_lower;
  const float *wu = wanted.upper, *wl = wanted.lower, *fu = found.upper, *fl = found.lower;
  for (int x = 0; x < n; ++x) {
    const float gain = (wu[x] * a + wl[x] * b) * share / (fu[x] * c + fl[x] * d);
    band[x] *= gain < most ? gain : most;
  }
}

/// Times share * wanted / found, sampled in cells, and at most `most`.
void amplify(const cv::Mat& wanted, const cv::Mat& found, double share, double most, cv::Mat& band) {
  sampling::WidenedRows of_wanted(wanted, band.size()), of_found(found, band.size());
  for (int y = 0; y < band.rows; ++y)
    amplify_row(of_wanted.at(y), of_found.at(y), static_cast<float>(share), static_cast<float>(most),
                band.cols, band.ptr<float>(y));
}

/// Mean squares of a band, CV_32F, sampled in its own cells: squares of 16 px, or of two samples of the level.
/// level  0 for the finest.
cv::Mat local_power(const cv::Mat& band, int level, Neighbourhood neighbourhood) {
  const double reach = neighbourhood == Neighbourhood::kWide ? kWideReach : kCloseReach;
  cv::Mat squares, cells;
  cv::multiply(band, band, squares);
  cv::resize(squares, cells, cells_of(band.size(), cell_of(level, neighbourhood)), 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(cells, cells, {}, reach, reach, cv::BORDER_REFLECT_101);
  return cells;
}

}  // namespace

BandContrast::BandContrast(const cv::Mat& luma, int levels, Neighbourhood neighbourhood,
                           std::span<const cv::Mat> counts) {
  levels = vision::levels_within(luma.size(), levels);
  CV_Assert(counts.empty() || counts.size() >= static_cast<std::size_t>(levels));
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(luma, levels, bands);
  for (int level = 0; level < levels; ++level) {
    cv::Mat power = local_power(bands[level], level, neighbourhood);
    if (!counts.empty()) cv::multiply(power, counts[level], power);
    cv::sqrt(power, power);
    amplitude_.push_back(power);
  }
}

std::vector<cv::Mat> BandContrast::counts_of(const cv::Mat& where, int levels, Neighbourhood neighbourhood) {
  levels = vision::levels_within(where.size(), levels);
  std::vector<cv::Mat> counts;
  cv::Size band = where.size();
  for (int level = 0; level < levels; ++level, band = {(band.width + 1) / 2, (band.height + 1) / 2}) {
    cv::Mat of_level;
    cv::resize(where, of_level, cells_of(band, cell_of(level, neighbourhood)), 0, 0, cv::INTER_AREA);
    counts.push_back(of_level);
  }
  return counts;
}

void BandContrast::take_share(cv::Mat& detail, std::span<const double> shares, double max_gain,
                              double noise) const {
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(detail, levels(), bands);
  for (int level = 0; level < levels(); ++level) {
    cv::Mat found = local_power(bands[level], level, Neighbourhood::kWide);
    const double share = static_cast<std::size_t>(level) < shares.size() ? shares[level] : shares.back();
    cv::sqrt(found + noise * noise, found);
    amplify(amplitude_[level], found, std::sqrt(share), max_gain, bands[level]);
  }
  bands.back().setTo(0);
  detail = vision::collapse(std::move(bands));
}

}  // namespace freshet::synth::animate
