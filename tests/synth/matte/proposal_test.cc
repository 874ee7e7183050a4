// Marks from scores of pieces.

#include "synth/matte/proposal.h"

#include <gtest/gtest.h>

#include "tests/synth/matte/made_picture.h"
#include "vision/patch_grid.h"

namespace freshet::synth::matte {
namespace {

/// Pieces whose middle lies right of `border` have good candidates.
query::Candidates candidates_of(const query::Target& target, int border, float good, float poor) {
  query::Candidates candidates;
  candidates.k = 3;
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    const bool right = target.corners[piece].x + target.side / 2 > border;
    for (const float less : {0.f, 0.01f, 0.02f}) {
      candidates.rows.push_back(0);
      candidates.scores.push_back((right ? good : poor) - less);
    }
    candidates.counts.push_back(3);
  }
  return candidates;
}

query::Target target_of(cv::Size size) {
  return query::lay_out(cv::Mat(size, CV_8U, cv::Scalar(255)), vision::PatchGrid{});
}

TEST(Proposal, MarksGoodPiecesAsFluidAndPoorOnesAsBackground) {
  const query::Target target = target_of({480, 240});
  const Proposal proposal = propose_marks(target, candidates_of(target, 240, 0.5f, 0.3f), {});
  EXPECT_EQ(proposal.marks.size(), cv::Size(480, 240));
  EXPECT_GT(proposal.fluid_pieces, 10u);
  EXPECT_GT(proposal.background_pieces, 10u);
  EXPECT_NEAR(proposal.fluid_score, 0.49, 0.03);
  EXPECT_NEAR(proposal.background_score, 0.29, 0.03);
  EXPECT_EQ(proposal.marks.at<std::uint8_t>(120, 440), kFluid);
  EXPECT_EQ(proposal.marks.at<std::uint8_t>(120, 40), kBackground);
  EXPECT_EQ(proposal.marks.at<std::uint8_t>(120, 240), kUnknown);
  EXPECT_EQ(cv::countNonZero(proposal.marks.colRange(0, 200) == kFluid), 0);
  EXPECT_EQ(cv::countNonZero(proposal.marks.colRange(280, 480) == kBackground), 0);
}

TEST(Proposal, SaysWhenNothingStandsOut) {
  const query::Target target = target_of({480, 240});
  const query::Candidates all_alike = candidates_of(target, 240, 0.31f, 0.3f);
  const Proposal proposal = propose_marks(target, all_alike, {});
  EXPECT_FALSE(proposal.stands_out);
  EXPECT_EQ(cv::countNonZero(proposal.marks != kUnknown), 0);
}

}  // namespace
}  // namespace freshet::synth::matte
