#include "bench/quality/prior/transferred_flames.h"

#include <oneapi/tbb/global_control.h>

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "tests/bench/quality/still_and_flow.h"
#include "tests/synth/animate/forms/burning.h"

namespace freshet::bench {
namespace {

using synth::animate::BurningClip;
using synth::animate::BurningPicture;
using synth::animate::FlowingClip;
using synth::animate::FlowingStore;
using synth::animate::PartedStill;

const BurningPicture kFire;

cv::Mat around_the_fire() {
  cv::Mat matte = cv::Mat::zeros(kFire.size, CV_8U);
  matte(cv::Rect(30, 10, 150, 130)).setTo(255);
  return matte;
}
PartedStill parted() {
  cv::Mat alpha;
  around_the_fire().convertTo(alpha, CV_32F, 1 / 255.0);
  return synth::animate::part(kFire.units(), alpha);
}
FlameDesign design(const FlowingStore& store, std::vector<store::ClipId> clips, int frames = 8) {
  cv::Mat alpha;
  around_the_fire().convertTo(alpha, CV_32F, 1 / 255.0);
  return design_of_flames(store.snapshot(), store.settings().flow_step, kFire.units(), alpha, clips, frames,
                          25);
}
/// Levels of a flame that leans further from frame to frame.
std::vector<cv::Mat> leaning(int count) {
  std::vector<cv::Mat> levels;
  for (int t = 0; t < count; ++t)
    levels.push_back(0.8 * synth::animate::flame(kFire.size, kFire.bed, kFire.width, kFire.height, 8 * t));
  return levels;
}
cv::Mat grey(const cv::Mat& frame) {
  cv::Mat out;
  cv::cvtColor(frame, out, cv::COLOR_BGR2GRAY);
  return out;
}

TEST(TransferredFlames, AClipsFlamesLieOnThePictures) {
  const FlowingStore store({BurningClip{}.clip()});
  const FlameDesign made = design(store, {store.id()});
  ASSERT_EQ(made.levels.size(), 9u);
  EXPECT_EQ(made.clips, std::vector{store.id()});
  EXPECT_GT(made.fit, 0.5);
  for (const cv::Mat& level : made.levels) {
    ASSERT_EQ(level.size(), kFire.size);
    const cv::Moments light = cv::moments(level);
    EXPECT_NEAR(light.m10 / light.m00, kFire.bed.x, 15);
    EXPECT_NEAR(cv::mean(level)[0] / cv::mean(made.still.level)[0], 1, 0.5);
    EXPECT_EQ(cv::countNonZero(level.rowRange(kFire.bed.y + 20, kFire.size.height)), 0);
  }
}

TEST(TransferredFlames, AreWhereTheDesignHasThem) {
  const std::vector<cv::Mat> levels = leaning(7);
  const std::vector<cv::Mat> made = transfer_flames(kFire.draw(), around_the_fire(), parted(), levels);
  ASSERT_EQ(made.size(), 6u);
  EXPECT_EQ(levels_apart(made[0], kFire.draw()), 0);
  for (std::size_t t = 1; t < made.size(); ++t) {
    EXPECT_GT(cv::mean(grey(made[t]), levels[t] > 0.7)[0], 110) << t;
    EXPECT_LT(cv::mean(grey(made[t]), (levels[t] == 0) & around_the_fire())[0], 40) << t;
  }
}

TEST(TransferredFlames, HaveTheStillsColours) {
  const std::vector<cv::Mat> levels = leaning(5),
                             made = transfer_flames(kFire.draw(), around_the_fire(), parted(), levels);
  for (const cv::Mat& frame : made)
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols; ++x) {
        const cv::Vec3b c = frame.at<cv::Vec3b>(y, x);
        if (c[2] > 60) {
          EXPECT_GT(c[2], c[0]) << x << ", " << y;
        }
      }
}

TEST(TransferredFlames, OutsideTheMatteIsTheStillAndThreadsChangeNothing) {
  const auto last = [] {
    return transfer_flames(kFire.draw(), around_the_fire(), parted(), leaning(4)).back();
  };
  const cv::Mat all = last(), outside = around_the_fire() == 0;
  EXPECT_EQ(cv::norm(all, kFire.draw(), cv::NORM_INF, outside), 0);
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(levels_apart(all, last()), 0);
}

TEST(TransferredFlames, WithoutFlamesThereIsNoDesign) {
  const FlowingStore store({BurningClip{}.clip()});
  EXPECT_THROW(design(store, {}), Error);
  const cv::Mat dark = cv::Mat::zeros(kFire.size, CV_32FC3), alpha(kFire.size, CV_32F, cv::Scalar(1));
  EXPECT_THROW(design_of_flames(store.snapshot(), store.settings().flow_step, dark, alpha,
                                std::vector{store.id()}, 8, 25),
               Error);
  PartedStill nothing = parted();
  nothing.level = cv::Scalar(0);
  EXPECT_THROW(transfer_flames(kFire.draw(), around_the_fire(), nothing, leaning(3)), Error);
}

}  // namespace
}  // namespace freshet::bench
