#include "synth/transfer/files/ground.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::transfer {
namespace {

constexpr int kMax = 65535;

double light(const cv::Mat& bgra, int x, int y, int c) {
  const cv::Vec4w& at = bgra.at<cv::Vec4w>(y, x);
  return static_cast<double>(at[c]) * at[3] / kMax / kMax;
}

// Bright filaments, 3 px wide and 3 px apart, in the middle of a black picture; around them noise as in footage.
cv::Mat filaments() {
  cv::Mat picture(120, 160, CV_16UC4, cv::Scalar(300, 200, 500, kMax));
  for (int y = 40; y < 90; ++y)
    for (int x = 50; x < 110; ++x)
      if (x % 6 < 3) picture.at<cv::Vec4w>(y, x) = {6000, 20000, 60000, kMax};
  return picture;
}

TEST(Ground, LightStaysWhatItIs) {
  cv::Mat picture(20, 30, CV_16UC4);
  cv::RNG random(3);
  random.fill(picture, cv::RNG::UNIFORM, 0, kMax + 1);
  cv::Mat mask(picture.size(), CV_16U);
  random.fill(mask, cv::RNG::UNIFORM, 0, kMax + 1);
  for (const cv::Mat& known : {cv::Mat(), mask}) {
    cv::Mat off = picture.clone();
    take_off_ground(off, Ground::kBlack, known);
    for (int y = 0; y < off.rows; ++y)
      for (int x = 0; x < off.cols; ++x)
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(light(off, x, y, c), light(picture, x, y, c), 1.5 / kMax);
  }
}

TEST(Ground, TheBodyOfLightHoldsTheGapsBetweenItsFilaments) {
  cv::Mat off = filaments();
  take_off_ground(off, Ground::kBlack);
  for (int x = 56; x < 104; ++x) EXPECT_GT(off.at<cv::Vec4w>(65, x)[3], 0.95 * kMax) << x;
  for (const cv::Point far : {cv::Point(20, 65), cv::Point(140, 65), cv::Point(80, 10), cv::Point(80, 115)})
    EXPECT_LT(off.at<cv::Vec4w>(far)[3], 0.02 * kMax) << far;
  // A mask is the body; what shines beyond it stays.
  cv::Mat known = filaments();
  cv::Mat mask(known.size(), CV_16U, cv::Scalar(0));
  mask(cv::Rect(0, 0, 80, 120)).setTo(kMax);
  take_off_ground(known, Ground::kBlack, mask);
  EXPECT_EQ(known.at<cv::Vec4w>(10, 10)[3], kMax);
  EXPECT_EQ(known.at<cv::Vec4w>(65, 96)[3], 60000);
  EXPECT_EQ(known.at<cv::Vec4w>(65, 101)[3], 500);
}

/// Alpha as it was defined: the light, closed with a disc by OpenCV.
cv::Mat slow_alpha(const cv::Mat& light, int gap) {
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * gap + 1, 2 * gap + 1});
  cv::Mat body;
  cv::morphologyEx(light, body, cv::MORPH_CLOSE, disc);
  body.forEach<std::uint16_t>([](std::uint16_t& value, const int*) {
    const float at = std::clamp((static_cast<float>(value) / kMax - 0.03f) / (0.6f - 0.03f), 0.0f, 1.0f);
    value = static_cast<std::uint16_t>(std::lround(at * at * (3 - 2 * at) * kMax));
  });
  return cv::max(light, body);
}

TEST(Ground, TheBodyIsWhatAClosingWithADiscGives) {
  cv::RNG random(5);
  for (const auto& [size, gap] : {std::pair(cv::Size(70, 50), 1), std::pair(cv::Size(40, 420), 8),
                                  std::pair(cv::Size(9, 333), 4), std::pair(cv::Size(33, 600), 12)}) {
    cv::Mat light(size, CV_16U);
    random.fill(light, cv::RNG::UNIFORM, 0, kMax);
    std::vector<cv::Mat> channels(4, light);
    channels[3] = cv::Mat(size, CV_16U, cv::Scalar(kMax));
    cv::Mat picture, alpha;
    cv::merge(channels, picture);
    take_off_ground(picture, Ground::kBlack);
    cv::extractChannel(picture, alpha, 3);
    EXPECT_EQ(cv::norm(alpha, slow_alpha(light, gap), cv::NORM_INF), 0) << size;
  }
}

TEST(Ground, ATallExemplarTakesNoLongerThanAWideOne) {
  const auto seconds_of = [](cv::Size size) {
    cv::Mat picture(size, CV_16UC4, cv::Scalar::all(20000));
    const auto begin = std::chrono::steady_clock::now();
    take_off_ground(picture, Ground::kBlack);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  for (const cv::Size tall : {cv::Size(1, 65535), cv::Size(20, 20000), cv::Size(300, 6000)})
    EXPECT_LT(seconds_of(tall), 2) << tall;
}

TEST(Ground, WhatHasAnAlphaIsLaidOnTheGroundFirst) {
  for (const Ground ground : {Ground::kBlack, Ground::kWhite}) {
    const int level = ground == Ground::kBlack ? 0 : kMax;
    cv::Mat glass(1, 1, CV_16UC4, cv::Scalar(10000, 30000, 50000, kMax / 3));
    cv::Mat seen(1, 1, CV_16UC4);
    for (int c = 0; c < 3; ++c)
      seen.at<cv::Vec4w>(0, 0)[c] =
          cv::saturate_cast<std::uint16_t>((glass.at<cv::Vec4w>(0, 0)[c] + 2.0 * level) / 3);
    seen.at<cv::Vec4w>(0, 0)[3] = kMax;
    take_off_ground(glass, ground);
    take_off_ground(seen, ground);
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(glass.at<cv::Vec4w>(0, 0)[c], seen.at<cv::Vec4w>(0, 0)[c], 3);
  }
}

TEST(Ground, WhiteIsTakenOffAsOverPutsItOn) {
  cv::Mat picture(1, 1, CV_16UC4, cv::Scalar(0.9 * kMax, 0.8 * kMax, 0.6 * kMax, kMax));
  take_off_ground(picture, Ground::kWhite);
  const cv::Vec4w at = picture.at<cv::Vec4w>(0, 0);
  EXPECT_NEAR(at[3], 0.4 * kMax, 1);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(light(picture, 0, 0, c) + 1 - at[3] / double{kMax},
                (std::array{0.9, 0.8, 0.6})[static_cast<std::size_t>(c)], 1e-4);
}

TEST(Ground, NothingIsNothing) {
  for (const Ground ground : {Ground::kBlack, Ground::kWhite}) {
    const int level = ground == Ground::kBlack ? 0 : kMax;
    cv::Mat picture(3, 3, CV_16UC4, cv::Scalar(level, level, level, kMax));
    take_off_ground(picture, ground);
    EXPECT_EQ(picture.at<cv::Vec4w>(1, 1)[3], 0);
  }
}

TEST(Ground, LightAloneIsTheSameLightWithTheLeastAlpha) {
  cv::Mat picture(20, 30, CV_32FC4);
  cv::RNG random(5);
  random.fill(picture, cv::RNG::UNIFORM, 0.0, 1.0);
  picture.at<cv::Vec4f>(0, 0) = {0, 0, 0, 0.5f};
  const cv::Mat alone = light_alone(picture);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const cv::Vec4f &of = picture.at<cv::Vec4f>(y, x), &at = alone.at<cv::Vec4f>(y, x);
      float most = 0;
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(at[c] * at[3], of[c] * of[3], 1e-6);
        most = std::max(most, of[c] * of[3]);
      }
      ASSERT_NEAR(at[3], most, 1e-6);
    }
}

}  // namespace
}  // namespace freshet::synth::transfer
