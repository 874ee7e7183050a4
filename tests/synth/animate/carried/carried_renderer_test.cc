#include "synth/animate/carried/carried_renderer.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <functional>
#include <utility>

#include "synth/animate/animate.h"
#include "tests/synth/animate/flowing_clip.h"
#include "tests/synth/animate/measured_clip.h"

namespace freshet::synth::animate {
namespace {

const cv::Point kFrom{40, 50};
constexpr int kFrames = 25, kStep_px = 2;

/// A picture after a second of a clip that goes right and whose forms live so long; upper pieces play it as fast as
/// filmed, those below at `lower` times that.
cv::Mat after_a_second(const cv::Mat& picture, float life_s, double lower = 1,
                       std::function<void(const cv::Mat&)> motion = {}) {
  const FlowingStore store({measured({.frames = kFrames + 1,
                                      .steady = {kStep_px, 0},
                                      .varying = 0,
                                      .drawn = [](int) { return cv::Mat(110, 150, CV_8U, cv::Scalar(100)); },
                                      .life = living(life_s)})});
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  cv::Mat last;
  for (int y = 0; y + 48 <= picture.rows; y += 24)
    for (int x = 0; x + 48 <= picture.cols; x += 24)
      placement.patches.push_back({.piece = {x, y},
                                   .clip = store.id(),
                                   .variant = {},
                                   .patch = {x % 96, y},
                                   .speed = y < 24 ? 1 : lower});
  AnimateOptions options;
  options.frames = kFrames;
  options.method = CarriedOptions{};
  options.motion_sink = std::move(motion);
  animate(store.snapshot(), store.settings(), picture, cv::Mat(picture.size(), CV_8U, cv::Scalar(255)),
          placement, options, [&](const cv::Mat& frame) { frame.copyTo(last); });
  return last;
}

cv::Mat sky(int width) { return cv::Mat(100, width, CV_8UC3, cv::Scalar(200, 90, 20)); }

cv::Vec3b at(const cv::Mat& frame, cv::Point place) { return frame.at<cv::Vec3b>(place); }

TEST(CarriedRenderer, BodiesThatLiveLongGoWholeWithTheirLightAndColour) {
  const cv::Point to = kFrom + cv::Point(kStep_px * (kFrames - 1), 0);
  cv::Mat disc = sky(144);
  cv::circle(disc, kFrom, 15, cv::Scalar::all(240), cv::FILLED, cv::LINE_AA);
  const cv::Mat body = after_a_second(disc, 6), brief = after_a_second(disc, 0.4f);
  EXPECT_GT(at(body, to)[2], 200) << "white where it has gone";
  EXPECT_LT(at(body, kFrom)[2], 50) << "blue where it was";
  EXPECT_GT(at(brief, kFrom)[2], at(body, kFrom)[2] + 60) << "what lives briefly keeps its place's light";
}

TEST(CarriedRenderer, BodiesAreNotShearedWherePatchesWentAtOtherSpeeds) {
  // Above and below: 2 and .5 px a frame by the patches.
  const auto faster_above = [](float life_s) {
    double faster = 0;
    after_a_second(sky(480), life_s, 0.25, [&](const cv::Mat& motion) {
      faster = motion.at<cv::Vec2f>(10, 240)[0] - motion.at<cv::Vec2f>(90, 240)[0];
    });
    return faster;
  };
  EXPECT_LT(faster_above(6), 0.5);
  EXPECT_GT(faster_above(0.1f), 1) << "what lives briefly may";
}

}  // namespace
}  // namespace freshet::synth::animate
