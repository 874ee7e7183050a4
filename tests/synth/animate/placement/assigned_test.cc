#include "synth/animate/placement/assigned.h"

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/harness/fault.h"
#include "tests/synth/animate/flowing_clip.h"

namespace freshet::synth::animate {
namespace {

query::Assignment assignment() {
  query::Assignment assignment;
  assignment.picture = {144, 100};
  assignment.piece_scale = 1.5;
  // The other way round than in the store.
  assignment.clips = {
      {.name = "1.mkv", .class_name = "water", .licence = "", .source_hash = "hash of 1.mkv"},
      {.name = "0.mkv", .class_name = "water", .licence = "", .source_hash = "hash of 0.mkv"}};
  assignment.pieces = {{.corner = {0, 0}, .clip = 0, .variant = {}, .patch = {3, 5}, .score = 1},
                       {.corner = {24, 0}, .clip = 1, .variant = {}, .patch = {24, 0}, .score = 1}};
  return assignment;
}

TEST(Assigned, EachPieceIsLaidWithThePatchOfItsClip) {
  const FlowingStore store({FlowingClip{.frames = 4}, FlowingClip{.frames = 4, .seed = 2}});
  const Placement placement = placement_from(assignment(), store.snapshot());
  EXPECT_EQ(placement.side, 48);
  EXPECT_EQ(placement.stride, 24);
  EXPECT_EQ(placement.piece_scale, 1.5);
  ASSERT_EQ(placement.patches.size(), 2u);
  EXPECT_EQ(placement.patches[0].clip, store.id(1));
  EXPECT_EQ(placement.patches[0].piece, cv::Point(0, 0));
  EXPECT_EQ(placement.patches[0].patch, cv::Point(3, 5));
  EXPECT_EQ(placement.patches[0].speed, 1);
  EXPECT_EQ(placement.patches[1].clip, store.id(0));
  EXPECT_EQ(placement.patches[1].piece, cv::Point(24, 0));
}

TEST(Assigned, AClipThatTheStoreLacksIsNamed) {
  const FlowingStore store({FlowingClip{.frames = 4}});
  const std::string fault =
      fault_of(ErrorKind::kNotFound, [&] { placement_from(assignment(), store.snapshot()); });
  EXPECT_NE(fault.find("1.mkv"), std::string::npos);
}

}  // namespace
}  // namespace freshet::synth::animate
