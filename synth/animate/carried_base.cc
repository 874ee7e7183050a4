#include "synth/animate/carried_base.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace freshet::synth {
namespace {

constexpr int kCopies = 3;
constexpr double kLeastDepth = 0.02;
constexpr int kMostMaps = 96;
constexpr int kStep = 4;  // px of the picture a sample of the displacement

// How far to where the fluid at each place was (or will be) one step of `dt` seconds further on: mid-point
// rule along the steady field. From displacements for some age to those for the next.
cv::Mat step_on(const cv::Mat& displacement, const cv::Mat& velocity, float dt) {
  cv::Mat where(displacement.size(), CV_32FC2), further;
  for (int y = 0; y < where.rows; ++y)
    for (int x = 0; x < where.cols; ++x) {
      const cv::Vec2f& d = displacement.at<cv::Vec2f>(y, x);
      where.at<cv::Vec2f>(y, x) = {static_cast<float>(x) + d[0] / kStep,
                                   static_cast<float>(y) + d[1] / kStep};
    }
  cv::remap(velocity, further, where, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::Mat middle = displacement + further * (dt / 2);
  for (int y = 0; y < where.rows; ++y)
    for (int x = 0; x < where.cols; ++x) {
      const cv::Vec2f& d = middle.at<cv::Vec2f>(y, x);
      where.at<cv::Vec2f>(y, x) = {static_cast<float>(x) + d[0] / kStep,
                                   static_cast<float>(y) + d[1] / kStep};
    }
  cv::remap(velocity, further, where, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return displacement + further * dt;
}

// The divisor of `whole` nearest to `wanted`, on a scale of ratios, and not below half of it: copies that
// hardly live jitter in their places. `whole` itself is one.
int nearest_divisor(int whole, int wanted) {
  int best = whole;
  const auto distance = [&](int part) { return std::abs(std::log(static_cast<double>(part) / wanted)); };
  for (int part = (wanted + 1) / 2; part <= whole; ++part)
    if (whole % part == 0 && distance(part) < distance(best)) best = part;
  return best;
}

}  // namespace

CarriedBase::CarriedBase(const cv::Mat& picture, const cv::Mat& luma, const cv::Mat& matte,
                         const cv::Mat& exposure, const cv::Mat& motion, double fps,
                         const CarriedBaseOptions& options)
    : exposure_(exposure), size_(picture.size()) {
  // Copies fade towards the matte's edge and the picture's: carried on, an edge would go through the fluid as
  // a line.
  cv::Mat inside, depth;
  cv::copyMakeBorder(matte > 0.5, inside, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::distanceTransform(inside, depth, cv::DIST_L2, cv::DIST_MASK_5);
  depth = depth(cv::Rect({1, 1}, size_)) / std::max(options.edge_px, 1.0);
  const cv::Mat weight = matte.mul(cv::min(cv::max(depth, kLeastDepth), 1.0));
  std::array<cv::Mat, 3> bgr;
  cv::split(picture, bgr.data());
  cv::merge(std::vector<cv::Mat>{luma.mul(weight), (bgr[0] - luma).mul(weight), (bgr[2] - luma).mul(weight),
                                 weight},
            fluid_);

  // What is shown repeats after a third of a life, when each copy has come to the next one's age: a loop
  // holds whole thirds.
  int third = std::max(1, static_cast<int>(std::lround(options.life_s * fps / kCopies)));
  if (options.loop_frames > 0) third = nearest_divisor(options.loop_frames, third);
  const int life = life_ = kCopies * third;

  // Where the fluid would be carried too far, the share of what is carried falls off.
  share_ = cv::Mat::zeros(size_, CV_32F);
  const double reach_s = life / fps / 2;
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < size_.width && life > 0; ++x) {
      const cv::Vec2f& v = motion.at<cv::Vec2f>(y, x);
      const double reach = std::hypot(v[0], v[1]) * reach_s;
      share_.at<float>(y, x) =
          static_cast<float>(options.share * std::clamp(2 - reach / options.max_px, 0.0, 1.0));
    }
  if (life == 0) return;

  cv::Mat velocity;
  const cv::Size coarse((size_.width + kStep - 1) / kStep, (size_.height + kStep - 1) / kStep);
  cv::resize(motion, velocity, coarse, 0, 0, cv::INTER_AREA);
  // Before its time a copy shows what is yet to come. Long lives are sampled, and interpolated between.
  stride_ = life / kMostMaps + 1;
  const auto dt = static_cast<float>(stride_ / fps);
  const int steps = (life - life / 2) / stride_ + 2;
  past_.push_back(cv::Mat::zeros(coarse, CV_32FC2));
  future_.push_back(past_.front());
  for (int i = 1; i < steps; ++i) {
    past_.push_back(step_on(past_.back(), velocity, -dt));
    future_.push_back(step_on(future_.back(), velocity, dt));
  }
}

cv::Mat CarriedBase::frame(int i, cv::Mat* colour) const {
  if (colour) *colour = cv::Mat::zeros(size_, CV_32FC4);
  if (life_ == 0) return exposure_.clone();
  const int life = life_, third = life / kCopies;
  i %= third;
  cv::Mat sum = cv::Mat::zeros(size_, CV_32FC4), coarse, displacement, where(size_, CV_32FC2), carried;
  for (int copy = 0; copy < kCopies; ++copy) {
    const int age = (i + copy * third + life / 2) % life - life / 2;  // frames from its own time
    const double weight = (1 + std::cos(2 * std::numbers::pi * age / static_cast<double>(life))) / kCopies;
    const std::vector<cv::Mat>& maps = age >= 0 ? past_ : future_;
    const int map = std::abs(age) / stride_;
    const double part = static_cast<double>(std::abs(age) % stride_) / stride_;
    cv::addWeighted(maps[map], 1 - part, maps[map + 1], part, 0, coarse);
    cv::resize(coarse, displacement, {}, kStep, kStep, cv::INTER_LINEAR);
    for (int y = 0; y < size_.height; ++y) {
      const cv::Vec2f* d = displacement.ptr<cv::Vec2f>(y);
      cv::Vec2f* w = where.ptr<cv::Vec2f>(y);
      for (int x = 0; x < size_.width; ++x)
        w[x] = {static_cast<float>(x) + d[x][0], static_cast<float>(y) + d[x][1]};
    }
    cv::remap(fluid_, carried, where, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_CONSTANT);
    cv::scaleAdd(carried, weight, sum, sum);
  }
  cv::Mat out(size_, CV_32F);
  for (int y = 0; y < size_.height; ++y) {
    const cv::Vec4f* s = sum.ptr<cv::Vec4f>(y);
    const float* still = exposure_.ptr<float>(y);
    const float* share = share_.ptr<float>(y);
    const cv::Vec4f* own = fluid_.ptr<cv::Vec4f>(y);
    float* to = out.ptr<float>(y);
    cv::Vec4f* carried_colour = colour ? colour->ptr<cv::Vec4f>(y) : nullptr;
    for (int x = 0; x < size_.width; ++x) {
      // What is brought is fluid as far as this place itself is.
      const float brought = own[x][3] > 1e-3f ? std::clamp(s[x][3] / own[x][3], 0.0f, 1.0f) : 0.0f;
      const float part = share[x] * brought, whole = 1 / std::max(s[x][3], 1e-3f);
      to[x] = part > 0 ? still[x] + part * (s[x][0] * whole - still[x]) : still[x];
      if (carried_colour) carried_colour[x] = {s[x][0] * whole, s[x][1] * whole, s[x][2] * whole, part};
    }
  }
  return out;
}

}  // namespace freshet::synth
