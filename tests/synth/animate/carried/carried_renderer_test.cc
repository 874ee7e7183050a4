#include "synth/animate/carried/carried_renderer.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "synth/animate/animate.h"
#include "tests/synth/animate/flowing_clip.h"
#include "tests/synth/animate/measured_clip.h"

namespace freshet::synth::animate {
namespace {

const cv::Point kFrom{40, 50};
constexpr int kFrames = 25, kStep_px = 2;

/// A picture by a second of a clip that goes right and whose forms live so long; upper pieces play it as fast as
/// filmed, those below at `lower` times that.
AnimateReport animate_second(const cv::Mat& picture, const cv::Mat& matte, float life_s, double lower,
                             const char* class_name, const AnimateOptions& options,
                             const std::function<void(const cv::Mat&)>& sink) {
  const FlowingStore store({measured({.frames = kFrames + 1,
                                      .steady = {kStep_px, 0},
                                      .varying = 0,
                                      .drawn = [](int) { return cv::Mat(110, 150, CV_8U, cv::Scalar(100)); },
                                      .class_name = class_name,
                                      .life = living(life_s)})});
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  for (int y = 0; y + 48 <= picture.rows; y += 24)
    for (int x = 0; x + 48 <= picture.cols; x += 24)
      placement.patches.push_back({.piece = {x, y},
                                   .clip = store.id(),
                                   .variant = {},
                                   .patch = {x % 96, y % 60},
                                   .speed = y < 24 ? 1 : lower});
  return animate(store.snapshot(), store.settings(), picture,
                 matte.empty() ? cv::Mat(picture.size(), CV_8U, cv::Scalar(255)) : matte, placement, options,
                 sink);
}

std::vector<cv::Mat> a_second_of(const cv::Mat& picture, float life_s, double lower = 1,
                                 std::function<void(const cv::Mat&)> motion = {},
                                 const CarriedOptions& carried = {}, const cv::Mat& matte = {},
                                 const query::MotionGuide& guide = {}) {
  std::vector<cv::Mat> frames;
  AnimateOptions options;
  options.frames = kFrames;
  options.method = carried;
  options.motion_sink = std::move(motion);
  options.guide = guide;
  animate_second(picture, matte, life_s, lower, "water", options,
                 [&](const cv::Mat& frame) { frames.push_back(frame.clone()); });
  return frames;
}

cv::Mat after_a_second(const cv::Mat& picture, float life_s, double lower = 1,
                       std::function<void(const cv::Mat&)> motion = {}) {
  return a_second_of(picture, life_s, lower, std::move(motion)).back();
}

cv::Mat sky(int width) { return cv::Mat(100, width, CV_8UC3, cv::Scalar(200, 90, 20)); }

cv::Vec3b at(const cv::Mat& frame, cv::Point place) { return frame.at<cv::Vec3b>(place); }

TEST(CarriedRenderer, BodiesThatLiveLongGoWholeWithTheirLightAndColour) {
  const cv::Point to = kFrom + cv::Point(kStep_px * (kFrames - 1), 0);
  cv::Mat disc = sky(144);
  cv::circle(disc, kFrom, 15, cv::Scalar::all(240), cv::FILLED, cv::LINE_AA);
  const cv::Mat body = after_a_second(disc, 6), brief = after_a_second(disc, 0.4f);
  EXPECT_GT(at(body, to)[2], 200) << "white where it has gone";
  EXPECT_LT(at(body, kFrom)[2], 50) << "blue where it was";
  EXPECT_GT(at(brief, kFrom)[2], at(body, kFrom)[2] + 60) << "what lives briefly keeps its place's light";
}

/// What a picture has become after a second. flow  px/s, right and down, by the place beside the middle.
cv::Mat carried_by(const cv::Mat& picture, const char* class_name,
                   const std::function<cv::Vec2f(float, float)>& flow) {
  AnimateOptions options;
  options.frames = kFrames;
  options.guide.direction.create(picture.size(), CV_32FC2);
  options.guide.speed.create(picture.size(), CV_32F);
  const auto from_middle = [](int at, int length) {
    return static_cast<float>(at) - 0.5f * static_cast<float>(length - 1);
  };
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const cv::Vec2f v = flow(from_middle(x, picture.cols), from_middle(y, picture.rows));
      const auto speed = static_cast<float>(cv::norm(v));
      options.guide.speed.at<float>(y, x) = speed;
      options.guide.direction.at<cv::Vec2f>(y, x) = v / speed;
    }
  cv::Mat last;
  animate_second(picture, {}, 6, 1, class_name, options, [&](const cv::Mat& frame) { last = frame.clone(); });
  return last;
}

/// How white it is, after a second, where a white disc lay on blue.
int stays(const char* class_name, const std::function<cv::Vec2f(float, float)>& flow) {
  const cv::Point place(112, 72);
  cv::Mat disc(144, 144, CV_8UC3, cv::Scalar(200, 90, 20));
  cv::circle(disc, place, 15, cv::Scalar::all(240), cv::FILLED, cv::LINE_AA);
  return at(carried_by(disc, class_name, flow), place)[2];
}

TEST(CarriedRenderer, CloudsThatWouldBeTornKeepTheirLayout) {
  const auto sheared = [](float, float y) { return cv::Vec2f(50 + 0.6f * y, 0); };
  EXPECT_GT(stays("clouds", sheared), 150);
  EXPECT_LT(stays("smoke", sheared), 60) << "smoke is drawn out by nature";
  EXPECT_LT(stays("water", sheared), 60) << "of water the patches tell";
  EXPECT_LT(stays("clouds", [](float, float) { return cv::Vec2f(50, 0); }), 60);
}

TEST(CarriedRenderer, WhereAVortexIsAskedTheLayoutOfASkyStands) {
  // Turning as a whole strains nothing.
  const auto round = [](float x, float y) { return cv::Vec2f(-1.2f * y, 1.2f * x); };
  EXPECT_GT(stays("clouds", round), 150);
  EXPECT_LT(stays("smoke", round), 60) << "smoke is wound up by nature";
  EXPECT_LT(stays("water", round), 60);
}

TEST(CarriedRenderer, AWhorlKeepsItsFormWhileItsStrokesGo) {
  // Three spiral arms, of dabs; a sixth of a turn, 1 s, would bring them to where gaps were.
  cv::Mat whorl(144, 144, CV_8U), dabs(144, 144, CV_8U), picture;
  cv::RNG(5).fill(dabs, cv::RNG::UNIFORM, 0, 80);
  for (int y = 0; y < whorl.rows; ++y)
    for (int x = 0; x < whorl.cols; ++x) {
      const double across = x - 71.5, down = y - 71.5;
      whorl.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(
          80 + 50 * std::sin(3 * std::atan2(down, across) + std::hypot(across, down) / 6) +
          dabs.at<std::uint8_t>(y, x));
    }
  cv::cvtColor(whorl, picture, cv::COLOR_GRAY2BGR);
  cv::Mat after =
      carried_by(picture, "clouds", [](float x, float y) { return cv::Vec2f(-1.2f * y, 1.2f * x); });
  cv::cvtColor(after, after, cv::COLOR_BGR2GRAY);
  // Of detail of this size: its correlation with the still's, and its strength beside it.
  const auto against_the_still = [&](double sigma) {
    cv::Mat one, other, wide, found;
    whorl.convertTo(one, CV_32F);
    after.convertTo(other, CV_32F);
    for (cv::Mat* plane : {&one, &other}) {
      cv::GaussianBlur(*plane, wide, {}, 2 * sigma, 2 * sigma);
      cv::GaussianBlur(*plane, *plane, {}, sigma, sigma);
      *plane = cv::Mat(*plane - wide)(cv::Rect(24, 24, 96, 96));
    }
    cv::matchTemplate(one, other, found, cv::TM_CCOEFF_NORMED);
    return std::pair(found.at<float>(0), cv::norm(other) / cv::norm(one));
  };
  const auto [form, form_strength] = against_the_still(4);
  const auto [dab, dab_strength] = against_the_still(0.8);
  EXPECT_GT(form, 0.2) << "with the shares of clouds alone -.67";
  EXPECT_LT(dab, 0.4);
  EXPECT_GT(form_strength, 0.5) << "arms that go lie in the gaps of those that stand";
  EXPECT_GT(dab_strength, 0.7);
}

TEST(CarriedRenderer, FluidIsHardlyShearedWherePatchesWentAtOtherSpeeds) {
  // Of what lies above, by how much it is faster. By the patches it goes by 2 px a frame.
  const auto faster_above = [](const char* class_name, float life_s, double lower) {
    double faster = 0;
    AnimateOptions options;
    options.frames = kFrames;
    options.motion_sink = [&](const cv::Mat& motion) {
      faster = motion.at<cv::Vec2f>(10, 240)[0] - motion.at<cv::Vec2f>(90, 240)[0];
    };
    animate_second(sky(480), {}, life_s, lower, class_name, options, [](const cv::Mat&) {});
    return faster;
  };
  EXPECT_LT(faster_above("water", 6, 0.25), 0.5) << "a body goes whole";
  EXPECT_LT(faster_above("water", 0.1f, 0.6), 0.25);
  EXPECT_GT(faster_above("water", 0.1f, 0.05), 0.6) << "what rests stays";
  EXPECT_GT(faster_above("fire", 0.1f, 0.6), 0.6) << "flames go apart";
}

TEST(CarriedRenderer, OfWatersDetailLessIsFollowedThanLives) {
  const auto half_life_s = [](const char* class_name, float life_s) {
    AnimateOptions options;
    options.frames = 2;
    return animate_second(sky(144), {}, life_s, 1, class_name, options, [](const cv::Mat&) {}).half_life_s;
  };
  EXPECT_NEAR(half_life_s("smoke", 1), 1, 0.01);
  EXPECT_NEAR(half_life_s("water", 1), 0.4, 0.01);
  EXPECT_NEAR(half_life_s("water", 0.5f), 0.25, 0.01);
  EXPECT_NEAR(half_life_s("water", 0.2f), 0.2, 0.01);
}

TEST(CarriedRenderer, FlamesDoNotComeAgainAsTheyWere) {
  cv::Mat picture(100, 480, CV_8UC3), coarse(25, 120, CV_8U);
  cv::RNG(3).fill(coarse, cv::RNG::UNIFORM, 60, 250);
  cv::resize(coarse, coarse, picture.size(), 0, 0, cv::INTER_CUBIC);
  cv::merge(std::vector<cv::Mat>(3, coarse), picture);
  // How like the still a frame becomes once more.
  const auto comes_again = [&](const char* class_name) {
    AnimateOptions options;
    options.frames = kFrames;
    options.method = CarriedOptions{};
    options.guide.direction = cv::Mat(picture.size(), CV_32FC2, cv::Scalar(1, 0));
    options.guide.speed = cv::Mat(picture.size(), CV_32F, cv::Scalar(200));
    std::vector<cv::Mat> frames;
    animate_second(picture, {}, 0.6f, 1, class_name, options,
                   [&](const cv::Mat& frame) { frames.push_back(frame.clone()); });
    const cv::Rect middle(120, 20, 240, 60);
    float most = -1;
    for (std::size_t i = 6; i < frames.size(); ++i) {
      cv::Mat like;
      cv::matchTemplate(frames[i](middle), frames[0](middle), like, cv::TM_CCOEFF_NORMED);
      most = std::max(most, like.at<float>(0, 0));
    }
    return most;
  };
  const float smoke = comes_again("smoke"), fire = comes_again("fire");
  EXPECT_GT(smoke, 0.6);
  EXPECT_LT(fire, smoke - 0.2f);
}

/// Dark water on which light stands: crumbs of it between these columns.
cv::Mat glittering(int from, int to) {
  cv::Mat picture(100, 480, CV_8UC3, cv::Scalar(40, 30, 15));
  cv::RNG random(5);
  for (int i = 0; i < 300; ++i)
    picture(cv::Rect(random.uniform(from, to), random.uniform(0, 98), 8, 2)) = cv::Scalar(150, 220, 240);
  return picture;
}

/// How far all frames but the first ones are like the next ones `right` px to the right, within these columns.
double goes_on(const std::vector<cv::Mat>& frames, int right, const cv::Range& columns) {
  double sum = 0;
  for (std::size_t i = 8; i + 1 < frames.size(); ++i) {
    cv::Mat like;
    cv::matchTemplate(frames[i + 1].colRange(columns.start + right, columns.end + right),
                      frames[i].colRange(columns), like, cv::TM_CCOEFF_NORMED);
    sum += like.at<float>(0, 0);
  }
  return sum / static_cast<double>(frames.size() - 9);
}

TEST(CarriedRenderer, SparklesAreLitAndGoOutInTheirPlace) {
  const cv::Mat picture = glittering(160, 320);
  const cv::Range path(190, 290);
  const std::vector<cv::Mat> frames = a_second_of(picture, 0.4f),
                             carried = a_second_of(picture, 0.4f, 1, {}, {.glitter = 0});
  EXPECT_GT(goes_on(frames, 0, path), goes_on(frames, kStep_px, path) + 0.2);
  EXPECT_LT(goes_on(carried, 0, path), goes_on(carried, kStep_px, path) - 0.2);
  const auto short_of_still = [&](const cv::Mat& frame) {
    cv::Mat apart;
    cv::absdiff(frame, picture, apart);
    return cv::mean(apart)[0];
  };
  EXPECT_LT(short_of_still(frames.front()), short_of_still(carried.front()) + 0.1) << "first the still";
  const auto light = [&](const cv::Mat& frame) { return cv::mean(frame.colRange(path))[2]; };
  EXPECT_NEAR(light(frames.back()) / light(picture), 1, 0.15) << "as much light as there was";
  cv::Mat like;
  cv::matchTemplate(frames.back().colRange(path), picture.colRange(path), like, cv::TM_CCOEFF_NORMED);
  EXPECT_LT(like.at<float>(0, 0), 0.5) << "other sparkles";
}

TEST(CarriedRenderer, WhereNothingGlittersFramesAreTheSame) {
  const cv::Mat picture = sky(144);
  EXPECT_EQ(cv::norm(a_second_of(picture, 0.4f).back(),
                     a_second_of(picture, 0.4f, 1, {}, {.glitter = 0}).back(), cv::NORM_INF),
            0);
}

TEST(CarriedRenderer, WhatIsThrownUpComesDownBesideItsCore) {
  cv::Mat noise(240, 144, CV_32F), picture;
  cv::RNG(3).fill(noise, cv::RNG::NORMAL, 120, 300);
  cv::GaussianBlur(noise, noise, {}, 1.5, 5);
  noise.convertTo(noise, CV_8U);
  cv::merge(std::vector<cv::Mat>(3, noise), picture);
  cv::Mat jet = cv::Mat::zeros(picture.size(), CV_8U);
  jet(cv::Rect(12, 40, 120, 200)).setTo(255);
  query::MotionGuide guide;
  guide.direction = cv::Mat(picture.size(), CV_32FC2, cv::Scalar(0, -1));
  const std::vector<cv::Mat> frames = a_second_of(picture, 0.4f, 1, {}, {}, jet, guide);
  // How much more frames are like the next ones some px further up than further down.
  const auto rises = [&](const cv::Range& columns) {
    double sum = 0;
    for (std::size_t i = 8; i + 1 < frames.size(); ++i)
      for (const int up : {3, -3}) {
        cv::Mat like;
        cv::matchTemplate(frames[i + 1](cv::Range(140 - up, 200 - up), columns),
                          frames[i](cv::Range(140, 200), columns), like, cv::TM_CCOEFF_NORMED);
        sum += like.at<float>(0, 0) * (up > 0 ? 1 : -1) / 16;
      }
    return sum;
  };
  EXPECT_GT(rises({56, 88}), 0.2);
  EXPECT_LT(rises({14, 28}), -0.2);
  EXPECT_LT(rises({116, 130}), -0.2);

  std::vector<cv::Mat> motions;
  const std::vector<cv::Mat> told = a_second_of(
      picture, 0.4f, 1, [&](const cv::Mat& motion) { motions.push_back(motion.clone()); }, {}, jet, guide);
  for (const cv::Mat& motion : motions) {
    EXPECT_LT(cv::mean(motion(cv::Range(140, 200), cv::Range(60, 84)))[1], 0);
    EXPECT_GT(cv::mean(motion(cv::Range(140, 200), cv::Range(16, 26)))[1], 0) << "its motion is what shows";
  }
  for (std::size_t i = 0; i < frames.size(); ++i)
    EXPECT_EQ(cv::norm(frames[i], told[i], cv::NORM_INF), 0) << "to tell it changes nothing: " << i;
}

}  // namespace
}  // namespace freshet::synth::animate
