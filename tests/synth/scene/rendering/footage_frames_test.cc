#include "synth/scene/rendering/footage_frames.h"

#include <algorithm>
#include <filesystem>
#include <numeric>

#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

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

}  // namespace
}  // namespace freshet::synth::scene
