#include "query/labelling/shares.h"

#include <gtest/gtest.h>

namespace freshet::query {
namespace {

Assignment of_clips(std::initializer_list<int> pieces_of) {
  Assignment assignment;
  for (const int pieces : pieces_of) {
    const auto clip = static_cast<std::uint32_t>(assignment.clips.size());
    assignment.clips.push_back({"clip " + std::to_string(clip), "water", "CC0", std::string(32, '0')});
    for (int i = 0; i < pieces; ++i) assignment.pieces.push_back({{24 * i, 0}, clip, {}, {24 * i, 0}, 0.3f});
  }
  return assignment;
}

TEST(Shares, OfTheMostUsedClipAndPatch) {
  Assignment assignment = of_clips({10, 25, 5});
  const LargestShares shares = largest_shares(assignment);
  EXPECT_EQ(shares.most_used, 1u);
  EXPECT_DOUBLE_EQ(shares.clip, 25.0 / 40);
  EXPECT_DOUBLE_EQ(shares.patch, 1.0 / 40);
  EXPECT_EQ(to_string(shares), "largest share of a clip 62%, of a patch 2.5%");
  assignment.pieces[1].patch = assignment.pieces[0].patch;
  EXPECT_DOUBLE_EQ(largest_shares(assignment).patch, 2.0 / 40);
  assignment.pieces[1].variant.flip = true;
  EXPECT_DOUBLE_EQ(largest_shares(assignment).patch, 1.0 / 40) << "its mirror image is another";
  EXPECT_EQ(largest_shares({}).clip, 0);
}

TEST(Shares, OfTheClassOfMostPieces) {
  Assignment assignment = of_clips({10, 25, 20});
  assignment.clips[0].class_name = "smoke";
  assignment.clips[1].class_name = "fire";
  EXPECT_EQ(largest_class(assignment).name, "fire");
  EXPECT_DOUBLE_EQ(largest_class(assignment).share, 25.0 / 55);
  assignment.clips[0].class_name = "water";  // with the last clip's more than fire's
  EXPECT_EQ(largest_class(assignment).name, "water");
  EXPECT_EQ(largest_class({}).name, "");
}

TEST(Shares, AClipAboveThreeFifthsIsNamedWithTheRemedy) {
  const auto warning = [](const Assignment& assignment) {
    return shares_warning(assignment, largest_shares(assignment));
  };
  EXPECT_EQ(warning(of_clips({24, 16})), "");
  const std::string text = warning(of_clips({15, 25}));
  EXPECT_NE(text.find("62% of the pieces come from one clip, clip 1"), std::string::npos) << text;
  EXPECT_NE(text.find("--exclude clip 1"), std::string::npos) << text;
  EXPECT_EQ(warning(of_clips({5})), "") << "few pieces may well come from one clip";
  Assignment stamped = of_clips({20, 20});
  for (int i = 0; i < 6; ++i) stamped.pieces[static_cast<std::size_t>(i)].patch = {0, 0};
  EXPECT_NE(warning(stamped).find("--reuse"), std::string::npos);
}

}  // namespace
}  // namespace freshet::query
