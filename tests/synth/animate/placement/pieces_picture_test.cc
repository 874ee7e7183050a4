#include "synth/animate/placement/pieces_picture.h"

#include <gtest/gtest.h>

namespace freshet::synth::animate {
namespace {

TEST(PiecesPicture, IsReducedByThePieceScaleOrLargerThanWhatIsShown) {
  EXPECT_EQ(pieces_picture({.piece_scale = 2, .patches = {}}, {640, 361}), cv::Size(320, 181));
  EXPECT_EQ(pieces_picture({.piece_scale = 1, .patches = {}}, {640, 480}), cv::Size(640, 480));
  EXPECT_EQ(pieces_picture({.piece_scale = 0.375, .patches = {}}, {240, 180}), cv::Size(640, 480));
  EXPECT_EQ(pieces_picture({.piece_scale = 16, .patches = {}}, {3, 2}), cv::Size(1, 1));
}

}  // namespace
}  // namespace freshet::synth::animate
