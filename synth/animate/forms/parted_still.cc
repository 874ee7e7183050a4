#include "synth/animate/forms/parted_still.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synth/animate/forms/light_level.h"
#include "synth/animate/forms/seats.h"
#include "synth/animate/still/colour_model.h"
#include "synth/sampling/pull_push.h"
#include "vision/dot.h"

namespace freshet::synth::animate {
namespace {

constexpr int kSeatSamples = 200;
constexpr float kSoft = 0.07f;  // levels to either side of the threshold
constexpr double kLowestThreshold = 0.2, kHighestThreshold = 0.55;
constexpr double kAround = 0.06;  // of the picture's longer side: surroundings of the matte that are compared
constexpr double kEmberSide = 0.012;  // of the same: sigma over which embers are told from flames
constexpr double kGlow = 0.05;        // of the same: how far from flames there may be faint ones
constexpr float kDark = 0.25f;  // luma: grounds below that are believed, lighter ones are seldom below flames
constexpr float kReddest = 0.16f, kOrange = 0.24f;  // green over red, of light: of embers, and of flames
constexpr float kPaleFrom = 0.5f, kPale = 0.75f;    // blue over green, of light: flames have less
constexpr float kNotBelow = 0.97f;  // of that, what is lost below a fire: a rim that it burns behind
constexpr double kSpeck = 0.04;  // of the largest flame: a smaller one that is not near a larger one is none
constexpr double kLeastShining = 16;  // px
constexpr double kCore = 0.012;       // of the longer side: white this near to what is warm is a flame's core
constexpr double kPaleEdge = 0.012;   // of the same: what is pale no farther is a flame's edge

float ramp(float value, float from, float to) { return std::clamp((value - from) / (to - from), 0.0f, 1.0f); }

cv::Mat disc(double radius) {
  const int side = 2 * std::max(1, static_cast<int>(std::lround(radius))) + 1;
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side});
}

/// 0..1: how much of a pixel's colour is fire's. Wax, wood and a pot's rim that a fire lights are warm too, but pale
/// over a wide area, where a flame that is not yet white has hardly any blue.
cv::Mat warmth(const cv::Mat& picture, double side) {
  cv::Mat warm(picture.size(), CV_32F), white(picture.size(), CV_32F), pale(picture.size(), CV_32F);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const cv::Vec3f c = picture.at<cv::Vec3f>(y, x);
      warm.at<float>(y, x) = ramp(c[2] - c[0], 0.08f, 0.2f) * ramp(c[2] - 0.92f * c[1], 0.0f, 0.06f);
      white.at<float>(y, x) = ramp(std::min({c[0], c[1], c[2]}), 0.75f, 0.9f);
      pale.at<float>(y, x) = ramp(c[0] / std::max(c[2], 1e-3f), 0.5f, 0.6f) * (1 - ramp(c[1], 0.75f, 0.9f));
    }
  cv::morphologyEx(pale, pale, cv::MORPH_OPEN, disc(kPaleEdge * side));
  cv::multiply(warm, 1 - pale, warm);
  cv::Mat near;
  cv::dilate(warm, near, disc(kCore * side));
  // From rim to core, as far as white goes on.
  for (int pass = 0; pass < 6; ++pass) {
    near = cv::min(near, cv::max(white, warm));
    cv::dilate(near, near, disc(kCore * side));
  }
  return cv::max(warm, cv::min(near, white));
}

double threshold_of(const cv::Mat& luma, const cv::Mat& where) {
  std::array<double, 256> count{};
  double all = 0, sum = 0;
  for (int y = 0; y < luma.rows; ++y)
    for (int x = 0; x < luma.cols; ++x)
      if (where.at<std::uint8_t>(y, x) != 0) {
        const int at = std::clamp(cvRound(255 * luma.at<float>(y, x)), 0, 255);
        ++count[at];
        ++all;
        sum += at;
      }
  double below = 0, below_sum = 0, best = -1;
  int found = 0;
  for (int at = 0; at < 255; ++at) {
    below += count[at];
    below_sum += at * count[at];
    if (below == 0 || below == all) continue;
    const double apart = below_sum / below - (sum - below_sum) / (all - below);
    const double variance = below * (all - below) * apart * apart;
    if (variance > best) best = variance, found = at;
  }
  return std::clamp((found + 0.5) / 255, kLowestThreshold, kHighestThreshold);
}

/// Leaves and reflections that are as bright as a flame, far from any.
void drop_specks(cv::Mat& shine, double near) {
  cv::Mat labels, stats, centres;
  const int n = cv::connectedComponentsWithStats(shine > 0.3f, labels, stats, centres);
  int largest = 0;
  for (int i = 1; i < n; ++i) largest = std::max(largest, stats.at<int>(i, cv::CC_STAT_AREA));
  cv::Mat kept = cv::Mat::zeros(shine.size(), CV_8U);
  for (int y = 0; y < shine.rows; ++y)
    for (int x = 0; x < shine.cols; ++x) {
      const int label = labels.at<int>(y, x);
      if (label > 0 && stats.at<int>(label, cv::CC_STAT_AREA) >= kSpeck * largest)
        kept.at<std::uint8_t>(y, x) = 255;
    }
  cv::dilate(kept, kept, disc(near));
  shine.setTo(0, ~kept);
}

/// 1 at the bed of a seat and below, to 0 this much of its height above: from `full` of it on less than 1.
float lowness(const std::vector<Seat>& seats, int x, int y, double none, double full) {
  for (const Seat& seat : seats)
    if (x >= seat.first && x < seat.last)
      return ramp(static_cast<float>((seat.bed - y) / seat.height()), static_cast<float>(none),
                  static_cast<float>(full));
  return 0;
}

/// 0..1: what glows below flames, and is no flame.
cv::Mat embers_of(const cv::Mat& whole, const cv::Mat& luma, const cv::Mat& shine,
                  const std::vector<Seat>& seats) {
  // Green over red, by luma, of flames above.
  constexpr int kSteps = 32;
  cv::Mat count = cv::Mat::zeros(1, kSteps + 1, CV_64F), sums = cv::Mat::zeros(1, kSteps + 1, CV_64F);
  const auto step_of = [&](int y, int x) {
    return std::clamp(cvRound(kSteps * luma.at<float>(y, x)), 0, kSteps);
  };
  const auto ratio_of = [&](int y, int x) {
    const cv::Vec3f c = whole.at<cv::Vec3f>(y, x);
    return c[1] / std::max(c[2], 1e-3f);
  };
  // A smooth flame's body is that, an ember is red; wax and wood that are lit are paler.
  const auto orange = [&](int y, int x) {
    const cv::Vec3f c = whole.at<cv::Vec3f>(y, x);
    return ramp(ratio_of(y, x), kReddest, kOrange) *
           (1 - ramp(c[0] / std::max(c[1], 1e-3f), kPaleFrom, kPale));
  };
  cv::Mat embers = cv::Mat::zeros(luma.size(), CV_32F), weights = embers.clone();
  for (int y = 0; y < luma.rows; ++y)
    for (int x = 0; x < luma.cols; ++x) {
      const double weight = shine.at<float>(y, x) * (1 - lowness(seats, x, y, 0.6, 0.45));
      if (weight <= 0) continue;
      count.at<double>(step_of(y, x)) += weight;
      sums.at<double>(step_of(y, x)) += weight * ratio_of(y, x);
    }
  cv::GaussianBlur(count, count, {0, 1}, 2, 0, cv::BORDER_CONSTANT);
  cv::GaussianBlur(sums, sums, {0, 1}, 2, 0, cv::BORDER_CONSTANT);
  const double least = 1e-3 * cv::sum(count)[0] + 1e-9;
  for (int y = 0; y < luma.rows; ++y)
    for (int x = 0; x < luma.cols; ++x) {
      const int step = step_of(y, x);
      if (luma.at<float>(y, x) <= 0.05f || count.at<double>(step) < least) continue;
      const double flame = sums.at<double>(step) / count.at<double>(step);
      const float ratio = ratio_of(y, x), redder = 1 - ratio / static_cast<float>(flame);
      weights.at<float>(y, x) = luma.at<float>(y, x);
      embers.at<float>(y, x) = luma.at<float>(y, x) * ramp(redder, 0.1f, 0.4f) * (1 - orange(y, x));
    }
  // A glowing log as a whole: its brightest spots are as white as a flame.
  const double sigma = kEmberSide * std::max(luma.cols, luma.rows);
  cv::GaussianBlur(embers, embers, {}, sigma);
  cv::GaussianBlur(weights, weights, {}, sigma);
  for (int y = 0; y < luma.rows; ++y)
    for (int x = 0; x < luma.cols; ++x)
      embers.at<float>(y, x) = ramp(embers.at<float>(y, x) / (weights.at<float>(y, x) + 1e-3f), 0.3f, 0.55f) *
                               lowness(seats, x, y, 0.8, 0.55);
  return embers;
}

}  // namespace

PartedStill part(const cv::Mat& picture, const cv::Mat& alpha) {
  const double side = std::max(picture.cols, picture.rows);
  const cv::Mat luma = luma_of(picture), warm = warmth(picture, side);
  const cv::Mat inside = alpha > 0;
  cv::Mat around;
  cv::dilate(inside, around, disc(kAround * side));
  const auto threshold = static_cast<float>(threshold_of(luma, around));
  const auto lighter_than = [&](float from, float to) {
    cv::Mat out = cv::Mat::zeros(picture.size(), CV_32F);
    for (int y = 0; y < picture.rows; ++y)
      for (int x = 0; x < picture.cols; ++x)
        if (inside.at<std::uint8_t>(y, x) != 0)
          out.at<float>(y, x) = ramp(luma.at<float>(y, x), from, to) * warm.at<float>(y, x);
    return out;
  };
  const cv::Mat whole = light_of(picture);
  cv::Mat shine = lighter_than(threshold - kSoft, threshold + kSoft);
  const std::vector<Seat> seats = seats_reduced(shine, kSeatSamples);
  const cv::Mat embers = embers_of(whole, luma, shine, seats);
  cv::multiply(shine, 1 - embers, shine);
  drop_specks(shine, kGlow * side);

  PartedStill parted;
  parted.level = cv::Mat::zeros(picture.size(), CV_32F);
  parted.before = cv::Mat::zeros(picture.size(), CV_32F);
  parted.light = cv::Mat::zeros(picture.size(), CV_32FC3);
  parted.ground = whole;
  const double shining = cv::sum(shine)[0], fluid = cv::countNonZero(inside);
  if (shining < kLeastShining) return parted;
  parted.share = shining / fluid;
  cv::Mat dark = 1 - shine;
  dark.setTo(0, ~around);
  const auto ground = static_cast<float>(vision::dot(luma, dark) / std::max(cv::sum(dark)[0], 1.0));
  parted.contrast = vision::dot(luma, shine) / shining - ground;
  const float above = std::max(0.05f, threshold - ground);

  // Below flames, and below the glow around them, the ground is guessed: from what is dark nearby.
  cv::Mat hidden, near;
  cv::dilate(shine, near, disc(kGlow * side));
  hidden = cv::max(shine, cv::min(near, lighter_than(ground + 0.15f * above, ground + 0.4f * above)));
  cv::multiply(hidden, 1 - embers, hidden);
  cv::dilate(hidden, hidden, disc(1));
  cv::GaussianBlur(hidden, hidden, {}, 0.8);
  hidden.setTo(0, ~inside);
  cv::Mat trust(picture.size(), CV_32F);
  for (int y = 0; y < trust.rows; ++y)
    for (int x = 0; x < trust.cols; ++x) {
      const float l = luma.at<float>(y, x), covered = std::min(1.0f, 4 * hidden.at<float>(y, x));
      trust.at<float>(y, x) = (1 - covered) * (1 - 0.95f * embers.at<float>(y, x)) *
                              (1 - kNotBelow * lowness(seats, x, y, 0.03, -0.03)) *
                              (0.001f + std::exp(-l * l / (kDark * kDark)));
    }
  cv::Mat guess = sampling::pull_push(whole, trust);
  cv::GaussianBlur(guess, guess, {}, std::max(1.0, 0.004 * side));
  cv::Mat enclosed;
  const double tallest =
      seats.empty() ? 1 : std::max_element(seats.begin(), seats.end(), [](const Seat& a, const Seat& b) {
                            return a.height() < b.height();
                          })->height();
  cv::GaussianBlur(shine, enclosed, {}, std::max(1.0, 0.1 * tallest), 0, cv::BORDER_REPLICATE);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const cv::Vec3f p = whole.at<cv::Vec3f>(y, x);
      // Light adds up: the ground is no lighter than the picture.
      cv::Vec3f g = guess.at<cv::Vec3f>(y, x);
      g *= std::min(1.0f, luma_of(p) / std::max(luma_of(g), 1e-6f));
      const float share = std::min(1.0f, 1.5f * hidden.at<float>(y, x));
      const cv::Vec3f behind = p + share * (g - p), light = p - behind;
      parted.ground.at<cv::Vec3f>(y, x) = behind;
      parted.light.at<cv::Vec3f>(y, x) = light;
      if (share > 0) parted.level.at<float>(y, x) = (1 - embers.at<float>(y, x)) * level_of(luma_of(light));
      parted.before.at<float>(y, x) = ramp(enclosed.at<float>(y, x), 0.25f, 0.45f) *
                                      (1 - ramp(luma.at<float>(y, x), 0.4f * threshold, 0.8f * threshold)) *
                                      lowness(seats, x, y, 0.55, 0.35);
    }
  return parted;
}

}  // namespace freshet::synth::animate
