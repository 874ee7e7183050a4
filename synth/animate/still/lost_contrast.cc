#include "synth/animate/still/lost_contrast.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

/// Squared distances between the sources of two copies, px.
cv::Mat squared_distances(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat out(a.size(), CV_32F);
  for (int y = 0; y < out.rows; ++y) {
    const auto *p = a.ptr<cv::Vec2f>(y), *q = b.ptr<cv::Vec2f>(y);
    auto* to = out.ptr<float>(y);
    for (int x = 0; x < out.cols; ++x) {
      const float u = p[x][0] - q[x][0], v = p[x][1] - q[x][1];
      to[x] = u * u + v * v;
    }
  }
  return out;
}

}  // namespace

void restore_contrast(cv::Mat& luma, std::span<const CopyMap> copies, int step,
                      std::span<const double> renewed, const cv::Mat& where,
                      const LostContrastOptions& options) {
  int levels = 0;
  while (levels < options.levels && (std::min(luma.cols, luma.rows) >> (levels + 1)) >= 4) ++levels;
  struct Pair {
    cv::Mat weight;  // 2 a_i a_j
    cv::Mat squared;
  };
  if (levels == 0 || copies.empty()) return;
  cv::Mat own = cv::Mat::zeros(copies.front().weight.size(), CV_32F);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < copies.size(); ++i) {
    cv::accumulateSquare(copies[i].weight, own);
    for (std::size_t j = i + 1; j < copies.size(); ++j) {
      const cv::Mat weight = copies[i].weight.mul(copies[j].weight, 2);
      double most = 0;
      cv::minMaxLoc(weight, nullptr, &most);
      if (most > 0) pairs.push_back({weight, squared_distances(copies[i].source, copies[j].source)});
    }
  }
  if (pairs.empty() && renewed.empty()) return;
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(luma, levels, bands);
  cv::Mat gain(copies.front().source.size(), CV_32F), wide;
  for (int level = 0; level < levels; ++level) {
    const auto at = static_cast<std::size_t>(level);
    const auto anew = static_cast<float>(at < renewed.size() ? renewed[at] : 0.0);
    const double agreement = options.agreement_px * (1 << level);
    const auto unit = static_cast<float>(1 / (2 * agreement * agreement));
    for (int y = 0; y < gain.rows; ++y) {
      auto* to = gain.ptr<float>(y);
      std::copy_n(own.ptr<float>(y), gain.cols, to);
      for (const Pair& pair : pairs) {
        const auto *squared = pair.squared.ptr<float>(y), *weight = pair.weight.ptr<float>(y);
        // 1 / (1 + q + q^2 / 2) in place of exp(-q).
        for (int x = 0; x < gain.cols; ++x) {
          const float q = squared[x] * unit;
          to[x] += weight[x] / (1 + q * (1 + 0.5f * q));
        }
      }
      const auto* place = where.empty() ? nullptr : where.ptr<float>(y);
      for (int x = 0; x < gain.cols; ++x) {
        const float kept = std::sqrt(1 - anew * (place ? place[x] : 1.0f));
        to[x] = kept * std::min(1 / std::sqrt(to[x]), static_cast<float>(options.max_gain));
      }
    }
    // Maps are sampled in the middles of squares of step px, as resize takes it.
    const cv::Size covered(gain.cols * step >> level, gain.rows * step >> level);
    cv::resize(gain, wide,
               {std::max(covered.width, bands[level].cols), std::max(covered.height, bands[level].rows)}, 0,
               0, cv::INTER_LINEAR);
    cv::multiply(bands[level], wide(cv::Rect({}, bands[level].size())), bands[level]);
  }
  luma = vision::collapse(bands);
}

}  // namespace freshet::synth::animate
