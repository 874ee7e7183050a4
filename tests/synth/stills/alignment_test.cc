#include "synth/stills/alignment.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "freshet/error.h"
#include "tests/harness/fault.h"
#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

/// A ground with corners, larger than what is cut from it.
cv::Mat scene(int seed = 1) {
  cv::Mat picture(400, 520, CV_8UC3, cv::Scalar(70, 80, 90));
  cv::RNG random(static_cast<std::uint64_t>(seed));
  for (int i = 0; i < 250; ++i) {
    const cv::Rect box(random.uniform(0, 500), random.uniform(0, 380), random.uniform(5, 40),
                       random.uniform(5, 40));
    cv::rectangle(picture, box,
                  cv::Scalar(random.uniform(0, 255), random.uniform(0, 255), random.uniform(0, 255)),
                  cv::FILLED);
  }
  cv::GaussianBlur(picture, picture, {}, 1);
  return picture;
}

/// What a camera sees that is turned and has moved.
cv::Mat seen(const cv::Mat& from, double degrees, double dx, double dy) {
  cv::Mat turn = cv::getRotationMatrix2D({260, 200}, degrees, 1), out;
  turn.at<double>(0, 2) += dx - 40;
  turn.at<double>(1, 2) += dy - 30;
  cv::warpAffine(from, out, turn, {440, 340}, cv::INTER_CUBIC);
  return out;
}

TEST(Alignment, BringsHandHeldStillsOntoEachOther) {
  const cv::Mat ground = scene();
  std::vector<cv::Mat> stills{seen(ground, 0, 0, 0), seen(ground, .8, 5, -4), seen(ground, -.5, -7, 3)};
  const Alignment found = find_alignment(stills, {"a", "b", "c"});
  EXPECT_FALSE(found.tripod);
  EXPECT_GT(found.largest_px, 5);
  const double before =
      cv::norm(stills[0], stills[1], cv::NORM_L1) / static_cast<double>(3 * stills[0].total());
  align(stills, found);
  EXPECT_GT(stills[0].cols, 400);
  for (int i = 1; i < 3; ++i)
    EXPECT_LT(cv::norm(stills[0], stills[i], cv::NORM_L1) / static_cast<double>(3 * stills[0].total()),
              .2 * before);
}

TEST(Alignment, LeavesATripodsStillsAlone) {
  const cv::Mat ground = seen(scene(), 0, 0, 0);
  std::vector<cv::Mat> stills;
  for (const double phase : {.1, .5, .9}) {
    stills.push_back(ground.clone());
    draw_pendulum(stills.back(), {60, 100, 300, 120}, phase);
  }
  EXPECT_TRUE(find_alignment(stills, {"a", "b", "c"}).tripod);
}

TEST(Alignment, RefusesAStillOfAnotherScene) {
  const cv::Mat ground = scene();
  const std::vector<cv::Mat> stills{seen(ground, 0, 0, 0), seen(ground, .3, 2, 1), seen(scene(9), 0, 0, 0),
                                    seen(ground, -.3, 1, 2)};
  const std::string fault = fault_of([&] { find_alignment(stills, {"a.jpg", "b.jpg", "c.jpg", "d.jpg"}); });
  EXPECT_NE(fault.find("c.jpg"), std::string::npos) << fault;
}

TEST(Levels, ComeBackToOneExposure) {
  const cv::Mat ground = seen(scene(), 0, 0, 0);
  std::vector<cv::Mat> stills;
  const std::vector<cv::Scalar> factors{{1, 1, 1}, {.8, .85, .9}, {1, 1, 1}, {1.1, 1, .95}, {1, 1, 1}};
  for (const cv::Scalar& by : factors) {
    cv::Mat still;
    cv::multiply(ground, by, still);
    stills.push_back(still);
  }
  const std::vector<cv::Vec3d> found = find_levels(stills);
  for (std::size_t i = 0; i < stills.size(); ++i)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[i][c] * factors[i][c], 1, .015) << "still " << i;
  EXPECT_EQ(level(stills, found), 2);
}

}  // namespace
}  // namespace freshet::synth::stills
