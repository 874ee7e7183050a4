#include "query/costs/steadiness.h"

#include <gtest/gtest.h>

#include "query/index/index_builder.h"
#include "query/labelling/labelling.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

class Surf : public testing::Test {
 protected:
  // A river and a surf that look the same and have the same mean.
  Surf()
      : store_(made_store(folder_.path() / "a.store",
                          {{.name = "surf.mp4", .motion = {10, 0}, .texture = 5, .surge = 400},
                           {.name = "river.mp4", .motion = {10, 0}, .texture = 5, .surge = 0}})) {
    build_index(store_);
  }
  const ScratchFolder folder_;
  store::Store store_;
};

TEST_F(Surf, MeanAgainstLowBandsInEveryVariant) {
  const store::Snapshot snapshot = store_.snapshot();
  const stored::PatchTable table = stored::read_patch_table(snapshot);
  std::vector<stored::Row> rows(table.size());
  for (stored::Row row = 0; row < rows.size(); ++row) rows[row] = row;
  rows.push_back(stored::kNoRow);
  rows.push_back(0);
  const auto values = steadiness(snapshot, made_settings(), table, rows);
  ASSERT_EQ(values.size(), rows.size());
  for (stored::Row row = 0; row < table.size(); ++row) {
    const bool surf = snapshot.clip(table.clips[table.clip[row]]).name == "surf.mp4";
    ASSERT_NEAR(values[row], surf ? 100.0 / (100 + 2 * 400) : 1, 1e-5);
  }
  EXPECT_EQ(values[table.size()], 0);
  EXPECT_EQ(values[table.size() + 1], values[0]);
}

TEST_F(Surf, AnAskedDirectionIsGivenToWhatKeepsIt) {
  const store::Snapshot snapshot = store_.snapshot();
  const SearchBase base = open_search(snapshot);
  cv::Mat picture;
  cv::cvtColor(made_texture(5), picture, cv::COLOR_GRAY2BGR);
  const cv::Mat matte(picture.size(), CV_8U, cv::Scalar(255));
  LabelOptions options;
  options.candidates.k = 20;
  options.costs.lambda = 0;  // looks alone, which are equal: the surf's rows come first
  options.guide.direction = cv::Mat(picture.size(), CV_32FC2, cv::Scalar(1, 0));
  const auto share_of_surf = [&] {
    const Assignment assignment = label(snapshot, base, picture, matte, options).assignment;
    double share = 0;
    for (const AssignedPiece& piece : assignment.pieces)
      share += assignment.clips[piece.clip].name == "surf.mp4"
                   ? 1.0 / static_cast<double>(assignment.pieces.size())
                   : 0;
    return share;
  };
  options.guide_costs.unsteady = 0;
  EXPECT_GT(share_of_surf(), 0.1);
  options.guide_costs = {};
  EXPECT_LT(share_of_surf(), 0.03);
  options.guide = {};  // nobody asks where to: a sea may surge
  EXPECT_GT(share_of_surf(), 0.1);
}

}  // namespace
}  // namespace freshet::query
