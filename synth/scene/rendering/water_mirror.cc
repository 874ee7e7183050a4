#include "synth/scene/rendering/water_mirror.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::scene {
namespace {

constexpr float kStands = 0.9f;  // alpha of what is measured
constexpr double kFits = 0.06;   // of 1: error at which a fit begins to fail
constexpr double kAroundPx = 3;  // deviation over which errors are averaged
constexpr int kFittings = 3;

/// p -> at + 2 ((p - at) . way) way - (p - at), and from samples of the texture to those of the picture.
cv::Matx23d reflection(const Line& horizon, cv::Point first) {
  const cv::Point2d along = horizon.to - horizon.from;
  const cv::Point2d way = along * (1 / std::hypot(along.x, along.y));
  const double a = 2 * way.x * way.x - 1, b = 2 * way.x * way.y, d = 2 * way.y * way.y - 1;
  const cv::Point2d from = cv::Point2d(first) + cv::Point2d(0.5, 0.5) - horizon.from;
  return {a, b, a * from.x + b * from.y + horizon.from.x - 0.5,
          b, d, b * from.x + d * from.y + horizon.from.y - 0.5};
}

/// The water's colours as offset + slope times what they mirror.
struct Fit {
  cv::Scalar slope, offset;
};

/// weight   CV_32F, of each sample.
Fit fit_of(const cv::Mat& own, const cv::Mat& mirrored, const cv::Mat& weight) {
  cv::Scalar x, y, xx, xy;
  double count = 0;
  for (int r = 0; r < own.rows; ++r) {
    const auto* w = weight.ptr<float>(r);
    const auto *water = own.ptr<cv::Vec4f>(r), *above = mirrored.ptr<cv::Vec4f>(r);
    for (int i = 0; i < own.cols; ++i) {
      count += w[i];
      for (int c = 0; c < 3; ++c) {
        x[c] += w[i] * above[i][c], y[c] += w[i] * water[i][c];
        xx[c] += w[i] * above[i][c] * above[i][c], xy[c] += w[i] * above[i][c] * water[i][c];
      }
    }
  }
  Fit fit;
  for (int c = 0; c < 3 && count > 0; ++c) {
    const double variance = count * xx[c] - x[c] * x[c];
    fit.slope[c] = variance > 0 ? std::clamp((count * xy[c] - x[c] * y[c]) / variance, 0.0, 1.0) : 0;
    fit.offset[c] = (y[c] - fit.slope[c] * x[c]) / count;
  }
  return fit;
}

/// How well the fit holds around each sample, CV_32F, 0..1. measured   CV_8U: elsewhere nothing speaks against it.
cv::Mat agreement(const cv::Mat& own, const cv::Mat& mirrored, const cv::Mat& measured, const Fit& fit) {
  cv::Mat error(own.size(), CV_32F);
  for (int r = 0; r < own.rows; ++r) {
    const auto *water = own.ptr<cv::Vec4f>(r), *above = mirrored.ptr<cv::Vec4f>(r);
    for (int i = 0; i < own.cols; ++i) {
      double sum = 0;
      for (int c = 0; c < 3; ++c) sum += std::abs(water[i][c] - fit.offset[c] - fit.slope[c] * above[i][c]);
      error.at<float>(r, i) = static_cast<float>(sum / (3 * kFits));
    }
  }
  error.setTo(0, ~measured);
  cv::GaussianBlur(error, error, {}, kAroundPx, kAroundPx, cv::BORDER_REPLICATE);
  cv::exp(error.mul(error, -0.5), error);
  return error;
}

}  // namespace

WaterMirror::WaterMirror(const Sprite& water, const Line& horizon, const cv::Mat& unmoved)
    : to_picture_(reflection(horizon, water.box.tl() - cv::Point(Sprite::kBorder, Sprite::kBorder))),
      own_(water.texture.clone()) {
  mirror(unmoved, cv::BORDER_CONSTANT, mirrored_);
  cv::Mat stands, held, weight(own_.size(), CV_32F, cv::Scalar(0));
  constexpr int kBorder = Sprite::kBorder;
  cv::copyMakeBorder(water.held, held, kBorder, kBorder, kBorder, kBorder, cv::BORDER_CONSTANT, 0);
  cv::extractChannel(mirrored_, stands, 3);
  const cv::Mat measured = (stands > kStands) & (held > kStands);
  weight.setTo(1, measured);
  Fit fit;
  cv::Mat holds;
  for (int i = 0; i < kFittings; ++i) {
    fit = fit_of(own_, mirrored_, weight);
    holds = agreement(own_, mirrored_, measured, fit);
    holds.copyTo(weight, measured);
  }
  cv::cvtColor(holds, share_, cv::COLOR_GRAY2BGRA);
  fit.slope[3] = 0;
  cv::multiply(share_, fit.slope, share_);
  mirror(unmoved, cv::BORDER_REPLICATE, unmoved_);
}

void WaterMirror::mirror(const cv::Mat& picture, int beyond, cv::Mat& out) const {
  cv::warpAffine(picture, out, to_picture_, own_.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, beyond);
}

void WaterMirror::reflect(const cv::Mat& moved, Sprite& water) {
  mirror(moved, cv::BORDER_REPLICATE, mirrored_);
  using oneapi::tbb::blocked_range;
  oneapi::tbb::parallel_for(blocked_range<int>(0, own_.rows, 16), [&](const blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) {
      const auto *own = own_.ptr<cv::Vec4f>(y), *before = unmoved_.ptr<cv::Vec4f>(y),
                 *now = mirrored_.ptr<cv::Vec4f>(y), *share = share_.ptr<cv::Vec4f>(y);
      auto* out = water.texture.ptr<cv::Vec4f>(y);
      for (int x = 0; x < own_.cols; ++x)
        for (int c = 0; c < 4; ++c)
          out[x][c] = std::clamp(own[x][c] + share[x][c] * (now[x][c] - before[x][c]), 0.0f, 1.0f);
    }
  });
}

}  // namespace freshet::synth::scene
