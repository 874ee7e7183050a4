#include "synth/animate/motion/motion_field.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace freshet::synth::animate {
namespace {

const cv::Size kPicture(320, 240);

cv::Mat everywhere(cv::Vec2f v) { return {kPicture, CV_32FC2, cv::Scalar(v[0], v[1])}; }
cv::Mat all() { return {kPicture, CV_32F, cv::Scalar(1)}; }

TEST(EvenedMotion, WhatGoesOneWayEverywhereStaysAndGoesOnBesideTheFluid) {
  cv::Mat matte = all(), motion = everywhere({30, -10});
  matte.colRange(200, 320).setTo(0);
  motion.colRange(200, 320).setTo(cv::Scalar(0, 90));
  for (const cv::Point at : {cv::Point(10, 10), cv::Point(190, 120), cv::Point(230, 120)})
    EXPECT_LT(cv::norm(evened_motion(motion, matte, 1).at<cv::Vec2f>(at) - cv::Vec2f(30, -10)), 0.1) << at;
}

TEST(EvenedMotion, NeighboursThatWentAtOtherSpeedsDoNotShear) {
  const auto spread = [](float slow, double whole) {
    cv::Mat motion = everywhere({slow, 0});
    for (int x = 0; x < kPicture.width; x += 48)
      motion.colRange(x, std::min(x + 24, 320)).setTo(cv::Scalar(50, 0));
    double least = 1e9, most = 0;
    const cv::Mat evened = evened_motion(motion, all(), whole);
    for (int x = 60; x < 260; ++x) {
      least = std::min<double>(least, evened.at<cv::Vec2f>(120, x)[0]);
      most = std::max<double>(most, evened.at<cv::Vec2f>(120, x)[0]);
    }
    return most - least;
  };
  EXPECT_LT(spread(10, 1), 3);
  EXPECT_LT(spread(30, 0), 3);   // of 20
  EXPECT_LT(spread(20, 0), 10);  // of 30
  // What rests in part.
  EXPECT_GT(spread(10, 0.5), 6);
  EXPECT_GT(spread(10, 0), 12);
}

TEST(EvenedMotion, WhatRestsStaysUnlessAllGoesAsAWhole) {
  cv::Mat motion = everywhere({50, 0});
  motion.colRange(0, 60).setTo(cv::Scalar(0, 3));
  for (int x = 10; x < 40; x += 10) {
    EXPECT_LT(cv::norm(evened_motion(motion, all(), 0).at<cv::Vec2f>(120, x) - cv::Vec2f(0, 3)), 0.1) << x;
    EXPECT_GT(evened_motion(motion, all(), 1).at<cv::Vec2f>(120, x)[0], 3) << x;
  }
  EXPECT_GT(evened_motion(motion, all(), 0).at<cv::Vec2f>(120, 250)[0], 45);
}

TEST(EvenedMotion, WaysMeetBetweenAtASpeedBetween) {
  cv::Mat motion = everywhere({0, 30});
  motion.rowRange(80, 240).setTo(cv::Scalar(40, 0));
  // The mean of the vectors would be slower: 25 px/s.
  const cv::Vec2f v = evened_motion(motion, all(), 1).at<cv::Vec2f>(80, 160);
  EXPECT_GT(v[0], 5);
  EXPECT_GT(v[1], 5);
  EXPECT_GT(cv::norm(v), 30);
  EXPECT_LT(cv::norm(v), 40);
}

TEST(EvenedMotion, ANarrowStreamThroughStillWaterKeepsItsSpeed) {
  cv::Mat motion = everywhere({0, 2});
  motion.colRange(140, 180).setTo(cv::Scalar(0, 60));
  motion.colRange(140, 180).rowRange(80, 160).setTo(cv::Scalar(0, 80));
  const cv::Mat evened = evened_motion(motion, all(), 0);
  EXPECT_NEAR(evened.at<cv::Vec2f>(120, 160)[1], 58, 10);
  EXPECT_NEAR(evened.at<cv::Vec2f>(30, 160)[1], 54, 10);
  EXPECT_NEAR(evened.at<cv::Vec2f>(120, 60)[1], 2, 0.1);
}

TEST(EvenedMotion, WhereWaysCancelOutEachPlaceKeepsItsOwnAtTheMeanSpeed) {
  cv::Mat motion(kPicture, CV_32FC2);
  const float speeds[] = {40, -20, 40, -60};
  for (int y = 0; y < 240; ++y) motion.row(y).setTo(cv::Scalar(speeds[y / 24 % 4], 0));
  const cv::Mat evened = evened_motion(motion, all(), 1);
  for (const int y : {84, 108, 132, 156}) {
    const float was = motion.at<cv::Vec2f>(y, 160)[0], is = evened.at<cv::Vec2f>(y, 160)[0];
    EXPECT_GT(was * is, 0) << y;
    EXPECT_NEAR(std::abs(is), 40, 10) << y;
  }
}

TEST(EvenedMotion, WhereTwoWaysPassEachOtherWhatLiesBetweenIsNotTorn) {
  cv::Mat motion = everywhere({0, 0});
  for (int y = 0; y < 240; ++y)
    motion.row(y).setTo(cv::Scalar(std::clamp(2.0 * (y - 119.5), -40.0, 40.0), 0));
  const cv::Mat evened = evened_motion(motion, all(), 1);
  EXPECT_LT(evened.at<cv::Vec2f>(20, 160)[0], -20);
  EXPECT_GT(evened.at<cv::Vec2f>(220, 160)[0], 20);
  for (int y = 1; y < 240; ++y)
    EXPECT_LT(cv::norm(evened.at<cv::Vec2f>(y, 160) - evened.at<cv::Vec2f>(y - 1, 160)), 6) << y;
}

TEST(EvenedMotion, WithoutFluidOrMotionAndOfTheSmallestPicturesItIsFinite) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 50), cv::Size(40, 3)})
    for (const float speed : {0.0f, 7.0f})
      for (const float fluid : {0.0f, 1.0f}) {
        const cv::Mat motion(size, CV_32FC2, cv::Scalar(speed, 0)), matte(size, CV_32F, cv::Scalar(fluid));
        const cv::Mat evened = evened_motion(motion, matte, 0.5);
        EXPECT_TRUE(cv::checkRange(evened)) << size;
        EXPECT_LT(cv::norm(evened, motion, cv::NORM_INF), 1e-3) << size;
      }
}

TEST(ApplyGuide, TurnsWhatGoesAndKeepsItsSpeed) {
  query::MotionGuide guide;
  guide.direction = everywhere({0, 1});
  guide.direction.colRange(160, 320).setTo(cv::Scalar(0, 0));
  const cv::Mat field = apply_guide(everywhere({30, 0}), guide, all());
  EXPECT_LT(cv::norm(field.at<cv::Vec2f>(120, 40) - cv::Vec2f(0, 30)), 0.1);
  EXPECT_LT(cv::norm(field.at<cv::Vec2f>(120, 158) - cv::Vec2f(0, 30)), 0.1)
      << "up to where nothing is asked";
  EXPECT_EQ(field.at<cv::Vec2f>(120, 200), cv::Vec2f(30, 0));
}

TEST(ApplyGuide, ASpeedBeyondWhatFluidsDoIsTheFastestTheyDo) {
  query::MotionGuide guide;
  guide.speed = cv::Mat(kPicture, CV_32F, cv::Scalar(100));
  EXPECT_FLOAT_EQ(apply_guide(everywhere({30, 0}), guide, all()).at<cv::Vec2f>(120, 40)[0], 100);
  guide.speed = 5000;
  EXPECT_FLOAT_EQ(apply_guide(everywhere({30, 0}), guide, all()).at<cv::Vec2f>(120, 40)[0], 0.8F * 320);
}

TEST(ApplyGuide, StandsWhereDirectionsOpposeEachOther) {
  query::MotionGuide guide;
  guide.direction = everywhere({0, 1});
  guide.direction.colRange(160, 320).setTo(cv::Scalar(0, -1));
  for (const bool asked : {false, true}) {
    if (asked) guide.speed = cv::Mat(kPicture, CV_32F, cv::Scalar(60));
    const cv::Mat field = apply_guide(everywhere({60, 0}), guide, all());
    double steepest = 0;
    for (int x = 1; x < kPicture.width; ++x)
      steepest = std::max(steepest, cv::norm(field.at<cv::Vec2f>(120, x) - field.at<cv::Vec2f>(120, x - 1)));
    EXPECT_LT(steepest, 14) << "px/s from a pixel to the next; 120 without";
    EXPECT_NEAR(field.at<cv::Vec2f>(120, 100)[1], 60, 0.1);
    EXPECT_NEAR(field.at<cv::Vec2f>(120, 220)[1], -60, 0.1);
  }
}

TEST(ApplyGuide, TheEyeOfASwirlStands) {
  query::MotionGuide guide;
  guide.direction.create(kPicture, CV_32FC2);
  for (int y = 0; y < kPicture.height; ++y)
    for (int x = 0; x < kPicture.width; ++x) {
      const cv::Vec2f out(static_cast<float>(x) - 159.5f, static_cast<float>(y) - 119.5f);
      guide.direction.at<cv::Vec2f>(y, x) = cv::Vec2f(-out[1], out[0]) / static_cast<float>(cv::norm(out));
    }
  const cv::Mat field = apply_guide(everywhere({40, 0}), guide, all());
  EXPECT_LT(cv::norm(field.at<cv::Vec2f>(119, 159)), 8);
  EXPECT_NEAR(cv::norm(field.at<cv::Vec2f>(119, 190)), 40, 1);
}

TEST(ApplyGuide, SlowsDownTowardsAHorizonAndKeepsTheMean) {
  query::MotionGuide guide;
  guide.horizon = Horizon{{0, 40}, {320, 40}};
  cv::Mat matte = cv::Mat::zeros(kPicture, CV_32F);
  matte.rowRange(40, 240).setTo(1);
  const cv::Mat field = apply_guide(everywhere({30, 0}), guide, matte);
  double sum = 0;
  for (int y = 40; y < 240; ++y) sum += field.at<cv::Vec2f>(y, 100)[0] / 200;
  EXPECT_NEAR(sum, 30, 0.1);
  EXPECT_NEAR(field.at<cv::Vec2f>(139, 100)[0], 2 * field.at<cv::Vec2f>(89, 100)[0], 0.5);
  EXPECT_LT(field.at<cv::Vec2f>(40, 100)[0], 0.5);
  // What is asked by speed is asked.
  guide.speed = cv::Mat(kPicture, CV_32F, cv::Scalar(50));
  EXPECT_FLOAT_EQ(apply_guide(everywhere({30, 0}), guide, matte).at<cv::Vec2f>(60, 100)[0], 50);
}

/// Streaks that are drawn out this way, CV_32F.
cv::Mat streaks(bool upright) {
  cv::Mat luma(kPicture, CV_32F);
  cv::RNG(4).fill(luma, cv::RNG::NORMAL, 0.5, 0.3);
  const double along = 12, across = 1.5;
  cv::GaussianBlur(luma, luma, {}, upright ? across : along, upright ? along : across, cv::BORDER_REFLECT);
  return luma;
}

query::MotionGuide asked_to(cv::Vec2f way) {
  query::MotionGuide guide;
  guide.direction = everywhere(way / cv::norm(way));
  return guide;
}

double mean_speed_of(const cv::Mat& motion, const cv::Range& rows) {
  double sum = 0;
  for (int y = rows.start; y < rows.end; ++y) sum += cv::norm(motion.at<cv::Vec2f>(y, 160)) / rows.size();
  return sum;
}

TEST(FallingFreely, GathersSpeedDownAFallAndKeepsTheMean) {
  const cv::Mat field = falling_freely(everywhere({25, 150}), asked_to({25, 150}), streaks(true), all());
  const double brink = mean_speed_of(field, {0, 8}), foot = mean_speed_of(field, {232, 240});
  EXPECT_NEAR(foot / brink, 2, 0.2);
  EXPECT_NEAR(mean_speed_of(field, {0, 240}), std::hypot(25, 150), 2);
  const double middle = mean_speed_of(field, {116, 124});
  EXPECT_NEAR(middle * middle, (brink * brink + foot * foot) / 2, 0.06 * foot * foot)
      << "its square by the height";
  EXPECT_NEAR(field.at<cv::Vec2f>(120, 160)[0] / field.at<cv::Vec2f>(120, 160)[1], 25.0 / 150, 1e-4);
}

TEST(FallingFreely, LosesSpeedUpwards) {
  const cv::Mat field = falling_freely(everywhere({0, -150}), asked_to({0, -150}), streaks(true), all());
  EXPECT_NEAR(mean_speed_of(field, {0, 8}) / mean_speed_of(field, {232, 240}), 0.35, 0.06);
  EXPECT_NEAR(mean_speed_of(field, {0, 240}), 150, 2);
}

TEST(FallingFreely, SpeedsOfPatchesAreEvenedDownTheFallAndKeptAcrossIt) {
  cv::Mat motion = everywhere({0, 150});
  motion.rowRange(80, 120) *= 3;
  motion.colRange(200, 320) *= 0.5;
  const cv::Mat field = falling_freely(motion, asked_to({0, 150}), streaks(true), all());
  EXPECT_LT(field.at<cv::Vec2f>(100, 160)[1], field.at<cv::Vec2f>(200, 160)[1]);
  EXPECT_NEAR(field.at<cv::Vec2f>(200, 260)[1] / field.at<cv::Vec2f>(200, 160)[1], 0.5, 0.01);
}

TEST(FallingFreely, FallsAsFastAsFallsDo) {
  const auto falls = [](float speed, double played) {
    return mean_speed_of(
        falling_freely(everywhere({0, speed}), asked_to({0, 1}), streaks(true), all(), played), {0, 240});
  };
  EXPECT_NEAR(falls(40, 1), 0.35 * 320, 1.5);
  EXPECT_NEAR(falls(20, 0.5), 0.5 * 0.35 * 320, 1) << "in slow motion";
  EXPECT_NEAR(falls(10, 1), 40, 0.6) << "no more than four times its own";
  EXPECT_NEAR(falls(130, 1), 130, 2);
}

TEST(FallingFreely, WhatDoesNotFallKeepsItsSpeed) {
  const auto stays = [](const cv::Mat& motion, const query::MotionGuide& guide, const cv::Mat& luma,
                        const cv::Mat& matte) {
    return cv::norm(falling_freely(motion, guide, luma, matte), motion, cv::NORM_INF) == 0;
  };
  const cv::Mat down = everywhere({0, 30});
  EXPECT_TRUE(stays(down, asked_to({0, 1}), streaks(false), all())) << "ripples, as of a river";
  EXPECT_TRUE(stays(everywhere({30, 30}), asked_to({1, 1}), streaks(true), all())) << "it leans";
  cv::Mat low = all();
  low.rowRange(50, 240).setTo(0);
  EXPECT_TRUE(stays(down, asked_to({0, 1}), streaks(true), low)) << "a step";
  EXPECT_TRUE(stays(down, {}, streaks(true), all())) << "nobody says its way";
  query::MotionGuide guide = asked_to({0, 1});
  guide.speed = cv::Mat(kPicture, CV_32F, cv::Scalar(30));
  EXPECT_TRUE(stays(down, guide, streaks(true), all())) << "a speed that is asked is asked";
  query::MotionGuide plane = asked_to({0, 1});
  plane.horizon = Horizon{{0, 40}, {320, 40}};
  EXPECT_TRUE(stays(down, plane, streaks(true), all())) << "a plane seen from above";
}

/// A jet in the picture's middle, with air above.
cv::Mat jet() {
  cv::Mat matte = cv::Mat::zeros(kPicture, CV_32F);
  matte(cv::Rect(110, 40, 100, 200)).setTo(1);
  return matte;
}

TEST(ComingDown, BesideTheCoreAsFastAsItRoseThereAndOnSideways) {
  cv::Mat motion = everywhere({20, -150});
  motion.rowRange(40, 120) *= 0.5;
  const ComingDown down = coming_down(motion, asked_to({20, -150}), streaks(true), jet());
  EXPECT_EQ(down.motion.at<cv::Vec2f>(200, 125), cv::Vec2f(20, 150));
  EXPECT_EQ(down.motion.at<cv::Vec2f>(80, 195), cv::Vec2f(10, 75));
  EXPECT_EQ(down.motion.at<cv::Vec2f>(120, 20), cv::Vec2f(20, -150)) << "beside the jet";
  EXPECT_LT(down.share.at<float>(230, 160), 1e-3) << "the core";
  EXPECT_NEAR(down.share.at<float>(140, 177), 0.5, 0.06) << "a third rises";
  EXPECT_GT(down.share.at<float>(230, 112), 0.9);
  EXPECT_GT(down.share.at<float>(60, 207), 0.9);
  EXPECT_EQ(down.share.at<float>(120, 20), 0);
  double previous = 0;
  for (int x = 160; x < 210; ++x) {
    const double share = down.share.at<float>(140, x);
    EXPECT_LT(std::abs(share - previous), 0.15) << "nothing jumps: " << x;
    previous = share;
  }
}

TEST(ComingDown, WhatMayBeThrownUpShowsLessOfItAndComesDownAsFast) {
  int between = 0;
  for (double ripples = 0; ripples <= 1; ripples += 0.02) {
    const cv::Mat luma = (1 - ripples) * streaks(true) + ripples * streaks(false);
    const ComingDown down = coming_down(everywhere({0, -150}), asked_to({0, -150}), luma, jet());
    if (down.share.empty()) continue;
    const float share = down.share.at<float>(60, 207);
    between += share > 0.1f && share < 0.8f ? 1 : 0;
    EXPECT_EQ(down.motion.at<cv::Vec2f>(200, 125), cv::Vec2f(0, 150)) << ripples;
  }
  EXPECT_GT(between, 0);
}

TEST(ComingDown, NothingDoesThatIsNotThrownUpIntoTheAir) {
  const auto none = [](const query::MotionGuide& guide, const cv::Mat& motion, const cv::Mat& luma,
                       const cv::Mat& matte) {
    return coming_down(motion, guide, luma, matte).share.empty();
  };
  const cv::Mat up = everywhere({0, -150});
  EXPECT_FALSE(none(asked_to({0, -1}), up, streaks(true), jet()));
  EXPECT_TRUE(none(asked_to({0, 1}), everywhere({0, 150}), streaks(true), jet())) << "a fall";
  EXPECT_TRUE(none(asked_to({0, -1}), up, streaks(true), all())) << "it leaves the picture";
  EXPECT_TRUE(none(asked_to({0, -1}), up, streaks(false), jet())) << "ripples";
  cv::Mat arch = up.clone();
  arch.rowRange(0, 80).setTo(cv::Scalar(150, 0));
  EXPECT_TRUE(none(asked_to({0, -1}), arch, streaks(true), jet())) << "it is drawn how it turns";
  query::MotionGuide guide = asked_to({0, -1});
  guide.speed = cv::Mat(kPicture, CV_32F, cv::Scalar(30));
  EXPECT_TRUE(none(guide, up, streaks(true), jet())) << "a speed that is asked is asked";
}

}  // namespace
}  // namespace freshet::synth::animate
