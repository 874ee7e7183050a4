#include "synth/animate/still/band_contrast.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

constexpr int kCell = 16;  // px between samples of powers

}  // namespace

cv::Mat BandContrast::power_of(const cv::Mat& band, int level) const {
  const int cell = std::max(1, kCell >> level);
  cv::Mat squares, cells;
  cv::multiply(band, band, squares);
  cv::resize(squares, cells, {(band.cols + cell - 1) / cell, (band.rows + cell - 1) / cell}, 0, 0,
             cv::INTER_AREA);
  cv::GaussianBlur(cells, cells, {}, reach_ / kCell, reach_ / kCell, cv::BORDER_REFLECT_101);
  return cells;
}

BandContrast::BandContrast(const cv::Mat& luma, int levels, double reach, const cv::Mat& where)
    : reach_(reach) {
  while (levels > 0 && (std::min(luma.cols, luma.rows) >> levels) < 4) --levels;
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(luma, levels, bands);
  for (int level = 0; level < levels; ++level) {
    power_.push_back(power_of(bands[level], level));
    if (where.empty()) continue;
    cv::Mat counts;
    cv::resize(where, counts, power_.back().size(), 0, 0, cv::INTER_AREA);
    cv::multiply(power_.back(), counts, power_.back());
  }
}

void BandContrast::take_share(cv::Mat& detail, std::span<const double> shares, double max_gain,
                              double noise) const {
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(detail, levels(), bands);
  for (int level = 0; level < levels(); ++level) {
    cv::Mat gain = power_of(bands[level], level), wide;
    const double share = static_cast<std::size_t>(level) < shares.size() ? shares[level] : shares.back();
    for (int y = 0; y < gain.rows; ++y) {
      auto* to = gain.ptr<float>(y);
      const auto* wanted = power_[level].ptr<float>(y);
      for (int x = 0; x < gain.cols; ++x)
        to[x] =
            static_cast<float>(std::min(max_gain, std::sqrt(share * wanted[x] / (to[x] + noise * noise))));
    }
    cv::resize(gain, wide, bands[level].size(), 0, 0, cv::INTER_LINEAR);
    cv::multiply(bands[level], wide, bands[level]);
  }
  bands.back().setTo(0);
  detail = vision::collapse(bands);
}

}  // namespace freshet::synth::animate
