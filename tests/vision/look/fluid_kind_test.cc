#include "vision/look/fluid_kind.h"

#include <cmath>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "synth/simulate/simulate.h"

namespace freshet::vision {
namespace {

/// Tongues from red at their rim to yellow at their heart, on black.
struct Drawn {
  cv::Mat picture{240, 320, CV_8UC3, cv::Scalar(4, 4, 6)}, matte{240, 320, CV_8U, cv::Scalar(0)};
};
Drawn flames() {
  Drawn d;
  for (int x = 110; x <= 210; x += 25) {
    cv::ellipse(d.picture, {x, 170}, {22, 62}, 0, 0, 360, {15, 70, 210}, cv::FILLED);
    cv::ellipse(d.picture, {x, 180}, {14, 45}, 0, 0, 360, {40, 150, 250}, cv::FILLED);
    cv::ellipse(d.picture, {x, 190}, {7, 25}, 0, 0, 360, {130, 235, 255}, cv::FILLED);
    cv::ellipse(d.matte, {x, 170}, {24, 64}, 0, 0, 360, 255, cv::FILLED);
  }
  return d;
}
/// Short level waves down to the lower border, under a bright sky.
Drawn sea() {
  Drawn d;
  d.picture.setTo(cv::Scalar(225, 205, 185));
  d.matte.rowRange(110, 240).setTo(255);
  for (int y = 110; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      const double wave = std::sin(y * .9 + 1.7 * std::sin(x * .11)) + .6 * std::sin(x * .23 + y * .31);
      const double level = 85 + 22 * wave;
      d.picture.at<cv::Vec3b>(y, x) =
          cv::Vec3b(cv::saturate_cast<std::uint8_t>(level + 25), cv::saturate_cast<std::uint8_t>(level + 8),
                    cv::saturate_cast<std::uint8_t>(level - 20));
    }
  return d;
}

TEST(FluidKind, TellsFlamesAndASea) {
  const Drawn burning = flames(), wavy = sea();
  const FluidKind fire = fluid_kind(fluid_look(burning.picture, burning.matte));
  EXPECT_EQ(fire.name(), "fire");
  EXPECT_TRUE(fire.sure()) << fire.sureness();
  const FluidKind water = fluid_kind(fluid_look(wavy.picture, wavy.matte));
  EXPECT_EQ(water.name(), "water");
  EXPECT_TRUE(water.sure()) << water.sureness();
}

TEST(FluidKind, SharesAreOne) {
  const Drawn wavy = sea();
  const FluidKind kind = fluid_kind(fluid_look(wavy.picture, wavy.matte));
  double sum = 0;
  for (const double share : kind.share) sum += share;
  EXPECT_NEAR(sum, 1, 1e-12);
}

TEST(FluidKind, ReadsTheFluidAndItsRimAlone) {
  Drawn wavy = sea();
  const auto before = fluid_look(wavy.picture, wavy.matte);
  wavy.picture.rowRange(0, 40).setTo(cv::Scalar(30, 90, 250));  // far from the fluid's edge
  const auto after = fluid_look(wavy.picture, wavy.matte);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_FLOAT_EQ(before[i], after[i]) << kLookFigures[i];
}

TEST(FluidKind, IsUnsureWhereNothingIsSeen) {
  for (const int level : {0, 60, 127, 200, 255}) {
    const cv::Mat flat(240, 320, CV_8UC3, cv::Scalar::all(level)), all(240, 320, CV_8U, cv::Scalar(255));
    const FluidKind kind = fluid_kind(fluid_look(flat, all));
    EXPECT_FALSE(kind.sure()) << level << ": " << kind.name() << " " << kind.sureness();
  }
}

// The seed teaches nothing (bench/kind/outlines.txt).
TEST(FluidKind, TellsSimulatedClips) {
  namespace simulate = synth::simulate;
  for (const auto& [clip, name] : {std::pair("smoke", "smoke"),
                                   {"fire", "fire"},
                                   {"waterfall", "water"},
                                   {"sea", "water"},
                                   {"clouds", "clouds"}}) {
    simulate::Simulation film(
        {.kind = simulate::parse_scene_kind(clip), .size = {192, 144}, .frames = 1, .seed = 7});
    simulate::SimulatedFrame frame;
    ASSERT_TRUE(film.next(frame));
    const FluidKind kind = fluid_kind(fluid_look(frame.picture, frame.alpha));
    EXPECT_EQ(kind.name(), name) << clip << " " << kind.sureness();
  }
}

TEST(FluidKind, ASpeckAndAnEmptyMatteHaveAKind) {
  Drawn d = flames();
  d.matte.setTo(0);
  d.matte.at<std::uint8_t>(100, 100) = 255;
  for (const cv::Mat& matte : {d.matte, cv::Mat(d.matte.size(), CV_8U, cv::Scalar(0))}) {
    const FluidKind kind = fluid_kind(fluid_look(d.picture, matte));
    EXPECT_GE(kind.sureness(), .25);  // no NaN
  }
  const cv::Mat dot(1, 1, CV_8UC3, cv::Scalar(9, 9, 9)), all(1, 1, CV_8U, cv::Scalar(255));
  EXPECT_GE(fluid_kind(fluid_look(dot, all)).sureness(), .25);
}

}  // namespace
}  // namespace freshet::vision
