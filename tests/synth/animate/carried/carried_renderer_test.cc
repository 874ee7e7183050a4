#include "synth/animate/carried/carried_renderer.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "synth/animate/animate.h"
#include "tests/synth/animate/flowing_clip.h"
#include "tests/synth/animate/measured_clip.h"

namespace freshet::synth::animate {
namespace {

/// Of every cell of a clip, how long each band lives.
vision::CellMap living(float life_s) {
  vision::CellMap made{.rows = 4, .columns = 5, .channels = vision::kLifeChannels, .cell = 32, .values = {}};
  for (int i = 0; i < made.rows * made.columns; ++i)
    for (int channel = 0; channel < vision::kLifeChannels; ++channel)
      made.values.push_back(channel < vision::kLifeBands ? life_s : 0.01f);
  return made;
}

const cv::Point kFrom{40, 50};
constexpr int kFrames = 25, kStep_px = 2;

/// A white disc before a blue sky, after a second of a clip that goes right and whose forms live so long.
cv::Mat after_a_second(float life_s) {
  const FlowingStore store({measured({.frames = kFrames + 1,
                                      .steady = {kStep_px, 0},
                                      .varying = 0,
                                      .drawn = [](int) { return cv::Mat(110, 150, CV_8U, cv::Scalar(100)); },
                                      .life = living(life_s)})});
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  cv::Mat picture(100, 144, CV_8UC3, cv::Scalar(200, 90, 20)), last;
  for (int y = 0; y + 48 <= picture.rows; y += 24)
    for (int x = 0; x + 48 <= picture.cols; x += 24)
      placement.patches.push_back(
          {.piece = {x, y}, .clip = store.id(), .variant = {}, .patch = {x, y}, .speed = 1});
  cv::circle(picture, kFrom, 15, cv::Scalar::all(240), cv::FILLED, cv::LINE_AA);
  AnimateOptions options;
  options.frames = kFrames;
  options.method = CarriedOptions{};
  animate(store.snapshot(), store.settings(), picture, cv::Mat(picture.size(), CV_8U, cv::Scalar(255)),
          placement, options, [&](const cv::Mat& frame) { frame.copyTo(last); });
  return last;
}

cv::Vec3b at(const cv::Mat& frame, cv::Point place) { return frame.at<cv::Vec3b>(place); }

TEST(CarriedRenderer, BodiesThatLiveLongGoWholeWithTheirLightAndColour) {
  const cv::Point to = kFrom + cv::Point(kStep_px * (kFrames - 1), 0);
  const cv::Mat body = after_a_second(6), brief = after_a_second(0.4f);
  EXPECT_GT(at(body, to)[2], 200) << "white where it has gone";
  EXPECT_LT(at(body, kFrom)[2], 50) << "blue where it was";
  EXPECT_GT(at(brief, kFrom)[2], at(body, kFrom)[2] + 60) << "what lives briefly keeps its place's light";
}

}  // namespace
}  // namespace freshet::synth::animate
