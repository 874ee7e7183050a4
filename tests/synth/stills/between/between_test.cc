#include "synth/stills/between/between.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

double rms(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat fa, fb;
  a.convertTo(fa, CV_32F);
  b.convertTo(fb, CV_32F);
  return std::sqrt(cv::norm(fa, fb, cv::NORM_L2SQR) / static_cast<double>(3 * a.total()));
}

cv::Mat between(const cv::Mat& a, const cv::Mat& b, double phase) {
  return moment_picture(Between(flow_between(a, b)).at(phase), a, b, cv::Rect({}, a.size()));
}

TEST(Between, BeginsAndEndsWithTheStillsThemselves) {
  const std::vector<cv::Mat> stills = made_pendulum({.3, .5});
  EXPECT_EQ(rms(between(stills[0], stills[1], 0), stills[0]), 0);
  EXPECT_EQ(rms(between(stills[0], stills[1], 1), stills[1]), 0);
  EXPECT_LT(rms(between(stills[0], stills[1], .02), stills[0]), .15 * rms(stills[0], stills[1]))
      << "and goes on from there without a jump";
}

TEST(Between, FindsWhatHasMovedHalfWay) {
  const std::vector<cv::Mat> stills = made_pendulum({.3, .34, .38}, {320, 192});
  const cv::Mat fade = (stills[0] + stills[2]) / 2;
  EXPECT_LT(rms(between(stills[0], stills[2], .5), stills[1]), .6 * rms(fade, stills[1]));
}

TEST(Between, FadesOverWhatNoMotionExplains) {
  const cv::Mat a = made_ground({160, 96}, 1), b = made_ground({160, 96}, 2);
  cv::Mat fade;
  cv::addWeighted(a, .5, b, .5, 0, fade);
  EXPECT_LT(rms(between(a, b, .5), fade), .5 * rms(a, b)) << "other noise is no motion";
}

TEST(Between, KeepsTheFineDetailOfWhatMovesByHalfAPixel) {
  // Both stills are half a pixel off the middle; linear samples would blur what they meet at.
  cv::Mat fine = made_ground({320, 192});
  cv::GaussianBlur(fine, fine, {}, .7);
  cv::RNG random(3);
  cv::Mat noise(fine.size(), CV_8UC3);
  random.fill(noise, cv::RNG::UNIFORM, 0, 120);
  cv::GaussianBlur(noise, noise, {}, 1.1);
  fine = fine + noise;
  const auto moved = [&](double by) {
    cv::Mat out;
    cv::warpAffine(fine, out, cv::Matx23d(1, 0, by, 0, 1, 0), fine.size(), cv::INTER_LANCZOS4,
                   cv::BORDER_REFLECT_101);
    return out;
  };
  EXPECT_LT(rms(between(moved(-.5), moved(.5), .5), fine), 2.0);
}

TEST(Between, BothWaysAroundAreTheSame) {
  const std::vector<cv::Mat> stills = made_pendulum({.3, .5});
  const cv::Mat forth = between(stills[0], stills[1], .25), back = between(stills[1], stills[0], .75);
  EXPECT_LT(rms(forth, back), .2);
}

TEST(Between, SixteenBitsSeeTheSameMotion) {
  const std::vector<cv::Mat> stills = made_pendulum({.3, .5});
  const Moment moment = Between(flow_between(stills[0], stills[1])).at(.4);
  cv::Mat deep[2];
  for (int i = 0; i < 2; ++i) stills[i].convertTo(deep[i], CV_16U, 257);
  const cv::Rect whole({}, stills[0].size());
  const cv::Mat eight = moment_picture(moment, stills[0], stills[1], whole);
  EXPECT_LT(rms(moment_picture(moment, deep[0], deep[1], whole) / 257, eight), 1e-3);
}

}  // namespace
}  // namespace freshet::synth::stills
