// Flow between two stills with pins: beside the true displacement, beside obvious loops, and what is shown in between.
#include "synth/stills/between/pinned_flow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synth/stills/between/between.h"
#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

const cv::Size kPairSize(480, 320);

/// Two stills, and where what moves lies in the first.
struct MovedPair {
  cv::Mat a, b, middle;  // the truth half way
  cv::Mat mask;          // CV_8U: what moves, in the first
  cv::Point2f move;
};

/// A spotted ball of 11 px radius that leaps over 110 px of fine sand, which stands.
MovedPair leaping_ball() {
  MovedPair out{.a = made_ground(kPairSize),
                .b = {},
                .middle = {},
                .mask = cv::Mat(kPairSize, CV_8U, cv::Scalar(0)),
                .move = {110, -36}};
  out.b = out.a.clone();
  out.middle = out.a.clone();
  const auto draw = [](cv::Mat& picture, cv::Point at) {
    cv::circle(picture, at, 11, {40, 90, 240}, cv::FILLED, cv::LINE_AA);
    cv::circle(picture, at + cv::Point(-4, -3), 3, {250, 250, 250}, cv::FILLED, cv::LINE_AA);
    cv::circle(picture, at + cv::Point(3, 5), 2, {10, 10, 10}, cv::FILLED, cv::LINE_AA);
  };
  draw(out.a, {160, 180});
  draw(out.middle, {215, 162});
  draw(out.b, {270, 144});
  cv::circle(out.mask, {160, 180}, 11, 255, cv::FILLED);
  return out;
}

/// A window of stripes 16 px apart that goes 12 px to the right: by its looks it has gone 4 px to the left.
MovedPair sliding_stripes() {
  MovedPair out{.a = made_ground(kPairSize),
                .b = {},
                .middle = {},
                .mask = cv::Mat(kPairSize, CV_8U, cv::Scalar(0)),
                .move = {12, 0}};
  const cv::Rect window(150, 90, 180, 140);
  const auto with_stripes = [&](float moved) {
    cv::Mat picture = made_ground(kPairSize);
    for (int y = window.y; y < window.br().y; ++y)
      for (int x = window.x; x < window.br().x; ++x) {
        const double wave = std::sin(2 * CV_PI * (static_cast<float>(x) - moved) / 16);
        picture.at<cv::Vec3b>(y, x) = cv::Vec3b::all(cv::saturate_cast<std::uint8_t>(130 + 90 * wave));
      }
    return picture;
  };
  out.a = with_stripes(0);
  out.middle = with_stripes(6);
  out.b = with_stripes(12);
  out.mask(window).setTo(255);
  return out;
}

PinnedFlow pinned(const MovedPair& pair, const std::vector<FlowPin>& pins) {
  return pinned_flow(pair.a, pair.b, flow_between(pair.a, pair.b), pins);
}

FlowPin ball_pin(const MovedPair& pair) {
  return {.at = {160, 180}, .goes = cv::Point2f(160, 180) + pair.move, .reach = 40};
}

/// Share of the mask in which the flow is within `near` px of the true move.
double right(const cv::Mat& flow, const MovedPair& pair, float near, const cv::Mat& mask) {
  int count = 0, all = 0;
  for (int y = 0; y < flow.rows; ++y)
    for (int x = 0; x < flow.cols; ++x) {
      if (mask.at<std::uint8_t>(y, x) == 0) continue;
      const cv::Vec2f move = flow_at(flow, static_cast<float>(x), static_cast<float>(y));
      ++all;
      count += std::hypot(move[0] - pair.move.x, move[1] - pair.move.y) <= near;
    }
  return static_cast<double>(count) / all;
}

cv::Mat half_way(const Between& between, const MovedPair& pair) {
  return moment_picture(between.at(.5), pair.a, pair.b, cv::Rect({}, kPairSize));
}

double rms(const cv::Mat& picture, const cv::Mat& truth, const cv::Rect& box) {
  cv::Mat fa, fb;
  picture(box).convertTo(fa, CV_32F);
  truth(box).convertTo(fb, CV_32F);
  return std::sqrt(cv::norm(fa, fb, cv::NORM_L2SQR) / (3.0 * box.area()));
}

TEST(PinnedFlow, ASmallThingThatLeapsIsLostWithoutAPinAndFoundWithOne) {
  const MovedPair pair = leaping_ball();
  const FlowPair without = flow_between(pair.a, pair.b);
  EXPECT_LT(right(without.forth, pair, 2, pair.mask), .1);
  const PinnedFlow with = pinned(pair, {ball_pin(pair)});
  EXPECT_GT(right(with.flow.forth, pair, .5, pair.mask), .95);
  EXPECT_LT(cv::countNonZero(with.hidden_a > .5), 1.5 * cv::countNonZero(pair.mask))
      << "the sand does not go along";
}

TEST(PinnedFlow, HalfWayAThingIsShownOnce) {
  const MovedPair pair = leaping_ball();
  const FlowPair flow = flow_between(pair.a, pair.b);
  const cv::Mat without = half_way(Between(flow), pair);
  const cv::Mat with = half_way(Between(flow, pinned(pair, {ball_pin(pair)})), pair);
  for (const cv::Point middle : {cv::Point(160, 180), cv::Point(215, 162), cv::Point(270, 144)}) {
    const cv::Rect box(middle.x - 20, middle.y - 20, 40, 40);
    EXPECT_GT(rms(without, pair.middle, box), 15);
    EXPECT_LT(rms(with, pair.middle, box), 3) << "at " << middle;
  }
}

TEST(PinnedFlow, OfARepeatedPatternPinsSayWhichWayItWent) {
  const MovedPair pair = sliding_stripes();
  const FlowPair without = flow_between(pair.a, pair.b);
  cv::Mat inner;
  cv::erode(pair.mask, inner, cv::getStructuringElement(cv::MORPH_RECT, {41, 41}));
  EXPECT_LT(right(without.forth, pair, 2, inner), .3);
  const PinnedFlow with = pinned(pair, {{.at = {240, 160}, .goes = {252, 160}, .reach = 160}});
  EXPECT_GT(right(with.flow.forth, pair, 1, inner), .95);
  const cv::Rect middle(190, 120, 100, 80);
  EXPECT_GT(rms(half_way(Between(without), pair), pair.middle, middle), 30);
  EXPECT_LT(rms(half_way(Between(without, with), pair), pair.middle, middle), 6);
}

/// A cloth of three plain bands, each as high as it falls.
MovedPair falling_cloth() {
  MovedPair out{.a = made_ground(kPairSize),
                .b = {},
                .middle = {},
                .mask = cv::Mat(kPairSize, CV_8U, cv::Scalar(0)),
                .move = {0, 36}};
  out.b = out.a.clone();
  out.middle = out.a.clone();
  const auto draw = [](cv::Mat& picture, int top) {
    const cv::Scalar bands[3] = {{40, 30, 200}, {240, 240, 240}, {80, 140, 30}};
    for (int i = 0; i < 3; ++i)
      cv::rectangle(picture, cv::Rect(160, top + 36 * i, 150, 36), bands[i], cv::FILLED);
  };
  draw(out.a, 80);
  draw(out.middle, 98);
  draw(out.b, 116);
  out.mask(cv::Rect(160, 80, 150, 108)).setTo(255);
  return out;
}

TEST(PinnedFlow, WhatPinsEncloseGoesInOnePiece) {
  const MovedPair pair = falling_cloth();
  std::vector<FlowPin> pins;
  for (const cv::Point2f corner : {cv::Point2f(162, 82), {307, 82}, {162, 185}, {307, 185}})
    pins.push_back({.at = corner, .goes = corner + pair.move, .reach = 40});
  const FlowPair flow = flow_between(pair.a, pair.b);
  const PinnedFlow with = pinned(pair, pins);
  EXPECT_EQ(with.things.size(), 1u);
  const cv::Rect cloth(164, 84, 142, 100), box(150, 70, 170, 166);
  EXPECT_EQ(cv::countNonZero(with.hidden_a(cloth) > .9), cloth.area())
      << "no holes where colours meet themselves";
  EXPECT_LT(cv::countNonZero(with.hidden_a > .5), 1.3 * cv::countNonZero(pair.mask));
  EXPECT_GT(rms(half_way(Between(flow), pair), pair.middle, box), 10);
  EXPECT_LT(rms(half_way(Between(flow, with), pair), pair.middle, box), 3);
}

TEST(PinnedFlow, FindsNothingMoreOnceItIsToStop) {
  const MovedPair pair = leaping_ball();
  const std::vector<FlowPin> pins(1, {.at = {158, 177}, .goes = {269, 139}, .reach = 40});
  std::stop_source stop;
  const FlowPair flow = flow_between(pair.a, pair.b);
  EXPECT_EQ(pinned_flow(pair.a, pair.b, flow, pins, stop.get_token()).things.size(), 1u);
  stop.request_stop();
  EXPECT_TRUE(pinned_flow(pair.a, pair.b, flow, pins, stop.get_token()).things.empty());
}

TEST(PinnedFlow, FlowIsThePinsOwnAtThemAndLeadsBack) {
  const MovedPair pair = leaping_ball();
  // Off the true way by more than the pictures would let them, and between pixels.
  const std::vector<FlowPin> pins{{.at = {158.3f, 177.6f}, .goes = {269.1f, 139.9f}, .reach = 40},
                                  {.at = {60.5f, 250.2f}, .goes = {75.7f, 262.9f}, .reach = 30},
                                  {.at = {400, 60}, .goes = {371.5f, 88}, .reach = 30},
                                  {.at = {412, 70}, .goes = {380.4f, 100}, .reach = 30}};
  const PinnedFlow with = pinned(pair, pins);
  EXPECT_EQ(with.things.size(), 3u) << "the last two go as one";
  for (const FlowPin& pin : pins) {
    const cv::Vec2f forth = flow_at(with.flow.forth, pin.at.x, pin.at.y),
                    back = flow_at(with.flow.back, pin.goes.x, pin.goes.y);
    EXPECT_LT(std::hypot(forth[0] - pin.move().x, forth[1] - pin.move().y), .5) << pin.at;
    EXPECT_LT(std::hypot(back[0] + pin.move().x, back[1] + pin.move().y), .5) << pin.goes;
  }
  for (int y = 0; y < kPairSize.height; ++y)
    for (int x = 0; x < kPairSize.width; ++x) {
      if (with.hidden_a.at<float>(y, x) < .99f) continue;
      const auto px = static_cast<float>(x), py = static_cast<float>(y);
      const cv::Vec2f forth = flow_at(with.flow.forth, px, py),
                      round = flow_at(with.flow.back, px + forth[0], py + forth[1]) + forth;
      ASSERT_LT(std::hypot(round[0], round[1]), 1) << "at " << x << ", " << y << " both ways disagree";
    }
}

TEST(PinnedFlow, BeyondItsReachNothingChanges) {
  const MovedPair pair = leaping_ball();
  const FlowPair flow = flow_between(pair.a, pair.b);
  const PinnedFlow with = pinned(pair, {ball_pin(pair)});
  EXPECT_TRUE(cv::Rect(100, 84, 240, 160).contains(with.changed.tl()) &&
              cv::Rect(100, 84, 240, 160).contains(with.changed.br()))
      << with.changed;
  const auto differs = [&](const cv::Mat& one, const cv::Mat& other) {
    cv::Mat apart;
    cv::absdiff(one, other, apart);
    apart(with.changed).setTo(0);
    return cv::norm(apart, cv::NORM_INF);
  };
  EXPECT_EQ(differs(with.flow.forth, flow.forth), 0);
  EXPECT_EQ(differs(with.flow.back, flow.back), 0);
  EXPECT_EQ(differs(with.behind.forth, flow.forth), 0);
  // Pictures: beyond the window in which trust is judged, a fifth of the longer side.
  const cv::Rect whole({}, kPairSize);
  const cv::Mat before = moment_picture(Between(flow).at(.3), pair.a, pair.b, whole),
                after = moment_picture(Between(flow, with).at(.3), pair.a, pair.b, whole);
  for (const cv::Rect& far : {cv::Rect(0, 0, 40, 320), cv::Rect(430, 0, 50, 320)})
    EXPECT_EQ(cv::norm(before(far), after(far), cv::NORM_INF), 0);
}

TEST(PinnedFlow, BeginsAndEndsWithTheStills) {
  const MovedPair pair = leaping_ball();
  const Between between(flow_between(pair.a, pair.b), pinned(pair, {ball_pin(pair)}));
  const cv::Rect whole({}, kPairSize);
  EXPECT_EQ(rms(moment_picture(between.at(0), pair.a, pair.b, whole), pair.a, whole), 0);
  EXPECT_EQ(rms(moment_picture(between.at(1), pair.a, pair.b, whole), pair.b, whole), 0);
  const cv::Rect ball(140, 160, 40, 40), there(250, 124, 40, 40);
  EXPECT_LT(rms(moment_picture(between.at(.001), pair.a, pair.b, whole), pair.a, ball), 6)
      << "without a jump";
  EXPECT_LT(rms(moment_picture(between.at(.999), pair.a, pair.b, whole), pair.b, there), 3);
}

TEST(PinnedFlow, SixteenBitsShowTheSame) {
  const MovedPair pair = leaping_ball();
  const Moment moment = Between(flow_between(pair.a, pair.b), pinned(pair, {ball_pin(pair)})).at(.4);
  cv::Mat a, b;
  pair.a.convertTo(a, CV_16U, 257);
  pair.b.convertTo(b, CV_16U, 257);
  const cv::Rect whole({}, kPairSize);
  EXPECT_LT(
      rms(moment_picture(moment, a, b, whole) / 257, moment_picture(moment, pair.a, pair.b, whole), whole),
      1e-3);
}

TEST(PinnedFlow, PinsOfTwoThingsThatCrossAreApart) {
  const std::vector<FlowPin> pins{{.at = {100, 100}, .goes = {160, 100}, .reach = 30},
                                  {.at = {160, 104}, .goes = {100, 104}, .reach = 30},
                                  {.at = {112, 100}, .goes = {171, 101}, .reach = 30}};
  const std::vector<std::vector<FlowPin>> groups = joined_pins(pins);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].size(), 2u);
  EXPECT_EQ(groups[1][0].at, pins[1].at);
}

TEST(PinnedFlow, MismatchAgreesWithTheObviousLoops) {
  cv::Mat a(24, 30, CV_32FC3), b(24, 30, CV_32FC3);
  cv::RNG random(7);
  random.fill(a, cv::RNG::UNIFORM, 0, 60);
  random.fill(b, cv::RNG::UNIFORM, 0, 60);
  const cv::Mat fast = mismatch(a, b, 2);
  const auto mirrored = [](int at, int side) { return at < 0 ? -at : at >= side ? 2 * side - 2 - at : at; };
  for (int y = 0; y < a.rows; ++y)
    for (int x = 0; x < a.cols; ++x) {
      double sum = 0, weights = 0;
      for (int v = -8; v <= 8; ++v)
        for (int u = -8; u <= 8; ++u) {
          const double weight = std::exp(-(u * u + v * v) / 8.0);
          const cv::Vec3f apart = a.at<cv::Vec3f>(mirrored(y + v, a.rows), mirrored(x + u, a.cols)) -
                                  b.at<cv::Vec3f>(mirrored(y + v, a.rows), mirrored(x + u, a.cols));
          sum += weight * std::min(900.0f, apart.dot(apart) / 3);
          weights += weight;
        }
      ASSERT_NEAR(fast.at<float>(y, x), sum / weights, 1e-3 * sum / weights);
    }
}

TEST(PinnedFlow, AMomentAgreesWithTheObviousSearch) {
  const MovedPair pair = leaping_ball();
  const PinnedFlow with = pinned(pair, {ball_pin(pair)});
  const Moment moment = Between(flow_between(pair.a, pair.b), with).at(.5);
  const CarriedThing& thing = with.things[0];
  int met = 0;
  for (int y = 0; y < moment.size.height; ++y)
    for (int x = 0; x < moment.size.width; ++x) {
      const Moment::Source& front = moment.front[static_cast<std::size_t>(y) * moment.size.width + x];
      if (front.trust < .9f) continue;
      // Of all pixels of the thing the one that comes nearest.
      const cv::Point2f at(2 * x + .5f, 2 * y + .5f);
      float nearest = 1e9f;
      cv::Point2f from;
      for (int v = 0; v < thing.box.height; ++v)
        for (int u = 0; u < thing.box.width; ++u) {
          const cv::Vec2f move = thing.move.at<cv::Vec2f>(v, u);
          const cv::Point2f start = cv::Point2f(thing.box.tl()) + cv::Point2f(u, v);
          const cv::Point2f apart = start + .5f * cv::Point2f(move[0], move[1]) - at;
          if (std::hypot(apart.x, apart.y) < nearest) nearest = std::hypot(apart.x, apart.y), from = start;
        }
      ++met;
      EXPECT_LT(std::hypot(at.x + front.a[0] - from.x, at.y + front.a[1] - from.y), 1.2) << at;
    }
  EXPECT_GT(met, 60);
}

TEST(PinnedMotion, TurnsAndStretchesWhatIsBetweenPins) {
  // A turn by a tenth about (200, 150), and a stretch.
  const auto moved = [](cv::Point2f at) {
    const cv::Point2f from = at - cv::Point2f(200, 150);
    return cv::Point2f(.1f * from.x - .1f * from.y + 12, .1f * from.x - 5);
  };
  std::vector<FlowPin> pins;
  for (const cv::Point2f at : {cv::Point2f(120, 90), {280, 95}, {125, 210}, {275, 220}})
    pins.push_back({.at = at, .goes = at + moved(at), .reach = 40});
  const PinnedMotion motion(pins);
  for (int y = 110; y <= 200; y += 15)
    for (int x = 140; x <= 260; x += 15) {
      const cv::Point2f at(static_cast<float>(x), static_cast<float>(y)), off = motion.move(at) - moved(at);
      EXPECT_LT(std::hypot(off.x, off.y), .3) << at;
      EXPECT_TRUE(motion.encloses(at));
    }
  EXPECT_FALSE(motion.encloses({100, 150}));
}

TEST(PinnedMotion, IsThePinsOwnAtThemAndNothingBeyondTheirReach) {
  const std::vector<FlowPin> pins{{.at = {100, 100}, .goes = {130, 100}, .reach = 20},
                                  {.at = {160, 100}, .goes = {194, 104}, .reach = 20}};
  const PinnedMotion motion(pins);
  for (const FlowPin& pin : pins) {
    const cv::Point2f off = motion.move(pin.at) - pin.move();
    EXPECT_LT(std::hypot(off.x, off.y), 1e-3);
    EXPECT_EQ(motion.nearness(pin.at), 1);
  }
  EXPECT_EQ(motion.nearness({130, 100}), 1) << "on the line between them";
  EXPECT_FLOAT_EQ(motion.nearness({130, 110}), .5f);
  EXPECT_EQ(motion.nearness({100, 121}), 0);
  EXPECT_EQ(motion.box(kPairSize), cv::Rect(80, 80, 101, 41));
  const cv::Point2f between = motion.move({130, 100});
  EXPECT_FLOAT_EQ(between.x, 32);
  EXPECT_FLOAT_EQ(between.y, 2);
}

}  // namespace
}  // namespace freshet::synth::stills
