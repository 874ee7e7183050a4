#include "synth/scene/frames/footage_frames.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/sampling/bilinear.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::synth::scene {
namespace {

namespace fs = std::filesystem;

/// A folder of grey frames of these values.
class Sequence {
 public:
  explicit Sequence(const std::vector<int>& greys) {
    for (std::size_t i = 0; i < greys.size(); ++i)
      cv::imwrite((folder_ / fmt::format("{:03}.png", i)).string(),
                  cv::Mat(4, 6, CV_8UC3, cv::Scalar::all(greys[i])));
  }
  /// What a scene of a frame a second shows of it; -1: nothing.
  std::vector<double> shown(int frames, bool loop, int asked, int start = 0, bool repeats = true) const {
    FootageMotion motion{.file = folder_.path()};
    motion.start_s = start, motion.repeats = repeats;
    FootageFrames footage(motion, frames, 1, loop);
    std::vector<double> out;
    for (int i = 0; i < asked; ++i) {
      const cv::Mat& frame = footage.next();
      out.push_back(frame.empty() ? -1 : 255 * frame.at<cv::Vec4f>(1, 1)[0]);
    }
    return out;
  }
  const std::filesystem::path& path() const { return folder_.path(); }
  cv::Mat first(int width) const {
    FootageFrames footage({.file = folder_.path(), .at = {0, 0}, .width = width}, 2, 25, false);
    return footage.next().clone();
  }

 private:
  ScratchFolder folder_;
};

double greatest_step(const std::vector<double>& values) {
  double most = 0;
  for (std::size_t i = 1; i < values.size(); ++i) most = std::max(most, std::abs(values[i] - values[i - 1]));
  return most;
}

std::vector<int> ramp(int frames, int step) {
  std::vector<int> out(static_cast<std::size_t>(frames));
  for (int i = 0; i < frames; ++i) out[static_cast<std::size_t>(i)] = step * i;
  return out;
}

TEST(FootageFrames, EachCourseAndWhatFadesBelowItLieInTheFootage) {
  for (const int scene : {2, 3, 10, 24, 99, 100})
    for (int footage = 1; footage < 140; ++footage)
      for (const bool loop : {false, true})
        for (const bool comes_round : {false, true}) {
          const FootageCourse course = footage_course(scene, loop, footage, comes_round);
          EXPECT_EQ(std::accumulate(course.lengths.begin(), course.lengths.end(), 0), scene);
          const auto [shortest, longest] = std::minmax_element(course.lengths.begin(), course.lengths.end());
          EXPECT_GE(*shortest, 1);
          EXPECT_GE(course.fade, 0);
          if (!comes_round && footage > 1) {
            EXPECT_LE(*longest + course.fade, std::max(footage, loop ? 0 : scene)) << scene << " " << footage;
          }
          if (!comes_round && loop && scene > 4 && footage > 4) {
            EXPECT_GE(course.fade, 1) << scene << " " << footage;
          }
        }
}

TEST(FootageFrames, ShorterThanALoopItComesRoundWithoutAJump) {
  const Sequence sequence(ramp(20, 10));
  const std::vector<double> shown = sequence.shown(30, true, 61);
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(shown[i], shown[i + 30]);
  EXPECT_EQ(shown[0], shown[60]);
  // From 140 or so to 0 in as many frames as fade; at once it would be a step of 190.
  EXPECT_LT(greatest_step(shown), 45);
  EXPECT_GT(*std::max_element(shown.begin(), shown.end()), 100);
}

TEST(FootageFrames, LongerThanALoopItGoesOverIntoItsBeginning) {
  const Sequence sequence(ramp(40, 6));
  const std::vector<double> shown = sequence.shown(30, true, 60);
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(shown[i], shown[i + 30]);
  EXPECT_LT(greatest_step(shown), 25);
}

TEST(FootageFrames, WithoutALoopItIsPlayedAsItIs) {
  const Sequence sequence(ramp(20, 10));
  const std::vector<double> shown = sequence.shown(20, false, 20);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_NEAR(shown[i], 10.0 * static_cast<double>(i), 1e-3);
  EXPECT_LT(greatest_step(sequence.shown(50, false, 50)), 45);
}

TEST(FootageFrames, WhatComesRoundIsNotFaded) {
  std::vector<int> wave;
  for (int i = 0; i < 20; ++i) wave.push_back(10 * std::min(i, 20 - i));
  const Sequence sequence(wave);
  for (const bool loop : {false, true}) {
    const std::vector<double> shown = sequence.shown(40, loop, 40);
    for (std::size_t i = 0; i < 40; ++i) EXPECT_NEAR(shown[i], wave[i % 20], 1e-3);
  }
  const std::vector<double> shown = sequence.shown(50, true, 100);
  EXPECT_EQ(shown[3], shown[53]);
  EXPECT_LT(greatest_step(shown), 25);
}

TEST(FootageFrames, NothingIsSeenBeforeTheStartAndAfterWhatPlaysOnce) {
  const Sequence sequence({10, 20, 30, 40});
  using testing::DoubleNear, testing::ElementsAreArray;
  const auto are = [](std::vector<double> values) {
    std::vector<testing::Matcher<double>> near;
    for (const double value : values) near.push_back(DoubleNear(value, 1e-3));
    return ElementsAreArray(near);
  };
  EXPECT_THAT(sequence.shown(8, false, 8, 3, false), are({-1, -1, -1, 10, 20, 30, 40, -1}));
  EXPECT_THAT(sequence.shown(6, false, 6, 3, false), are({-1, -1, -1, 10, 20, 30}));
  EXPECT_THAT(sequence.shown(6, false, 6, 3, true), are({-1, -1, -1, 10, 20, 30}));
  EXPECT_THAT(sequence.shown(7, true, 14, 1, false),
              are({-1, 10, 20, 30, 40, -1, -1, -1, 10, 20, 30, 40, -1, -1}));
  // It goes on over the end of the loop.
  EXPECT_THAT(sequence.shown(7, true, 14, 5, false),
              are({30, 40, -1, -1, -1, 10, 20, 30, 40, -1, -1, -1, 10, 20}));
}

TEST(FootageFrames, InALoopALaterStartShowsTheSameRoundLater) {
  for (const int length : {7, 20, 33}) {
    const Sequence sequence(ramp(length, 6));
    const std::vector<double> at_once = sequence.shown(20, true, 40), later = sequence.shown(20, true, 60, 8);
    for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(later[i + 8], at_once[i]) << length << " " << i;
    for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(later[i + 20], later[i]) << length << " " << i;
  }
}

TEST(FootageFrames, AreAsWideAsIsAsked) {
  const Sequence sequence({40, 80});
  EXPECT_EQ(sequence.first(0).size(), cv::Size(6, 4));
  EXPECT_EQ(sequence.first(12).size(), cv::Size(12, 8));
  EXPECT_EQ(sequence.first(3).size(), cv::Size(3, 2));
  EXPECT_EQ(sequence.first(1).size(), cv::Size(1, 1));
  EXPECT_NEAR(255 * sequence.first(12).at<cv::Vec4f>(4, 5)[0], 40, 0.01);
}

/// A texture that goes by a step a frame, comes round after kRound frames, and fades out towards its rim.
class Going {
 public:
  static constexpr int kRound = 16, kWidth = 64, kHeight = 48, kStep = 4;  // frames, px
  /// frames   how many of them the film has.
  explicit Going(int frames, bool alpha = false) {
    cv::Mat noise(kHeight, 3 * kWidth, CV_8UC3), tile = noise.colRange(0, kWidth);
    cv::RNG(7).fill(tile, cv::RNG::UNIFORM, 0, 256);
    for (int i = 1; i < 3; ++i) tile.copyTo(noise.colRange(i * kWidth, (i + 1) * kWidth));
    cv::GaussianBlur(noise, noise, {}, 2.0);
    noise.convertTo(noise, CV_8U, 4, -384);
    for (int i = 0; i < frames; ++i) {
      const int x = kWidth - kStep * (i % kRound);
      cv::Mat frame = noise.colRange(x, x + kWidth).clone();
      if (alpha) {
        cv::Mat outline(frame.size(), CV_8U, cv::Scalar(0));
        cv::ellipse(outline, {kWidth / 2, kHeight / 2}, {26, 20}, 0, 0, 360, 255, -1);
        cv::cvtColor(frame, frame, cv::COLOR_BGR2BGRA);
        cv::insertChannel(outline, frame, 3);
      }
      cv::imwrite((folder_ / fmt::format("{:03}.png", i)).string(), frame);
    }
  }
  FootageMotion footage(int width = 0) const { return {.file = folder_.path(), .width = width}; }

 private:
  ScratchFolder folder_;
};

/// How much nearer each frame is to the next when its motion carries it, a share of how near it is as it stands: the
/// greatest of `frames` steps. speed   px a frame, the mean of all.
struct Carried {
  double worst = 0, speed = 0;
};
Carried carried(FootageFrames& footage, int frames) {
  Carried result;
  cv::Mat now = footage.next().clone();
  for (int i = 0; i < frames; ++i) {
    const std::optional<cv::Mat> motion = footage.motion();
    EXPECT_TRUE(motion && motion->type() == CV_32FC2 && motion->size() == now.size());
    const cv::Mat next = footage.next().clone();
    double moved = 0, stood = 0, speed = 0;
    int pixels = 0;
    for (int y = 4; y < now.rows - 4; ++y)
      for (int x = 4; x < now.cols - 4; ++x) {
        const cv::Vec2f by = motion->at<cv::Vec2f>(y, x);
        const float to_x = static_cast<float>(x) + by[0], to_y = static_cast<float>(y) + by[1];
        const auto from = now.at<cv::Vec4f>(y, x), to = sampling::bilinear<cv::Vec4f>(next, to_x, to_y);
        if (from[3] < 0.99f || to[3] < 0.99f || to_x > static_cast<float>(now.cols - 4)) continue;
        moved += std::abs(to[1] - from[1]);
        stood += std::abs(next.at<cv::Vec4f>(y, x)[1] - from[1]);
        speed += cv::norm(by);
        ++pixels;
      }
    EXPECT_GT(pixels, 100);
    result.worst = std::max(result.worst, stood > 0 ? moved / stood : 1);
    result.speed += speed / pixels / frames;
    now = next;
  }
  return result;
}

TEST(FootageFrames, MotionLeadsToTheNextFrameAtEveryWidth) {
  for (const bool alpha : {false, true}) {
    const Going film(Going::kRound, alpha);
    for (const int width : {0, 40, 96})
      for (const bool loop : {false, true}) {
        SCOPED_TRACE(fmt::format("alpha {} width {} loop {}", alpha, width, loop));
        FootageFrames footage(film.footage(width), Going::kRound, 25, loop);
        // In a loop on over the end of the film, which runs into its beginning.
        const Carried found = carried(footage, loop ? Going::kRound + 2 : Going::kRound - 1);
        EXPECT_LT(found.worst, 0.4);
        const double scale = width == 0 ? 1 : 1.0 * width / Going::kWidth;
        // An outline that stands holds what goes by at its rim.
        const double share = found.speed / (scale * Going::kStep);
        EXPECT_NEAR(share, 1, alpha ? 0.25 : 0.15);
      }
  }
}

TEST(FootageFrames, MotionIsThatOfTheCourseOfWhichMoreIsSeen) {
  // A film of 13 frames runs into no beginning: in a loop of 8 it goes over into itself.
  const Going film(13);
  for (const int start : {0, 3}) {
    FootageMotion motion = film.footage();
    motion.start_s = start / 25.0;
    FootageFrames footage(motion, 8, 25, true);
    const Carried found = carried(footage, 17);
    // Both courses move alike here, so that their mixture does too.
    EXPECT_LT(found.worst, 0.4) << start;
    EXPECT_NEAR(found.speed, Going::kStep, 0.5) << start;
  }
}

TEST(FootageFrames, MotionIsNothingWhereNothingIsSeenAndGoesOnAfterTheLastFrame) {
  const Going film(5);
  FootageMotion once = film.footage();
  once.start_s = 1, once.repeats = false;
  FootageFrames footage(once, 20, 1, false);
  EXPECT_TRUE(footage.next().empty());
  ASSERT_TRUE(footage.motion());
  EXPECT_TRUE(footage.motion()->empty());
  for (int i = 0; i < 5; ++i) {
    ASSERT_FALSE(footage.next().empty());
    ASSERT_TRUE(footage.motion());
    EXPECT_NEAR(cv::mean(*footage.motion())[0], Going::kStep, 0.6) << i;
  }
  EXPECT_TRUE(footage.next().empty());
  EXPECT_TRUE(footage.motion()->empty());

  const Sequence still({100});
  FootageFrames one({.file = still.path()}, 3, 25, false);
  one.next();
  EXPECT_EQ(cv::norm(*one.motion(), cv::NORM_INF), 0);
}

TEST(FootageFrames, AMatteLimitsWhatIsSeenAndTheGroundIsTakenOff) {
  const ScratchFolder folder;
  cv::Mat frame(40, 60, CV_8UC3, cv::Scalar::all(0)), matte(40, 60, CV_8U, cv::Scalar(0));
  frame(cv::Rect(10, 10, 40, 20)).setTo(cv::Scalar(40, 120, 250));
  matte.colRange(0, 30).setTo(255), matte.colRange(30, 32).setTo(128);
  cv::imwrite((folder / "f.000.png").string(), frame);
  cv::imwrite((folder / "matte.png").string(), matte);
  cv::resize(matte, matte, {}, 2, 2, cv::INTER_NEAREST);
  cv::imwrite((folder / "large.png").string(), matte);
  cv::imwrite((folder / "tall.png").string(), cv::Mat(matte.t()));
  const FootageMotion plain{.file = folder / "f.###.png"};
  const auto shown = [](const FootageMotion& motion) {
    return FootageFrames(motion, 2, 25, false).next().clone();
  };
  FootageMotion motion = plain;
  for (const char* name : {"matte.png", "large.png"}) {
    motion.matte = folder / name;
    const cv::Mat seen = shown(motion);
    EXPECT_EQ(seen.at<cv::Vec4f>(2, 2), cv::Vec4f(0, 0, 0, 1)) << name;
    EXPECT_NEAR(seen.at<cv::Vec4f>(20, 20)[2], 250 / 255.0, 1e-4);
    EXPECT_NEAR(seen.at<cv::Vec4f>(20, 31)[3], 128 / 255.0, 1e-4);
    EXPECT_NEAR(seen.at<cv::Vec4f>(20, 31)[2], 128 / 255.0 * 250 / 255.0, 1e-4);
    EXPECT_EQ(seen.at<cv::Vec4f>(20, 40), cv::Vec4f(0, 0, 0, 0));
  }
  motion.ground = media::Ground::kBlack;  // and the matte
  const cv::Mat light = shown(motion);
  EXPECT_EQ(light.at<cv::Vec4f>(2, 2), cv::Vec4f(0, 0, 0, 0));
  EXPECT_NEAR(light.at<cv::Vec4f>(20, 20)[2], 250 / 255.0, 1e-3);
  EXPECT_EQ(light.at<cv::Vec4f>(20, 40), cv::Vec4f(0, 0, 0, 0));
  FootageMotion dark = plain;
  dark.ground = media::Ground::kWhite;
  EXPECT_EQ(shown(dark).at<cv::Vec4f>(2, 2), cv::Vec4f(0, 0, 0, 1));
  EXPECT_NEAR(shown(dark).at<cv::Vec4f>(20, 40)[3], 1 - 40 / 255.0, 1e-3);
  // A ground that is not quite white leaves no veil.
  cv::Mat grey(40, 60, CV_8UC3, cv::Scalar(246, 245, 247));
  grey(cv::Rect(10, 10, 20, 20)).setTo(cv::Scalar(30, 30, 30));
  cv::imwrite((folder / "grey.png").string(), grey);
  const cv::Mat smoke = shown({.file = folder / "grey.png", .ground = media::Ground::kWhite});
  EXPECT_EQ(smoke.at<cv::Vec4f>(2, 2), cv::Vec4f(0, 0, 0, 0));
  EXPECT_NEAR(smoke.at<cv::Vec4f>(20, 20)[3], 1 - 30 / 255.0, 0.02);
  motion.matte = folder / "tall.png";
  try {
    shown(motion);
    FAIL() << "a matte of another shape was taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("tall.png"), testing::HasSubstr("80 x 120"),
                                             testing::HasSubstr("60 x 40"),
                                             testing::HasSubstr("Paint it over a frame of the film")));
  }
}

/// A film of 4 frames that get lighter, and mattes for them: a white column that goes to the right.
class Matted {
 public:
  explicit Matted(int mattes = 4, int scale = 1, int grey = 60) {
    std::filesystem::create_directories(folder_ / "mattes");
    for (int i = 0; i < 4; ++i)
      cv::imwrite((folder_ / fmt::format("f.{:03}.png", i)).string(),
                  cv::Mat(8, 12, CV_8UC3, cv::Scalar::all(grey + 40 * i)));
    for (int i = 0; i < mattes; ++i) {
      cv::Mat matte(8 * scale, 12 * scale, CV_8U, cv::Scalar(5));
      if (i < 3) matte.colRange(3 * i * scale, 3 * (i + 1) * scale).setTo(255);
      cv::imwrite((folder_ / fmt::format("mattes/{:03}.png", i)).string(), matte);
    }
  }
  FootageMotion footage() const { return {.file = folder_ / "f.###.png", .matte = folder_ / "mattes"}; }
  /// Of each frame that a scene shows, the first column that is seen (-1: none) and its grey.
  static std::vector<std::pair<int, int>> shown(const FootageMotion& motion, int frames, bool loop,
                                                int asked) {
    FootageFrames footage(motion, frames, 25, loop);
    std::vector<std::pair<int, int>> seen;
    for (int i = 0; i < asked; ++i) {
      const cv::Mat& frame = footage.next();
      int column = 0;
      while (column < frame.cols && frame.at<cv::Vec4f>(2, column)[3] == 0) ++column;
      if (column == frame.cols)
        seen.emplace_back(-1, 0);
      else
        seen.emplace_back(column, cvRound(255 * frame.at<cv::Vec4f>(2, column)[0]));
    }
    return seen;
  }
  std::string fault() const {
    return fault_of(ErrorKind::kInput, [&] { FootageFrames(footage(), 9, 25, false); });
  }

 private:
  ScratchFolder folder_;
};

TEST(FootageFrames, MattesThatMoveGoWithTheirFrames) {
  const std::vector<std::pair<int, int>> round{{0, 60}, {3, 100}, {6, 140}, {-1, 0}};
  for (const int scale : {1, 3}) {
    const Matted film(4, scale);
    EXPECT_EQ(Matted::shown(film.footage(), 4, false, 4), round) << scale;
  }
  const Matted film;
  // What plays once begins later.
  FootageMotion motion = film.footage();
  motion.repeats = false, motion.start_s = 2.0 / 25;
  const std::vector<std::pair<int, int>> after{{-1, 0},  {-1, 0}, {0, 60}, {3, 100},
                                               {6, 140}, {-1, 0}, {-1, 0}};
  EXPECT_EQ(Matted::shown(motion, 7, false, 7), after);
  // Shown in another size, they are seen in it.
  motion = film.footage();
  motion.width = 24;
  FootageFrames wide(motion, 4, 25, false);
  wide.next();
  EXPECT_EQ(wide.next().at<cv::Vec4f>(4, 9)[3], 1);
  EXPECT_EQ(wide.next().at<cv::Vec4f>(4, 9)[3], 0);
  // The ground is told by the whole film, not by what its matte leaves of it.
  for (const int grey : {60, 12}) {
    const Matted dark(4, 1, grey);
    motion = dark.footage();
    motion.ground = media::Ground::kBlack;
    FootageFrames light(motion, 4, 25, false);
    EXPECT_EQ(light.next().at<cv::Vec4f>(2, 1)[3] > 0, grey == 60) << grey;
    EXPECT_EQ(light.next().at<cv::Vec4f>(2, 1)[3], 0);
  }
}

TEST(FootageFrames, WhetherMattesAreAlphaOrGreyIsTheSameInAllFramesOfAFilm) {
  // Black paint that goes from nothing to all of the frame, and opaque greys in files that could hold alpha.
  for (const bool alpha : {true, false}) {
    const Matted film;
    for (int i = 0; i < 4; ++i) {
      cv::Mat matte(8, 12, CV_8UC4, alpha ? cv::Scalar(0, 0, 0, 0) : cv::Scalar(0, 0, 0, 255));
      matte.colRange(0, 4 * i).setTo(alpha ? cv::Scalar(0, 0, 0, 255) : cv::Scalar::all(255));
      cv::imwrite((film.footage().matte / fmt::format("{:03}.png", i)).string(), matte);
    }
    FootageFrames footage(film.footage(), 4, 25, false);
    for (int i = 0; i < 4; ++i) {
      const cv::Mat& frame = footage.next();
      for (int x = 0; x < 12; ++x)
        EXPECT_EQ(frame.at<cv::Vec4f>(3, x)[3], x < 4 * i ? 1 : 0) << alpha << " frame " << i << " at " << x;
    }
  }
}

TEST(FootageFrames, MattesThatDoNotFitTheirFilmAreRefused) {
  EXPECT_THAT(Matted(3).fault(),
              testing::AllOf(testing::HasSubstr("mattes"), testing::HasSubstr("ends after 3 frames"),
                             testing::HasSubstr("f.###.png goes on"),
                             testing::HasSubstr("one matte for each frame")));
  EXPECT_THAT(Matted(5).fault(), testing::HasSubstr("goes on after the 4 frames"));
  const Matted few(3);
  EXPECT_EQ(Matted::shown(few.footage(), 2, false, 2).size(), 2u) << "what is not shown is not asked for";
  std::ofstream(few.footage().matte / "002.png") << "no picture";
  EXPECT_EQ(Matted::shown(few.footage(), 2, false, 2).size(), 2u) << "nor read";
  const Matted film;
  std::stop_source stop;
  stop.request_stop();
  fault_of(ErrorKind::kCancelled, [&] { has_transparency(film.footage().matte, 9, stop.get_token()); });
  fault_of(ErrorKind::kCancelled,
           [&] { FootageFrames({.file = film.footage().file}, 2, 25, false, stop.get_token()); });
  FootageMotion motion = film.footage();
  motion.matte = motion.matte.parent_path() / "none.####.png";
  EXPECT_NE(fault_of(ErrorKind::kInput, [&] { FootageFrames(motion, 2, 25, false); }).find("none"),
            std::string::npos);
}

}  // namespace
}  // namespace freshet::synth::scene
