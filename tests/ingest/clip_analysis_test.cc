#include "ingest/clip_analysis.h"

#include <gtest/gtest.h>

#include <cmath>

namespace freshet::ingest {
namespace {

TEST(LumaStatistics, AgreesWithTheTextbook) {
  LumaStatistics statistics({7, 5});
  cv::RNG rng(3);
  std::vector<cv::Mat> frames(23);
  for (cv::Mat& frame : frames) {
    frame.create(5, 7, CV_8U);
    rng.fill(frame, cv::RNG::UNIFORM, 0, 256);
    statistics.add(frame);
  }
  const cv::Mat mean = statistics.mean_u16(), deviation = statistics.deviation();
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) {
      double sum = 0, squares = 0;
      for (const cv::Mat& frame : frames) sum += frame.at<uchar>(y, x) / 255.0;
      const double average = sum / 23;
      for (const cv::Mat& frame : frames) squares += std::pow(frame.at<uchar>(y, x) / 255.0 - average, 2);
      EXPECT_NEAR(mean.at<std::uint16_t>(y, x), average * 65535, 0.51);
      EXPECT_NEAR(deviation.at<float>(y, x), std::sqrt(squares / 23), 1e-6);
    }
  }
}

TEST(LumaStatistics, OfWhiteFramesIsFullScale) {
  LumaStatistics statistics({4, 4});
  for (int i = 0; i < 300; ++i) statistics.add(cv::Mat(4, 4, CV_8U, cv::Scalar(255)));
  EXPECT_EQ(statistics.mean_u16().at<std::uint16_t>(2, 2), 65535);
  EXPECT_EQ(statistics.deviation().at<float>(2, 2), 0);
}

TEST(MovingMask, WantsSpeedAndChangeTogetherAndDropsSpecks) {
  const vision::Settings settings;
  const float fast = static_cast<float>(settings.min_motion_px) * 2;
  const float change = static_cast<float>(settings.min_change) * 2;
  cv::Mat speed(60, 90, CV_32F, cv::Scalar(0)), deviation(60, 90, CV_32F, cv::Scalar(0));
  speed(cv::Rect(0, 0, 60, 60)).setTo(fast);
  deviation(cv::Rect(30, 0, 60, 60)).setTo(change);
  speed(cv::Rect(75, 20, 2, 2)).setTo(fast);  // a speck that does both
  const cv::Mat moving = moving_mask(speed, deviation, 25, settings);
  EXPECT_EQ(moving.at<uchar>(30, 15), 0) << "speed alone";
  EXPECT_EQ(moving.at<uchar>(30, 45), 255) << "both";
  EXPECT_EQ(moving.at<uchar>(30, 85), 0) << "change alone";
  EXPECT_EQ(moving.at<uchar>(21, 76), 0) << "a speck";
}

TEST(MovingMask, JudgesSpeedBySecondsAndNotByFrames) {
  const vision::Settings settings;
  const cv::Mat deviation(60, 60, CV_32F, cv::Scalar(1));
  const cv::Mat speed(30, 30, CV_32F, cv::Scalar(settings.min_motion_px * 0.6));
  EXPECT_EQ(cv::countNonZero(moving_mask(speed, deviation, 25, settings)), 0);
  EXPECT_EQ(cv::countNonZero(moving_mask(speed, deviation, 50, settings)), 60 * 60);
}

TEST(FindPatches, KeepsNoPatchThatReachesOutsideTheSource) {
  const vision::Settings settings;
  vision::CellMap motion{36, 48, vision::motion_channels(settings.spectrum), 4, {}};
  motion.values.assign(static_cast<std::size_t>(motion.rows) * motion.columns * motion.channels, 1.0f);
  const cv::Mat moving(144, 192, CV_8U, cv::Scalar(255));
  const stored::PatchColumns patches = find_patches(moving, {}, motion, settings);
  const std::vector<vision::Variant> variants = settings.variants();
  ASSERT_GT(patches.size(), 0u);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const vision::VariantFrame frame = vision::variant_frame(moving.size(), variants[patches.variant[i]]);
    for (const auto& [dx, dy] : {std::pair{0, 0}, {47, 0}, {0, 47}, {47, 47}}) {
      const cv::Vec2d at = frame.source_from_variant * cv::Vec3d(patches.x[i] + dx, patches.y[i] + dy, 1);
      EXPECT_GT(at[0], -1.01);
      EXPECT_GT(at[1], -1.01);
      EXPECT_LT(at[0], 192.01);
      EXPECT_LT(at[1], 144.01);
    }
  }
}

TEST(FindPatches, KeepsNoPatchThatSomethingCrossed) {
  const vision::Settings settings;
  vision::CellMap motion{36, 48, vision::motion_channels(settings.spectrum), 4, {}};
  motion.values.assign(static_cast<std::size_t>(motion.rows) * motion.columns * motion.channels, 1.0f);
  const cv::Mat moving(144, 192, CV_8U, cv::Scalar(255));
  cv::Mat crossed(144, 192, CV_8U, cv::Scalar(0));
  crossed(cv::Rect(90, 60, 6, 6)).setTo(255);
  const stored::PatchColumns all = find_patches(moving, {}, motion, settings);
  const stored::PatchColumns patches = find_patches(moving, crossed, motion, settings);
  EXPECT_LT(patches.size(), all.size());
  ASSERT_GT(patches.size(), 0u);
  const std::vector<vision::Variant> variants = settings.variants();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const vision::VariantFrame frame = vision::variant_frame(moving.size(), variants[patches.variant[i]]);
    for (int y = 0; y < settings.grid.patch; y += 2) {
      for (int x = 0; x < settings.grid.patch; x += 2) {
        const cv::Vec2d at = frame.source_from_variant * cv::Vec3d(patches.x[i] + x, patches.y[i] + y, 1);
        EXPECT_FALSE(at[0] > 91 && at[0] < 94 && at[1] > 61 && at[1] < 64);
      }
    }
  }
}

}  // namespace
}  // namespace freshet::ingest
