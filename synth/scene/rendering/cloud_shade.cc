#include "synth/scene/rendering/cloud_shade.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "platform/random.h"
#include "synth/scene/motion/cloud_drift.h"

namespace freshet::synth::scene {
namespace {

constexpr int kNoiseSide = 256;        // samples; a power of 2
constexpr double kShadowSamples = 32;  // that a shadow is wide
constexpr double kRagged = 0.2;        // amplitude of details a third as wide
// Of the noise, where a rim begins and ends: two fifths exceed its middle.
constexpr float kLightest = -0.25f, kDarkest = 0.75f;
// Of the picture's height, that a shadow is high: unseen, wholly seen. Lower ones are streaks across all that stands.
constexpr double kLow = 0.02, kHigh = 0.08;
constexpr int kNodes = 480;  // along the longer side

/// Smooth and periodic noise; mean 0, variance 1. sigma   samples.
cv::Mat smooth_noise(std::uint64_t seed, std::uint64_t stream, double sigma) {
  cv::Mat noise(kNoiseSide, kNoiseSide, CV_32F), wide;
  const Random random(seed, stream);
  for (std::size_t i = 0; i < noise.total(); ++i) noise.ptr<float>()[i] = random.at(i);
  const int around = cvCeil(4 * sigma);
  cv::copyMakeBorder(noise, wide, around, around, around, around, cv::BORDER_WRAP);
  cv::GaussianBlur(wide, wide, {}, sigma, sigma);
  noise = wide(cv::Rect(around, around, kNoiseSide, kNoiseSide)).clone();
  cv::Scalar mean, deviation;
  cv::meanStdDev(noise, mean, deviation);
  return (noise - mean[0]) / deviation[0];
}

float sampled(const cv::Mat& noise, float x, float y) {
  const float left = std::floor(x), top = std::floor(y);
  constexpr int kMask = kNoiseSide - 1;
  const int i = static_cast<int>(left) & kMask, k = static_cast<int>(top) & kMask;
  const auto *a = noise.ptr<float>(k), *b = noise.ptr<float>((k + 1) & kMask);
  const int next = (i + 1) & kMask;
  const float u = x - left, v = y - top;
  const float above = a[i] + (a[next] - a[i]) * u, below = b[i] + (b[next] - b[i]) * u;
  return above + (below - above) * v;
}

/// A camera one pixel of whose last row is 1 m wide.
WaterCamera camera_over(const Line& horizon, cv::Size picture) {
  const double focal = WaterMotion().focal_or_usual(picture);
  const WaterCamera low(horizon, focal, 1, picture);
  const double below = low.rolled(picture.width / 2.0 - 0.5, picture.height - 0.5).y;
  return {horizon, focal, 1 / low.row(below).scale, picture};
}

}  // namespace

CloudShade::CloudShade(const CloudMotion& clouds, const Line& horizon, const Weather& weather,
                       const Cycle& cycle, bool loop, std::uint64_t seed, cv::Size picture)
    : darkness_(clouds.shade),
      size_px_(clouds.shade_size * picture.width),
      loop_(loop),
      cycle_(cycle),
      picture_(picture),
      camera_(camera_over(horizon, picture)) {
  const double per_px = kShadowSamples / size_px_;
  for (const cv::Point2d& px : way_over_ground(clouds, weather, cycle, picture.width))
    gone_.push_back(px * per_px);
  noise_ = smooth_noise(seed, 51, kShadowSamples / 4) + kRagged * smooth_noise(seed, 52, kShadowSamples / 12);
  noise_ /= std::sqrt(1 + kRagged * kRagged);
  cv::Mat other(noise_.size(), CV_32F);
  const cv::Point2d apart(std::fmod(gone_.back().x, kNoiseSide), std::fmod(gone_.back().y, kNoiseSide));
  for (int y = 0; y < kNoiseSide; ++y)
    for (int x = 0; x < kNoiseSide; ++x)
      other.at<float>(y, x) =
          sampled(noise_, static_cast<float>(x + apart.x), static_cast<float>(y + apart.y));
  likeness_ = static_cast<float>(noise_.dot(other) / static_cast<double>(noise_.total()));
  const double step = std::max(1.0, std::max(picture.width, picture.height) / static_cast<double>(kNodes));
  const cv::Size nodes(cvCeil(picture.width / step), cvCeil(picture.height / step));
  ground_.create(nodes, CV_32FC3);
  nodes_.create(nodes, CV_32F);
  for (int r = 0; r < nodes.height; ++r)
    for (int c = 0; c < nodes.width; ++c)
      ground_.at<cv::Vec3f>(r, c) = ground((c + 0.5) * picture.width / nodes.width - 0.5,
                                           (r + 0.5) * picture.height / nodes.height - 0.5);
  go_to(0);
}

cv::Vec3f CloudShade::ground(double x, double y) const {
  const cv::Point2d at = camera_.rolled(x, y);
  if (at.y < camera_.horizon() + 0.5) return {0, 0, 0};
  const WaterCamera::Row row = camera_.row(at.y);
  const double per_px = kShadowSamples / size_px_;
  const double seen = std::clamp((size_px_ / row.deep / picture_.height - kLow) / (kHigh - kLow), 0.0, 1.0);
  if (seen == 0) return {0, 0, 0};
  return {static_cast<float>(at.x * row.scale * per_px), static_cast<float>(row.forward * per_px),
          static_cast<float>(seen)};
}

void CloudShade::go_to(int frame) {
  const int place = cycle_.place(frame);
  const auto at = [&](cv::Point2d gone) {
    // The noise comes again: a float keeps fractions of what is small.
    return cv::Vec2f(static_cast<float>(std::fmod(gone.x, kNoiseSide)),
                     static_cast<float>(std::fmod(gone.y, kNoiseSide)));
  };
  at_[0] = at(gone_[static_cast<std::size_t>(place)]);
  at_[1] = at(gone_[static_cast<std::size_t>(place)] - gone_.back());
  second_ = loop_ ? static_cast<float>(place) / static_cast<float>(cycle_.frames) : 0;
  const float first = 1 - second_;
  gain_ = 1 / std::sqrt(std::max(0.01f, first * first + second_ * second_ + 2 * first * second_ * likeness_));
}

float CloudShade::light_on(const cv::Vec3f& ground) const {
  if (ground[2] == 0) return 1;
  float cover = sampled(noise_, ground[0] - at_[0][0], ground[1] - at_[0][1]);
  if (second_ > 0) {
    const float other = sampled(noise_, ground[0] - at_[1][0], ground[1] - at_[1][1]);
    cover = (cover + (other - cover) * second_) * gain_;
  }
  const float t = std::clamp((cover - kLightest) / (kDarkest - kLightest), 0.0f, 1.0f);
  return 1 - static_cast<float>(darkness_) * ground[2] * t * t * (3 - 2 * t);
}

void CloudShade::light(cv::Mat& out) {
  using oneapi::tbb::blocked_range;
  oneapi::tbb::parallel_for(blocked_range<int>(0, nodes_.rows, 16), [&](const blocked_range<int>& rows) {
    for (int r = rows.begin(); r < rows.end(); ++r) {
      const auto* from = ground_.ptr<cv::Vec3f>(r);
      auto* to = nodes_.ptr<float>(r);
      for (int c = 0; c < nodes_.cols; ++c) to[c] = light_on(from[c]);
    }
  });
  cv::resize(nodes_, out, picture_, 0, 0, cv::INTER_LINEAR);
}

float CloudShade::light_at(cv::Point2d foot) const { return light_on(ground(foot.x - 0.5, foot.y - 0.5)); }

}  // namespace freshet::synth::scene
