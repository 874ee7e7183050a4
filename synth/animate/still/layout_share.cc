#include "synth/animate/still/layout_share.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"
#include "synth/sampling/widened_rows.h"
#include "vision/dot.h"
#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

constexpr int kCell = 8;          // samples of a level, in which powers are compared
constexpr double kCellReach = 1;  // sigma, cells
constexpr double kLeastGain = 0.6, kMostGain = 1.3;
constexpr float kFaint = 1e-6f;  // luma squared

cv::Mat power_of(const cv::Mat& squares) {
  cv::Mat cells;
  cv::resize(squares, cells, {(squares.cols + kCell - 1) / kCell, (squares.rows + kCell - 1) / kCell}, 0, 0,
             cv::INTER_AREA);
  cv::GaussianBlur(cells, cells, {}, kCellReach, kCellReach, cv::BORDER_REPLICATE);
  return cells;
}

FRESHET_WIDE void mix_rest(sampling::WidenedRows::Row shares, const float* other, int n, float* band) {
  for (int x = 0; x < n; ++x) band[x] += shares.at(x) * (other[x] - band[x]);
}

/// wanted: what the powers of both make together; found: the square of what they are mixed to.
FRESHET_WIDE void mix_bands(sampling::WidenedRows::Row shares, const float* stands, const float* other, int n,
                            float* band, float* wanted, float* found) {
#pragma GCC ivdep
  for (int x = 0; x < n; ++x) {
    const float share = shares.at(x), left = 1 - share, own = band[x], texture = other[x];
    const float least = share < 0.0f ? 0.0f : share, most = left < 0.0f ? 0.0f : left;
    wanted[x] = own * own * left + texture * texture * share;
    const float mixed = std::sqrt(most) * own + share * stands[x] + std::sqrt(least) * (texture - stands[x]);
    found[x] = mixed * mixed;
    band[x] = mixed;
  }
}

FRESHET_WIDE void amplify(sampling::WidenedRows::Row gains, int n, float* band) {
  for (int x = 0; x < n; ++x) band[x] *= gains.at(x);
}

}  // namespace

LayoutShare::LayoutShare(std::vector<cv::Mat> by_level, const cv::Mat& matte)
    : least_(1), most_(0), mean_(0), by_level_(std::move(by_level)) {
  cv::Mat within;
  cv::resize(matte, within, by_level_.front().size(), 0, 0, cv::INTER_AREA);
  const double all = std::max(cv::sum(within)[0], 1e-6);
  for (const cv::Mat& share : by_level_) {
    double least = 0, most = 0;
    cv::minMaxLoc(share, &least, &most, nullptr, nullptr, within > 0);
    least_ = std::min(least_, least);
    most_ = std::max(most_, most);
    mean_ += vision::dot(share, within) / all / static_cast<double>(by_level_.size());
  }
}

cv::Mat LayoutShare::over_picture(cv::Size size) const {
  cv::Mat sum = cv::Mat::zeros(by_level_.front().size(), CV_32F), out;
  for (const cv::Mat& share : by_level_) sum += share / static_cast<double>(by_level_.size());
  cv::resize(sum, out, size, 0, 0, cv::INTER_LINEAR);
  return out;
}

void LayoutShare::mix(const cv::Mat& laid, const StandingLayout& layout, cv::Mat& goes) const {
  std::vector<cv::Mat> bands, texture;
  vision::laplacian_pyramid(goes, layout.levels(), bands);
  vision::laplacian_pyramid(laid, layout.levels(), texture);
  for (int level = 0; level <= layout.levels(); ++level) {
    cv::Mat &band = bands[static_cast<std::size_t>(level)], &other = texture[static_cast<std::size_t>(level)];
    const auto known = std::min(static_cast<std::size_t>(level), by_level_.size() - 1);
    sampling::WidenedRows shares(by_level_[known], band.size());
    if (level == layout.levels()) {
      for (int y = 0; y < band.rows; ++y)
        mix_rest(shares.at(y), other.ptr<float>(y), band.cols, band.ptr<float>(y));
      continue;
    }
    cv::Mat wanted(band.size(), CV_32F), gain;
    for (int y = 0; y < band.rows; ++y)
      mix_bands(shares.at(y), layout.stands(level).ptr<float>(y), other.ptr<float>(y), band.cols,
                band.ptr<float>(y), wanted.ptr<float>(y), other.ptr<float>(y));
    cv::sqrt((power_of(wanted) + kFaint) / (power_of(other) + kFaint), gain);
    gain = cv::min(cv::max(gain, kLeastGain), kMostGain);
    sampling::WidenedRows gains(gain, band.size());
    for (int y = 0; y < band.rows; ++y) amplify(gains.at(y), band.cols, band.ptr<float>(y));
  }
  goes = vision::collapse(std::move(bands));
}

}  // namespace freshet::synth::animate
