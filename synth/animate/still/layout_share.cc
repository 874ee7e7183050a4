#include "synth/animate/still/layout_share.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <opencv2/imgproc.hpp>

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
    cv::Mat share, left, root;
    cv::resize(by_level_[known], share, band.size(), 0, 0, cv::INTER_LINEAR);
    if (level == layout.levels()) {
      band += share.mul(other - band);
      continue;
    }
    cv::sqrt(cv::max(1 - share, 0), left);
    cv::sqrt(cv::max(share, 0), root);
    const cv::Mat& stands = layout.stands(level);
    const cv::Mat wanted = power_of(band.mul(band).mul(1 - share) + other.mul(other).mul(share));
    band = left.mul(band) + share.mul(stands) + root.mul(other - stands);
    cv::Mat gain;
    cv::sqrt((wanted + kFaint) / (power_of(band.mul(band)) + kFaint), gain);
    cv::resize(cv::min(cv::max(gain, kLeastGain), kMostGain), gain, band.size(), 0, 0, cv::INTER_LINEAR);
    band = band.mul(gain);
  }
  goes = vision::collapse(std::move(bands));
}

}  // namespace freshet::synth::animate
