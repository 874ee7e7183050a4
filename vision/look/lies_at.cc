#include "vision/look/lies_at.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "vision/look/lab_colours.h"

namespace freshet::vision {
namespace {

// What a step of a px costs. Any of these may be halved or doubled: of what stands in the pictures that they were set
// by, as much is found within two percent.
constexpr float kStep = .3f, kStepOutside = .1f;
constexpr float kOfGradient = .3f;   // Lab a px
constexpr float kOfDeparture = .1f;  // Lab from the click's colour
constexpr float kOfFluid = .2f;      // log of how much more frequent a colour is in the fluid, from
constexpr float kStanding = 2;       // this, which is beside it, up to
constexpr float kMostFluid = 6;

constexpr double kLargestHole = .125;  // of what is taken

constexpr std::uint8_t kUnseen = 255;

cv::Mat gradient_of(const cv::Mat& lab) {
  cv::Mat x, y, sum;
  cv::Sobel(lab, x, CV_32F, 1, 0, 3, 1 / 8.);
  cv::Sobel(lab, y, CV_32F, 0, 1, 3, 1 / 8.);
  cv::transform(x.mul(x) + y.mul(y), sum, cv::Matx13f(1, 1, 1));
  cv::sqrt(sum, sum);
  return sum;
}

/// Mean of 3 x 3 px.
cv::Vec3f colour_at(const cv::Mat& lab, cv::Point at) {
  const cv::Rect near = cv::Rect(at.x - 1, at.y - 1, 3, 3) & cv::Rect({}, lab.size());
  const cv::Scalar mean = cv::mean(lab(near));
  return {static_cast<float>(mean[0]), static_cast<float>(mean[1]), static_cast<float>(mean[2])};
}

cv::Point scaled(cv::Point at, cv::Size from, cv::Size to) {
  return {std::clamp(static_cast<int>((at.x + .5) * to.width / from.width), 0, to.width - 1),
          std::clamp(static_cast<int>((at.y + .5) * to.height / from.height), 0, to.height - 1)};
}

/// Those that are small beside it: a rim that goes all around the fluid does not take the fluid.
void fill_holes(cv::Mat& taken) {
  const double largest = kLargestHole * cv::countNonZero(taken);
  std::vector<std::vector<cv::Point>> outlines;
  std::vector<cv::Vec4i> tree;
  cv::findContours(taken, outlines, tree, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  for (std::size_t i = 0; i < outlines.size(); ++i)
    if (tree[i][3] >= 0 && cv::contourArea(outlines[i]) <= largest)
      cv::drawContours(taken, outlines, static_cast<int>(i), 255, cv::FILLED);
}

}  // namespace

cv::Mat what_lies_at(const cv::Mat& picture, const cv::Mat& matte, const cv::Mat& held, cv::Point at,
                     std::span<const cv::Point> others, double takes) {
  assert(picture.type() == CV_8UC3 && matte.size() == picture.size() && held.size() == picture.size());
  assert(cv::Rect({}, picture.size()).contains(at) && takes > 0);
  const cv::Mat inside = worked_matte(matte);
  const cv::Size size = inside.size();
  cv::Mat small, held_back;
  cv::resize(picture, small, size, 0, 0, cv::INTER_AREA);
  cv::resize(held, held_back, size, 0, 0, cv::INTER_AREA);
  held_back = (held_back > 127) & inside;
  const cv::Point first = scaled(at, picture.size(), size);
  if (!inside.at<std::uint8_t>(first)) return cv::Mat::zeros(picture.size(), CV_8U);
  const bool lets_go = held_back.at<std::uint8_t>(first) != 0;
  const cv::Mat grounds = lets_go ? held_back : inside & ~held_back;

  const cv::Mat lab = gaussian(lab_of(small), 1), gradient = gradient_of(lab),
                ratio = gaussian(log_ratio_beside(lab, inside), 2);
  std::vector<std::pair<int, cv::Vec3f>> seeds;  // where, its colour; the click's own first
  const auto add_seed = [&](cv::Point seed) {
    if (grounds.at<std::uint8_t>(seed) && seeds.size() < kUnseen)
      seeds.emplace_back(seed.y * size.width + seed.x, colour_at(lab, seed));
  };
  add_seed(first);
  for (const cv::Point& other : others) add_seed(scaled(other, picture.size(), size));

  // All seeds spread at the same pace; each pixel is the first one's to arrive.
  using Arrival = std::pair<float, int>;
  std::vector<Arrival> storage;
  storage.reserve(4 * size.area());
  std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> queue(std::greater<>{},
                                                                           std::move(storage));
  cv::Mat nearest(size, CV_32F, cv::Scalar(std::numeric_limits<float>::max())),
      whose(size, CV_8U, cv::Scalar(kUnseen)), done = cv::Mat::zeros(size, CV_8U),
                                               taken = cv::Mat::zeros(size, CV_8U);
  for (std::size_t i = seeds.size(); i-- > 0;) {
    nearest.ptr<float>()[seeds[i].first] = 0;
    whose.ptr()[seeds[i].first] = static_cast<std::uint8_t>(i);
    queue.emplace(0, seeds[i].first);
  }
  auto left = static_cast<int>(std::max(1., takes * cv::countNonZero(inside)));
  while (!queue.empty() && left > 0) {
    const auto [distance, here] = queue.top();
    queue.pop();
    if (std::exchange(done.ptr()[here], 1)) continue;
    const int x = here % size.width, y = here / size.width;
    const std::uint8_t of = whose.ptr()[here];
    if (of == 0 && grounds.ptr()[here]) {
      taken.ptr()[here] = 255;
      --left;
    }
    for (int side = 0; side < 9; ++side) {
      const int dx = side % 3 - 1, dy = side / 3 - 1;
      if (x + dx < 0 || y + dy < 0 || x + dx >= size.width || y + dy >= size.height) continue;
      const int next = here + dy * size.width + dx;
      if (done.ptr()[next]) continue;
      float step = kStepOutside;
      if (grounds.ptr()[next]) {
        const float fluid = std::clamp(kStanding - ratio.ptr<float>()[next], 0.f, kMostFluid);
        const auto departure = static_cast<float>(cv::norm(lab.ptr<cv::Vec3f>()[next] - seeds[of].second));
        step =
            kStep + kOfGradient * gradient.ptr<float>()[next] + kOfDeparture * departure + kOfFluid * fluid;
      } else if (lets_go) {
        continue;
      }
      if (dx != 0 && dy != 0) step *= std::numbers::sqrt2_v<float>;
      if (distance + step >= nearest.ptr<float>()[next]) continue;
      nearest.ptr<float>()[next] = distance + step;
      whose.ptr()[next] = of;
      queue.emplace(distance + step, next);
    }
  }
  cv::medianBlur(taken, taken, 3);
  taken.ptr()[seeds[0].first] = 255;
  fill_holes(taken);
  taken &= grounds;
  cv::resize(taken, taken, picture.size(), 0, 0, cv::INTER_LINEAR);
  return taken > 127;
}

cv::Point innermost(const cv::Mat& area) {
  cv::Mat framed, distance;
  cv::copyMakeBorder(area, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT | cv::BORDER_ISOLATED, 0);
  cv::distanceTransform(framed, distance, cv::DIST_L2, 5);
  cv::Point farthest;
  cv::minMaxLoc(distance, nullptr, nullptr, nullptr, &farthest);
  return farthest - cv::Point(1, 1);
}

}  // namespace freshet::vision
