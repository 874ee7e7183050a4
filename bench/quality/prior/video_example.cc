#include "bench/quality/prior/video_example.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "bench/quality/prior/carried.h"
#include "synth/animate/still/appearance.h"
#include "synth/animate/still/base_image.h"
#include "synth/animate/still/colour_model.h"

namespace freshet::bench {
namespace {

constexpr int kSide = 32, kStride = kSide / 2, kSearchStep = 4;  // px, of squares that residuals come from
constexpr float kSlow = 0.1f;  // px a frame: below it nothing has a direction

// What a place of the example costs that squares near by have: copies side by side would be seen as a lattice.
constexpr float kAgain = 0.003f;

/// What two squares are compared by, and how they flow.
struct Look {
  float luma = 0, contrast = 0;
  cv::Vec2f flow;

  float speed() const { return std::hypot(flow[0], flow[1]); }
};
Look look_at(const cv::Mat& mean, const cv::Mat& contrast, const cv::Mat& flow, const cv::Rect& square) {
  const cv::Rect seen = square & cv::Rect({}, mean.size());
  const cv::Scalar moves = cv::mean(flow(seen));
  return {static_cast<float>(cv::mean(mean(seen))[0]), static_cast<float>(cv::mean(contrast(seen))[0]),
          cv::Vec2f(static_cast<float>(moves[0]), static_cast<float>(moves[1]))};
}
/// An octave of speed counts as 1/16 of white.
float unlike(const Look& a, const Look& b) {
  const float luma = a.luma - b.luma, contrast = a.contrast - b.contrast,
              octaves = std::log2((a.speed() + kSlow) / (b.speed() + kSlow)) / 16;
  return luma * luma + contrast * contrast + octaves * octaves;
}

bool near(cv::Point a, cv::Point b, int px) { return std::abs(a.x - b.x) < px && std::abs(a.y - b.y) < px; }

/// Where the pixels of a square of the still lie in the example, CV_32FC2.
struct Square {
  cv::Rect at;       // inside the still
  cv::Point source;  // upper left corner in the example
  cv::Mat from, weight;
};

std::vector<Square> squares_of(const cv::Mat& base, const cv::Mat& contrast, const cv::Mat& flow,
                               const VideoExample& example) {
  std::vector<std::pair<cv::Point, Look>> offered;
  for (int y = 0; y + kSide <= example.mean.rows; y += kSearchStep)
    for (int x = 0; x + kSide <= example.mean.cols; x += kSearchStep)
      offered.push_back(
          {{x, y}, look_at(example.mean, example.contrast, example.flow, {x, y, kSide, kSide})});
  CV_Assert(!offered.empty());
  std::vector<Square> squares;
  for (int top = -kStride; top < base.rows; top += kStride)
    for (int left = -kStride; left < base.cols; left += kStride) {
      const cv::Rect whole(left, top, kSide, kSide);
      Square square;
      square.at = whole & cv::Rect({}, base.size());
      const Look wanted = look_at(base, contrast, flow, square.at);
      std::vector<cv::Point> taken;
      for (const Square& other : squares)
        if (near(other.at.tl(), square.at.tl(), 2 * kSide)) taken.push_back(other.source);
      const auto* best = &offered[0];
      float least = std::numeric_limits<float>::infinity();
      for (const auto& one : offered) {
        float cost = unlike(wanted, one.second);
        for (const cv::Point& other : taken)
          if (near(other, one.first, kStride)) cost += kAgain;
        if (cost < least) least = cost, best = &one;
      }
      square.source = best->first;
      cv::Vec2f turn(1, 0);  // from the still's axes to the example's, as a complex number
      if (const cv::Vec2f theirs = best->second.flow, ours = wanted.flow;
          best->second.speed() > kSlow && wanted.speed() > kSlow) {
        turn =
            cv::Vec2f(theirs[0] * ours[0] + theirs[1] * ours[1], theirs[1] * ours[0] - theirs[0] * ours[1]);
        turn /= best->second.speed() * wanted.speed();
      }
      const cv::Point2f centre = cv::Point2f(best->first) + cv::Point2f(kSide / 2.0f, kSide / 2.0f);
      square.from.create(square.at.size(), CV_32FC2);
      square.weight.create(square.at.size(), CV_32F);
      for (int y = 0; y < square.at.height; ++y)
        for (int x = 0; x < square.at.width; ++x) {
          const float u = static_cast<float>(square.at.x + x - whole.x) + 0.5f - kSide / 2.0f,
                      v = static_cast<float>(square.at.y + y - whole.y) + 0.5f - kSide / 2.0f;
          square.from.at<cv::Vec2f>(y, x) = {centre.x - 0.5f + turn[0] * u - turn[1] * v,
                                             centre.y - 0.5f + turn[1] * u + turn[0] * v};
          square.weight.at<float>(y, x) =
              (1 - std::abs(u) / (kSide / 2.0f)) * (1 - std::abs(v) / (kSide / 2.0f));
        }
      squares.push_back(std::move(square));
    }
  return squares;
}

/// Residuals of one frame on the still. Weights over the root of the sum of their squares keep the variance.
cv::Mat laid(const cv::Mat& residual, const std::vector<Square>& squares, cv::Size size) {
  cv::Mat sum(size, CV_32F, cv::Scalar(0)), power(size, CV_32F, cv::Scalar(0));
  for (const Square& square : squares) {
    cv::Mat seen;
    cv::remap(residual, seen, square.from, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
    for (int y = 0; y < square.at.height; ++y)
      for (int x = 0; x < square.at.width; ++x) {
        const float weight = square.weight.at<float>(y, x);
        sum.at<float>(square.at.y + y, square.at.x + x) += weight * seen.at<float>(y, x);
        power.at<float>(square.at.y + y, square.at.x + x) += weight * weight;
      }
  }
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      sum.at<float>(y, x) /= std::sqrt(std::max(power.at<float>(y, x), 1e-6f));
  return sum;
}

cv::Mat luma_of_frame(const cv::Mat& bgr) {
  cv::Mat grey;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(grey, CV_32F, 1 / 255.0);
  return grey;
}

}  // namespace

VideoExample decompose(std::span<const cv::Mat> frames, const cv::Mat& flow) {
  CV_Assert(frames.size() >= 2);
  VideoExample example;
  cv::resize(flow, example.flow, frames[0].size(), 0, 0, cv::INTER_LINEAR);
  std::vector<cv::Mat> differences(frames.size()), before(frames.size());
  oneapi::tbb::parallel_for(std::size_t{0}, frames.size(),
                            [&](std::size_t t) { differences[t] = luma_of_frame(frames[t]); });
  example.mean = cv::Mat::zeros(frames[0].size(), CV_32F);
  for (const cv::Mat& luma : differences) example.mean += luma;
  example.mean /= static_cast<double>(frames.size());
  oneapi::tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t t) {
    differences[t] -= example.mean;
    before[t] = carried(differences[t], example.flow, cv::BORDER_CONSTANT);
  });
  double common = 0, power = 0;
  cv::Mat squares = cv::Mat::zeros(frames[0].size(), CV_32F);
  for (std::size_t t = 0; t < frames.size(); ++t) {
    squares += differences[t].mul(differences[t]);
    if (t == 0) continue;
    common += differences[t].dot(before[t - 1]);
    power += before[t - 1].dot(before[t - 1]);
  }
  cv::sqrt(squares / static_cast<double>(frames.size()), example.contrast);
  if (power > 0) example.kept = std::clamp(common / power, 0.0, 1.0);
  for (std::size_t t = 1; t < frames.size(); ++t)
    example.residuals.push_back(differences[t] - example.kept * before[t - 1]);
  return example;
}

std::vector<cv::Mat> animate_by_example(const cv::Mat& still, const cv::Mat& matte, const cv::Mat& motion,
                                        double fps, const VideoExample& example, int frames) {
  cv::Mat picture, fluid, fluid3;
  still.convertTo(picture, CV_32F, 1 / 255.0);
  matte.convertTo(fluid, CV_32F, 1 / 255.0);
  cv::merge(std::vector{fluid, fluid, fluid}, fluid3);
  const cv::Mat luma = luma_of_frame(still), base = synth::animate::base_image(luma, fluid, motion, {}),
                flow = motion / fps;
  const synth::animate::ColourModel colours = synth::animate::fit_colour(picture, luma, fluid);
  cv::Mat differences = (luma - base).mul(fluid);

  cv::Mat contrast;
  cv::GaussianBlur(differences.mul(differences), contrast, {}, kSide / 4.0);
  cv::sqrt(contrast, contrast);
  const std::vector<Square> squares = squares_of(base, contrast, flow, example);
  std::vector<cv::Mat> made(static_cast<std::size_t>(frames));
  oneapi::tbb::parallel_for(std::size_t{1}, made.size(), [&](std::size_t t) {
    made[t] = laid(example.residuals[(t - 1) % example.residuals.size()], squares, still.size());
  });
  for (std::size_t t = 1; t < made.size(); ++t) {
    differences = (example.kept * carried(differences, flow, cv::BORDER_CONSTANT) + made[t]).mul(fluid);
    made[t] = base + differences;
  }
  made[0] = still.clone();
  oneapi::tbb::parallel_for(std::size_t{1}, made.size(), [&](std::size_t t) {
    // Frame by frame, as they have it.
    const synth::animate::AppearanceModel like_the_still(luma, fluid, std::span(&made[t], 1), {});
    cv::Mat look;
    synth::animate::apply_colour(colours, like_the_still.apply(made[t]), look);
    cv::Mat(picture + fluid3.mul(look - picture)).convertTo(made[t], CV_8U, 255);
  });
  return made;
}

}  // namespace freshet::bench
