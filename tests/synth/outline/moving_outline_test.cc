#include "synth/outline/moving_outline.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace freshet::synth::outline {
namespace {

const cv::Size kSize(96, 96);
const cv::Rect kFlame(24, 0, 48, 96), kLog(16, 56, 64, 12);

struct Held {
  cv::Mat alpha;  // of a flame from the bottom to the top, less a log across it
  cv::Mat log;    // CV_8U
};

Held flame_behind_a_log() {
  Held made{cv::Mat(kSize, CV_32F, cv::Scalar(0)), cv::Mat(kSize, CV_8U, cv::Scalar(0))};
  made.alpha(kFlame).setTo(1);
  made.log(kLog).setTo(255);
  made.alpha.setTo(0, made.log);
  return made;
}

TEST(MatteSequence, TheHoleOfWhatIsHeldIsNotCarriedUpWithTheFlames) {
  const Held made = flame_behind_a_log();
  const cv::Mat up(kSize, CV_32FC2, cv::Scalar(0, -50));  // 2 px a frame
  const auto motion = [&](int) { return up; };
  MatteSequence mattes(made.alpha, up, 25, {}, motion, 0, made.log);
  MatteSequence unaware(made.alpha, up, 25, {}, motion);
  const cv::Rect above(kFlame.x + 12, kLog.y - 10, 24, 8);  // where the hole would be after some frames
  double least = 1, least_unaware = 1;
  for (int frame = 0; frame < 12; ++frame) {
    const cv::Mat matte = mattes.next();
    ASSERT_EQ(cv::norm(matte, cv::NORM_INF, made.log), 0) << "frame " << frame;
    if (frame == 0) {
      EXPECT_LT(cv::norm(matte, made.alpha, cv::NORM_INF), 0.01) << "the first is the still one";
    }
    double least_here = 0;
    cv::minMaxLoc(matte(above), &least_here);
    least = std::min(least, least_here);
    cv::minMaxLoc(unaware.next()(above), &least_here);
    least_unaware = std::min(least_unaware, least_here);
  }
  EXPECT_GT(least, 0.95);
  EXPECT_LT(least_unaware, 0.5) << "nothing to be kept from";
}

TEST(MatteSequence, NothingHeldChangesNothing) {
  const Held made = flame_behind_a_log();
  const cv::Mat up(kSize, CV_32FC2, cv::Scalar(0, -50));
  const auto motion = [&](int) { return up; };
  MatteSequence without(made.alpha, up, 25, {}, motion);
  MatteSequence with(made.alpha, up, 25, {}, motion, 0, cv::Mat(kSize, CV_8U, cv::Scalar(0)));
  for (int frame = 0; frame < 4; ++frame)
    EXPECT_LT(cv::norm(without.next(), with.next(), cv::NORM_INF), 1e-5) << "frame " << frame;
}

}  // namespace
}  // namespace freshet::synth::outline
