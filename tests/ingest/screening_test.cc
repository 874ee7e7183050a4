#include "ingest/screening.h"

#include <gtest/gtest.h>

#include "tests/ingest/synthetic_clip.h"

namespace freshet::ingest {
namespace {

Screening screen(const SyntheticClip& clip) {
  Screener screener(clip.size, clip.fps);
  for (const cv::Mat& frame : render(clip)) screener.add(frame);
  return screener.finish();
}

bool says(const std::vector<std::string>& sentences, const std::string& words) {
  for (const std::string& sentence : sentences) {
    if (sentence.find(words) != std::string::npos) return true;
  }
  return false;
}

const SyntheticClip kFixed{.size = {384, 216}, .frames = 60, .moving = {120, 60, 150, 100}, .changing = true};

TEST(Screening, TakesAFixedCameraBeforeAFluid) {
  const Screening screening = screen(kFixed);
  EXPECT_EQ(screening.camera.referenced_windows, screening.camera.windows);
  EXPECT_GE(screening.camera.windows, 2);
  EXPECT_LT(screening.camera.drift, 0.001);
  EXPECT_LT(screening.camera.shake, 0.0005);
  EXPECT_TRUE(judge(screening).refusals.empty());
  EXPECT_TRUE(judge(screening).notes.empty());
}

TEST(Screening, TakesAFixedCameraBeforeATextureThatSlidesUnchanged) {
  SyntheticClip clip = kFixed;
  clip.changing = false;
  clip.velocity = {2, 0.5};
  EXPECT_TRUE(judge(screen(clip)).refusals.empty());
}

TEST(Screening, MeasuresAPanAndRefusesIt) {
  SyntheticClip clip = kFixed;
  clip.pan = {0.6, -0.3};
  const Screening screening = screen(clip);
  const double diagonal = std::hypot(384, 216);
  // 59 frames between the first and the last, less what the last, short window leaves out.
  EXPECT_GT(screening.camera.drift, 0.8 * 50 * std::hypot(0.6, 0.3) / diagonal);
  EXPECT_LT(screening.camera.drift, 1.1 * 59 * std::hypot(0.6, 0.3) / diagonal);
  EXPECT_TRUE(says(judge(screening).refusals, "camera moves"));
}

TEST(Screening, MeasuresAShakingCameraAndRefusesIt) {
  SyntheticClip clip = kFixed;
  clip.jitter = 6;
  const Screening screening = screen(clip);
  // Uniform in +-6 in both directions: 6 sqrt(2 / 3) px rms.
  EXPECT_NEAR(screening.camera.shake, 6 * std::sqrt(2.0 / 3) / std::hypot(384, 216), 0.004);
  EXPECT_TRUE(says(judge(screening).refusals, "camera shakes"));
}

TEST(Screening, CannotTellTheCameraWhereAllIsFluidAndSaysSo) {
  SyntheticClip clip = kFixed;
  clip.moving = {0, 0, 384, 216};
  clip.velocity = {2, 1};
  const Verdict verdict = judge(screen(clip));
  EXPECT_TRUE(verdict.refusals.empty());
  EXPECT_TRUE(says(verdict.notes, "no static reference"));
}

TEST(Screening, FindsACutAtItsFrameAndRefusesIt) {
  SyntheticClip clip = kFixed;
  clip.cut_at = 37;
  const Screening screening = screen(clip);
  EXPECT_EQ(screening.cuts, std::vector<int>{37});
  EXPECT_TRUE(says(judge(screening).refusals, "frame 37"));
}

TEST(Screening, RefusesAClipOfFewFrames) {
  SyntheticClip clip = kFixed;
  clip.frames = 23;
  EXPECT_TRUE(says(judge(screen(clip)).refusals, "23 frames"));
  clip.frames = 24;
  EXPECT_TRUE(judge(screen(clip)).refusals.empty());
}

TEST(Screening, WorksOnFramesSmallerThanItsPatterns) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(5, 40), cv::Size(17, 16)}) {
    Screener screener(size, 25);
    for (int i = 0; i < 30; ++i) screener.add(cv::Mat(size, CV_8U, cv::Scalar(i * 8)));
    EXPECT_EQ(screener.finish().camera.referenced_windows, 0);
  }
}

TEST(FindCuts, DoesNotTakeFlickerOrAFlashOfExposureForACut) {
  const std::vector<FrameChange> flicker(40, {0.2f, 0.5f, 0.4f});
  EXPECT_TRUE(find_cuts(flicker).empty());
  std::vector<FrameChange> exposure(40, {0.01f, 0.02f, 0.02f});
  exposure[20] = {0.3f, 0.05f, 0.8f};  // brighter, and otherwise the same picture
  EXPECT_TRUE(find_cuts(exposure).empty());
  std::vector<FrameChange> cut(40, {0.01f, 0.02f, 0.02f});
  cut[20] = {0.3f, 0.8f, 0.5f};
  EXPECT_EQ(find_cuts(cut), std::vector<int>{21});
  EXPECT_TRUE(find_cuts({}).empty());
}

TEST(DuplicatedFraction, CountsRepeatedFramesButNotSlowOnes) {
  std::vector<FrameChange> changes(40, {0.01f, 0.02f, 0.02f});
  for (int i = 4; i < 40; i += 10) changes[i] = {0.0004f, 0, 0};
  EXPECT_DOUBLE_EQ(duplicated_fraction(changes), 0.1);
  EXPECT_EQ(duplicated_fraction(std::vector<FrameChange>(40, {0.0004f, 0, 0})), 0);
  EXPECT_EQ(duplicated_fraction(std::vector<FrameChange>(40, {0, 0, 0})), 1) << "a still";
  EXPECT_EQ(duplicated_fraction({}), 0);
}

}  // namespace
}  // namespace freshet::ingest
