#include "synth/animate/placement/retiming.h"

#include <gtest/gtest.h>

#include "freshet/error.h"

namespace freshet::synth::animate {
namespace {

Placement row_of_pieces() {
  Placement placement;
  for (int i = 0; i < 4; ++i)
    placement.patches.push_back(
        {.piece = {24 * i, 0}, .clip = store::ClipId{0}, .variant = {}, .patch = {24 * i, 0}});
  return placement;
}

TEST(Retiming, BlackIsHalfWhiteIsTwiceAndMidGreyLeavesASpeedAsItIs) {
  const cv::Size picture(120, 48);
  for (const auto& [grey, factor] : {std::pair{0, 0.5}, {128, 1.0}, {255, 2.0}, {192, 1.414214}}) {
    Placement placement = row_of_pieces();
    retime(placement, 3, cv::Mat(picture, CV_8UC3, cv::Scalar::all(grey)), picture);
    for (const PlacedPatch& placed : placement.patches) EXPECT_NEAR(placed.speed, 3 * factor, 1e-5) << grey;
  }
}

TEST(Retiming, NeighboursOfOneClipAreCoherentOnlyAtOneSpeed) {
  const cv::Size picture(120, 48);
  Placement placement = row_of_pieces();
  cv::Mat map(picture, CV_8UC3, cv::Scalar::all(100));
  map.colRange(60, 120).setTo(cv::Scalar::all(220));
  retime(placement, 1, map, picture);
  EXPECT_TRUE(coherent(placement.patches[0], placement.patches[1]));
  EXPECT_FALSE(coherent(placement.patches[1], placement.patches[2]));
  EXPECT_TRUE(coherent(placement.patches[2], placement.patches[3]));
}

TEST(Retiming, RefusesAMapOfAnotherSizeAndASpeedOfNothing) {
  Placement placement = row_of_pieces();
  EXPECT_THROW(retime(placement, 1, cv::Mat::zeros(10, 10, CV_8UC3), {120, 48}), Error);
  EXPECT_THROW(retime(placement, 0, {}, {120, 48}), Error);
  EXPECT_THROW(retime(placement, -1, {}, {120, 48}), Error);
}

}  // namespace
}  // namespace freshet::synth::animate
