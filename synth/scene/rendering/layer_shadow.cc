#include "synth/scene/rendering/layer_shadow.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::scene {
namespace {

constexpr double kUsualSoftness = 0.05;  // of the shadow's length
constexpr double kMostSoftness = 500;    // px, as the key's range
constexpr float kLeast = 0.05f;  // of light in the still's shadow: what is darker cannot be divided out
constexpr int kMostReduced = 8;

}  // namespace

LayerShadow::LayerShadow(const SceneLayer& layer, const cv::Mat& alpha, const cv::Rect& box, cv::Size picture)
    : darkness_(layer.shadow_darkness) {
  const Line& line = *layer.shadow;
  const cv::Point2d foot = line.from, falls = line.to - line.from;
  const double tall = foot.y - box.y;  // px
  softness_px_ = layer.shadow_softness_px.value_or(
      std::min(kMostSoftness, kUsualSoftness * std::hypot(falls.x, falls.y)));
  reduced_ = std::clamp(static_cast<int>(softness_px_ / 2), 1, kMostReduced);
  const cv::Rect all({}, picture);
  source_ = around(box, picture);
  source_.height = std::min(source_.height, cvCeil(foot.y) - source_.y);
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const int y : {source_.y, source_.br().y}) {
    const double up = (foot.y - y) / tall, x = up * falls.x;
    left = std::min(left, source_.x + x), right = std::max(right, source_.br().x + x);
    top = std::min(top, foot.y + up * falls.y), bottom = std::max(bottom, foot.y + up * falls.y);
  }
  constexpr double kFar = 1e8;  // px: what lies further is not in the picture either
  for (double* const side : {&left, &right, &top, &bottom}) *side = std::clamp(*side, -kFar, kFar);
  const int soft = cvCeil(3 * softness_px_) + reduced_;
  region_ = cv::Rect(cv::Point(cvFloor(left) - soft, cvFloor(top) - soft),
                     cv::Point(cvCeil(right) + soft, cvCeil(bottom) + soft)) &
            all;
  if (region_.empty()) return;
  // The source is reduced as much as the shadow shows it smaller.
  const double upwards = tall / falls.y;  // px of the layer, for a px down in the picture
  reduced_source_ = {std::max(1, source_.width / reduced_),
                     std::max(1, cvRound(source_.height / std::max(1.0, reduced_ * std::abs(upwards))))};
  const double across = 1.0 * reduced_source_.width / source_.width,
               up = 1.0 * reduced_source_.height / source_.height;
  // From the middle of a reduced pixel to the picture, along the shadow to the layer, and to its reduced source.
  const double lean = falls.x / falls.y;
  const cv::Point2d first(region_.x + 0.5 * reduced_, region_.y + 0.5 * reduced_);
  source_from_region_ = {across * reduced_,
                         -across * reduced_ * lean,
                         across * (first.x - (first.y - foot.y) * lean - source_.x) - 0.5,
                         0,
                         -up * reduced_ * upwards,
                         up * (foot.y - (first.y - foot.y) * upwards - source_.y) - 0.5};
  if (alpha.empty()) return;
  lay(alpha(source_), shadow_);
  before_ = cv::max(1 - darkness_ * shadow_, kLeast);
}

void LayerShadow::lay(const cv::Mat& alpha, cv::Mat& shadow) {
  cv::resize(alpha, smaller_, reduced_source_, 0, 0, cv::INTER_AREA);
  const cv::Size size((region_.width + reduced_ - 1) / reduced_, (region_.height + reduced_ - 1) / reduced_);
  cv::warpAffine(smaller_, shadow, source_from_region_, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_CONSTANT, 0);
  const double sigma = softness_px_ / reduced_;
  if (sigma > 0) cv::GaussianBlur(shadow, shadow, {}, sigma, sigma, cv::BORDER_CONSTANT);
}

void LayerShadow::cast(const cv::Mat& alone, cv::Mat& light) {
  if (region_.empty()) return;
  cv::extractChannel(alone(source_), alpha_, 3);
  lay(alpha_, shadow_);
  shadow_.convertTo(shadow_, CV_32F, -darkness_, 1);
  if (!before_.empty()) {
    cv::max(shadow_, kLeast, shadow_);
    cv::divide(shadow_, before_, shadow_);
  }
  // Of whole reduced pixels, which the region ends within.
  cv::resize(shadow_, whole_, {shadow_.cols * reduced_, shadow_.rows * reduced_}, 0, 0, cv::INTER_LINEAR);
  cv::Mat shaded = light(region_);
  cv::multiply(shaded, whole_(cv::Rect({}, region_.size())), shaded);
}

}  // namespace freshet::synth::scene
