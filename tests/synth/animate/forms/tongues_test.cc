#include "synth/animate/forms/tongues.h"

#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "synth/animate/forms/light_level.h"
#include "tests/synth/animate/forms/burnt_film.h"
#include "tests/synth/animate/measured_clip.h"

namespace freshet::synth::animate {
namespace {

const cv::Size kPictureSize(200, 160);

/// A candle's flame: an upright ellipse, soft at its rim.
cv::Mat candle(double lean = 0, double height = 80) {
  cv::Mat level = cv::Mat::zeros(kPictureSize, CV_32F);
  for (int y = 0; y < kPictureSize.height; ++y) {
    const double up = (130 - y) / height;
    if (up < 0 || up > 1) continue;
    const double half = 12 * std::sqrt(1 - std::pow(2 * up - 1, 2));
    cv::line(level, cv::Point2d(100 + lean * height * up - half, y),
             cv::Point2d(100 + lean * height * up + half, y), cv::Scalar(0.95));
  }
  cv::GaussianBlur(level, level, {}, 1.5);
  return level;
}

/// Column where a row's light is.
double centre_of(const cv::Mat& light, int row) {
  double sum = 0, all = 0;
  for (int x = 0; x < light.cols; ++x) {
    sum += x * light.at<float>(row, x);
    all += light.at<float>(row, x);
  }
  return sum / all;
}

int top_of(const cv::Mat& light) { return cv::boundingRect(light > 0.2).y; }

TEST(Tongues, ACandlesFlameIsOneAndAWideARaggedAndATexturedOneAreNot) {
  const std::vector<Tongue> tongues = tongues_of(candle());
  ASSERT_EQ(tongues.size(), 1);
  EXPECT_NEAR(tongues[0].box.y + tongues[0].foot, 131, 3);
  EXPECT_NEAR(tongues[0].height, 81, 4);
  EXPECT_GT(share_of_light(tongues, candle()), 0.95);

  cv::Mat wide = cv::Mat::zeros(kPictureSize, CV_32F), ragged = candle(), textured = candle();
  cv::ellipse(wide, {100, 100}, {36, 44}, 0, 0, 360, cv::Scalar(0.95), cv::FILLED);
  EXPECT_TRUE(tongues_of(wide).empty());
  for (const int x : {70, 130})
    cv::ellipse(ragged, {x, 95}, {14, 30}, x < 100 ? 30 : -30, 0, 360, cv::Scalar(0.9), cv::FILLED);
  EXPECT_TRUE(tongues_of(ragged).empty());
  for (int y = 40; y < 130; y += 8) textured.rowRange(y, y + 4) *= 0.5;
  EXPECT_TRUE(tongues_of(textured).empty());
}

TEST(Tongues, ARimThatCrossesAFlameIsNoneOfIt) {
  cv::Mat level = candle();
  cv::line(level, {20, 110}, {180, 110}, cv::Scalar(0.8), 3);
  const std::vector<Tongue> tongues = tongues_of(level);
  ASSERT_EQ(tongues.size(), 1);
  EXPECT_NEAR(tongues[0].height, 81, 4);
}

TEST(Tongues, SwayAboutTheirFoot) {
  const cv::Mat light = candle();
  const Tongue tongue = tongues_of(light).front();
  const cv::Mat own = light(tongue.box).mul(tongue.share);
  const int foot = static_cast<int>(tongue.foot), half = foot - 40;
  const auto aside = [&](const Sway& sway, int row) {
    return centre_of(swayed(own, tongue, sway), row) - centre_of(own, row);
  };
  // At half its height: lean / 2 and bow / 4 of its height.
  EXPECT_NEAR(aside({.lean = 0.2, .bow = 0, .stretch = 1}, half), 0.5 * 0.2 * tongue.height, 0.6);
  EXPECT_NEAR(aside({.lean = 0, .bow = 0.2, .stretch = 1}, half), 0.25 * 0.2 * tongue.height, 0.6);
  EXPECT_NEAR(aside({.lean = 0.2, .bow = 0.2, .stretch = 1}, foot - 1), 0, 0.3);
  const double taller = top_of(own) - top_of(swayed(own, tongue, {.lean = 0, .bow = 0, .stretch = 1.25}));
  EXPECT_NEAR(taller, 0.25 * tongue.height, 2);
  EXPECT_EQ(cv::norm(swayed(own, tongue, {}), own, cv::NORM_INF), 0);
}

/// A clip whose flame leans from side to side, and is lower for its second half.
ClipForms swaying() {
  ClipForms forms{};
  forms.fps = 20;
  forms.mean = cv::Mat::zeros(kPictureSize, CV_32F);
  for (int i = 0; i < 40; ++i) {
    const cv::Mat level = candle(0.2 * std::sin(i * 2 * CV_PI / 40), i < 20 ? 80 : 64);
    cv::Mat bytes;
    level.convertTo(bytes, CV_8U, 255);
    forms.levels.push_back(bytes);
    forms.mean += level / 40;
  }
  forms.seats = seats_of(forms.mean);
  return forms;
}

TEST(TongueCourse, IsHowAClipsFlameLeansAndLeaps) {
  const std::optional<TongueCourse> course = course_of(swaying());
  ASSERT_TRUE(course.has_value());
  EXPECT_EQ(course->tongue, 1);
  const auto tip = [&](double at) {
    return course->at(at).lean + course->at(at).bow;
  };  // of a height of 80 px
  EXPECT_NEAR(tip(0.5) - tip(1.5), 0.2 + 0.2 * 64 / 80, 0.04);
  EXPECT_NEAR(course->at(0.5).stretch / course->at(1.5).stretch, 80.0 / 64, 0.05);
}

TEST(TongueCourse, GoesBackAsItCame) {
  TongueCourse course{.clip = {}, .fps = 10, .sways = {}, .tongue = 1};
  for (const double lean : {0.0, 0.1, 0.2}) course.sways.push_back({.lean = lean, .bow = 0, .stretch = 1});
  EXPECT_NEAR(course.at(0.05).lean, 0.05, 1e-9);
  EXPECT_NEAR(course.at(0.2).lean, 0.2, 1e-9);
  EXPECT_NEAR(course.at(0.3).lean, 0.1, 1e-9);
  EXPECT_NEAR(course.at(0.4).lean, 0, 1e-9);
  EXPECT_NEAR(course.at(4.5).lean, course.at(0.1).lean, 1e-9);
  course.sways.resize(1);
  EXPECT_EQ(course.at(3).lean, 0);
}

TEST(TongueCourse, ComesHalfwayToAsRestlessAsFlamesUsuallyAre) {
  for (const double lean : {0.002, 0.2}) {
    TongueCourse course{.clip = {}, .fps = 10, .sways = {}, .tongue = 1};
    for (int i = 0; i < 40; ++i)
      course.sways.push_back({.lean = i % 2 == 0 ? lean : -lean, .bow = 0, .stretch = 1});
    const double unrest = 10 * 39 * 2 * lean / 40;
    EXPECT_NEAR(course.unrest(), unrest, 1e-9);
    EXPECT_NEAR(halfway_to_usual(course).unrest(), std::sqrt(unrest * kUsualUnrest), 1e-9);
  }
  TongueCourse tall{
      .clip = {}, .fps = 10, .sways = {{.lean = 0, .bow = 0, .stretch = 1.01}, {}}, .tongue = 1};
  EXPECT_NEAR(halfway_to_usual(tall).sways[0].stretch, 1 + 0.01 * std::sqrt(kUsualUnrest / 0.05), 1e-9);
  tall.sways = {{}, {}};
  EXPECT_EQ(halfway_to_usual(tall).unrest(), 0);
}

TEST(TongueCourse, IsAsFastAsAsked) {
  TongueCourse course{.clip = {}, .fps = 10, .sways = {}, .tongue = 1};
  for (int i = 0; i < 40; ++i)
    course.sways.push_back({.lean = i % 2 == 0 ? 0.05 : -0.05, .bow = 0, .stretch = 1});
  const double speed = 10 * 0.1 / 2;  // half way up, from frame to frame
  EXPECT_NEAR(course.speed(), speed, 1e-9);
  EXPECT_NEAR(as_fast_as(course, 0.2 * speed).speed(), 0.2 * speed, 1e-9);
  EXPECT_EQ(as_fast_as(course, 0.2 * speed).fps, 10);
  const TongueCourse faster = as_fast_as(course, 10.5 * speed);
  EXPECT_NEAR(faster.speed(), 10.5 * speed, 1e-9);
  EXPECT_NEAR(faster.sways[0].lean, kMostSway, 1e-9);
  EXPECT_NEAR(faster.fps, 15, 1e-9);
  EXPECT_NEAR(as_fast_as(course, 1000).fps, 10 * kQuickest, 1e-9);
  const TongueCourse still = as_fast_as(course, 0);
  EXPECT_EQ(still.speed(), 0);
  EXPECT_EQ(still.fps, 10);
  course.sways[7].bow = kMostSway;  // one that is cut off does not bind the others
  EXPECT_NEAR(as_fast_as(course, 4 * speed).sways[0].lean, 4 * 0.05, 0.02);
  course.sways = {{.lean = 0, .bow = 0.3, .stretch = 1.2}, {}};
  EXPECT_NEAR(course.speed(), 10 * std::hypot(0.1, 0.1),
              0.05);  // means of up^2 and of up: a third and a half
  course.sways = {{}, {}};
  EXPECT_EQ(as_fast_as(course, 1).speed(), 0);
}

TEST(Tongues, ShareOfLightIsLessWhatTheyLightBelow) {
  cv::Mat lit = candle(), burning = candle();
  const auto textured = [](cv::Mat where) {
    for (int y = 0; y < where.rows; ++y)
      for (int x = 0; x < where.cols; ++x) where.at<float>(y, x) = (x / 5 + y / 5) % 2 == 0 ? 1.0f : 0.4f;
  };
  const cv::Rect below(30, 133, 140, 27), far(0, 0, 6, 160);
  lit(below).setTo(0.8);
  EXPECT_GT(share_of_light(tongues_of(lit), lit), 0.9);
  textured(burning(below));
  EXPECT_LT(share_of_light(tongues_of(burning), burning), 0.5);
  textured(lit(far));
  EXPECT_LT(share_of_light(tongues_of(lit), lit), 0.9);
}

TEST(TongueCourse, OfAClipThatDoesNotShineIsNone) {
  ClipForms dark{};
  dark.levels.emplace_back(cv::Mat::zeros(kPictureSize, CV_8U));
  EXPECT_FALSE(course_of(dark).has_value());
}

/// A candle's flame before a dark wall, and where it burns. glow: the level around its foot, less above.
cv::Mat candle_picture(double glow = 0) {
  cv::Mat level = candle(), around;
  cv::GaussianBlur(level, around, {}, 12);
  for (int y = 0; y < around.rows; ++y) around.row(y) *= glow * std::min(1.0, std::pow(y / 130.0, 3));
  cv::max(level, around, level);
  cv::Mat out(kPictureSize, CV_8UC3);
  for (int y = 0; y < kPictureSize.height; ++y)
    for (int x = 0; x < kPictureSize.width; ++x) {
      const float l = level.at<float>(y, x);
      out.at<cv::Vec3b>(y, x) = {cv::saturate_cast<std::uint8_t>(30 + 60 * l),
                                 cv::saturate_cast<std::uint8_t>(20 + 200 * l),
                                 cv::saturate_cast<std::uint8_t>(15 + 240 * l)};
    }
  return out;
}

/// Frames of a picture animated with its own flame; speed in px/s, none: not asked.
struct CandleFilm {
  AnimateReport report;
  std::vector<cv::Mat> frames;
};

CandleFilm film_of(const cv::Mat& picture, std::optional<double> speed = {}, int frames = 30) {
  FlowingClip clip = BurningClip{}.clip();
  clip.steady = {0, -1.6f};
  clip.varying = 0.4f;
  const FlowingStore store({measured(clip)});
  AnimateOptions options;
  options.frames = frames;
  if (speed) options.guide.speed = cv::Mat(kPictureSize, CV_32F, cv::Scalar(*speed));
  CandleFilm film;
  film.report = animate(store.snapshot(), store.settings(), picture,
                        cv::Mat(kPictureSize, CV_8U, cv::Scalar(255)), placed(store.id()), options,
                        [&](const cv::Mat& frame) { film.frames.push_back(frame.clone()); });
  EXPECT_EQ(film.report.sways_as, store.id());
  return film;
}

cv::Mat redness(const cv::Mat& frame) {
  cv::Mat red;
  cv::extractChannel(frame, red, 2);
  cv::Mat(red - 15).convertTo(red, CV_32F, 1.0 / 240);
  return red;
}

/// The row, between pixels, where a flame begins.
double tip_of(const cv::Mat& light) {
  const int top = top_of(light);
  double here = 0, above = 0;
  cv::minMaxLoc(light.row(top), nullptr, &here);
  cv::minMaxLoc(light.row(top - 1), nullptr, &above);
  return top - (here - 0.2) / (here - above);
}

/// px/s: how fast the body of its flame goes, from a quarter of its height to three, once it has left the still.
double speed_of(const CandleFilm& film) {
  constexpr int kFoot = 131;
  double sum = 0;
  int count = 0;
  for (std::size_t i = 10; i < film.frames.size(); ++i) {
    const cv::Mat before = redness(film.frames[i - 1]), now = redness(film.frames[i]);
    const double tops[] = {tip_of(before), tip_of(now)};
    for (const double up : {0.25, 0.5, 0.75}) {
      const int rows[] = {kFoot - static_cast<int>(up * (kFoot - tops[0])),
                          kFoot - static_cast<int>(up * (kFoot - tops[1]))};
      sum += std::hypot(centre_of(now, rows[1]) - centre_of(before, rows[0]), up * (tops[1] - tops[0]));
      ++count;
    }
  }
  return AnimateOptions{}.fps * sum / count;
}

TEST(OwnFlames, ACandleSwaysInOnePiece) {
  const cv::Mat picture = candle_picture();
  const auto [report, frames] = film_of(picture);
  EXPECT_EQ(report.tongues, 1);
  EXPECT_EQ(apart(frames[0], picture), 0);
  const auto burns = [](const cv::Mat& frame) {
    cv::Mat red;
    cv::extractChannel(frame, red, 2);
    return cv::Mat(red > 130);
  };
  double moved = 0;
  for (const cv::Mat& frame : frames) {
    cv::Mat parts;
    EXPECT_EQ(cv::connectedComponents(burns(frame), parts), 2);  // the dark, and the flame
    EXPECT_GT(cv::countNonZero(burns(frame)), 0.6 * cv::countNonZero(burns(picture)));
    moved = std::max(moved, apart(frame(cv::Rect(60, 40, 80, 60)), picture(cv::Rect(60, 40, 80, 60))));
    EXPECT_LT(apart(frame(cv::Rect(90, 136, 20, 20)), picture(cv::Rect(90, 136, 20, 20))), 12);
  }
  EXPECT_GT(moved, 60);
}

TEST(OwnFlames, ACandleGoesAsFastAsAsked) {
  const cv::Mat picture = candle_picture();
  for (const double asked : {20.0, 40.0})
    EXPECT_NEAR(speed_of(film_of(picture, asked, 90)), asked, 0.3 * asked);
  const CandleFilm still = film_of(picture, 0);
  for (const cv::Mat& frame : still.frames)
    EXPECT_LT(apart(frame(cv::Rect(60, 40, 80, 60)), picture(cv::Rect(60, 40, 80, 60))), 12);
}

TEST(OwnFlames, WaxThatACandleLightsStands) {
  cv::Mat picture = candle_picture();
  const cv::Rect wax(60, 133, 80, 27);
  picture(wax).setTo(cv::Scalar(40, 200, 250));
  EXPECT_GT(cv::sum(redness(picture)(wax))[0], 1.2 * cv::sum(redness(picture).rowRange(0, wax.y))[0]);
  const CandleFilm film = film_of(picture);
  EXPECT_EQ(film.report.tongues, 1);
  const cv::Rect within(wax.x + 3, wax.y + 8, wax.width - 6, wax.height - 10);
  for (const cv::Mat& frame : film.frames) EXPECT_LT(apart(frame(within), picture(within)), 12);
}

TEST(OwnFlames, NothingOfACandleStaysWhereItSwayedAwayFrom) {
  const cv::Mat picture = candle_picture(0.9), was = redness(picture) > 0.4;
  const CandleFilm film = film_of(picture, 60);
  cv::Mat nearer, farther;
  cv::dilate(was, nearer, cv::Mat(), {-1, -1}, 3);
  cv::dilate(was, farther, cv::Mat(), {-1, -1}, 7);
  const cv::Mat beside = farther & ~nearer;
  int left = 0;
  for (const cv::Mat& frame : film.frames) {
    cv::Mat near;
    cv::dilate(redness(frame) > 0.4, near, cv::Mat(), {-1, -1}, 3);
    const cv::Mat empty = was & ~near, around = beside & ~near;
    for (int y = 0; y < 120; ++y) {
      const cv::Mat here = empty.row(y), there = around.row(y);
      if (cv::countNonZero(here) == 0 || cv::countNonZero(there) == 0) continue;
      left += cv::countNonZero(here);
      const cv::Scalar colour = cv::mean(frame.row(y), here), usual = cv::mean(frame.row(y), there);
      for (int k = 0; k < 3; ++k) EXPECT_LT(std::abs(colour[k] - usual[k]), 4.2) << k << ' ' << y;
    }
  }
  EXPECT_GT(left, 50);
}

TEST(OwnFlames, ACloseCandleInABrightGlowLeavesNoHole) {
  cv::Mat level = candle();
  cv::max(level, 0.3, level);
  cv::Mat picture(kPictureSize, CV_8UC3);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const float l = level.at<float>(y, x);
      picture.at<cv::Vec3b>(y, x) = {cv::saturate_cast<std::uint8_t>(60 * l),
                                     cv::saturate_cast<std::uint8_t>(170 * l),
                                     cv::saturate_cast<std::uint8_t>(255 * l)};
    }
  const double darkest = 0.3 * 255;
  for (const cv::Mat& frame : film_of(picture, 60).frames) {
    double least = 0;
    cv::Mat red;
    cv::extractChannel(frame.rowRange(0, 125), red, 2);
    cv::minMaxLoc(red, &least);
    EXPECT_GT(least, 0.5 * darkest);
  }
}

}  // namespace
}  // namespace freshet::synth::animate
