#include "query/costs/reuse.h"

#include <gtest/gtest.h>

#include "query/index/index_builder.h"
#include "query/labelling/labelling.h"
#include "query/search/coherent_candidates.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

class Neighbours : public testing::Test {
 protected:
  Neighbours() : store_(made_store(folder_.path() / "a.store", some_clips())), snapshot_(store_.snapshot()) {
    build_index(store_);
    snapshot_ = store_.snapshot();
    table_ = stored::read_patch_table(snapshot_);
  }
  /// What two neighbouring pieces, the second to the right, pay for a row each.
  float cost(stored::Row left, stored::Row right) const {
    Target target;
    target.places = {{0, 0}, {1, 0}};
    target.corners = {{0, 0}, {24, 0}};
    target.edges = {{0, 1}};
    Candidates candidates;
    candidates.k = 1;
    candidates.rows = {left, right};
    candidates.scores = {1, 1};
    candidates.counts = {1, 1};
    Mrf mrf;
    mrf.add_node(std::vector<float>{0});
    mrf.add_node(std::vector<float>{0});
    mrf.add_edge(0, 1);
    add_reuse_costs(snapshot_, made_settings(), table_, target, candidates, {.overlap = 2}, mrf);
    return *mrf.table(mrf.edges[0]);
  }
  stored::Row at(std::uint32_t clip, const vision::Variant& variant, int x, int y) const {
    const auto variants = made_settings().variants();
    const auto number = std::find(variants.begin(), variants.end(), variant) - variants.begin();
    return find_patch(table_, clip, static_cast<std::uint8_t>(number), x, y);
  }

  const ScratchFolder folder_;
  store::Store store_;
  store::Snapshot snapshot_;
  stored::PatchTable table_;
};

TEST_F(Neighbours, PayForWhatBothShowUnlessOneContinuesTheOther) {
  const vision::Variant plain{}, mirrored{.flip = true}, half{.scale = 0.5f};
  const stored::Row row = at(0, plain, 48, 24);
  ASSERT_NE(row, stored::kNoRow);
  EXPECT_NEAR(cost(row, row), 2, 1e-3) << "a stamp";
  EXPECT_EQ(cost(row, at(0, plain, 72, 24)), 0) << "the clip as it was";
  EXPECT_NEAR(cost(row, at(0, plain, 24, 24)), 1, 1e-3) << "the same step, backwards";
  EXPECT_NEAR(cost(row, at(0, plain, 72, 48)), 0.5, 1e-3);
  EXPECT_EQ(cost(row, at(0, plain, 96, 24)), 0) << "they share nothing";
  EXPECT_EQ(cost(row, at(1, plain, 48, 24)), 0) << "another clip";
  // The clip is 192 px wide: the mirror image of x 48..95 is at 96..143.
  EXPECT_NEAR(cost(row, at(0, mirrored, 96, 24)), 2, 1e-3);
  EXPECT_GT(cost(row, at(0, half, 24, 0)), 0.5);
}

TEST_F(Neighbours, AnEvenPictureIsNotStamped) {
  const SearchBase base = open_search(snapshot_);
  // Every piece looks the same, and one patch looks most like it.
  cv::Mat tile = made_texture(1)(cv::Rect(48, 24, 24, 24)), picture;
  cv::repeat(tile, 6, 8, picture);
  cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
  const cv::Mat matte(picture.size(), CV_8U, cv::Scalar(255));
  const auto equal_neighbours = [&](double overlap) {
    LabelOptions options;
    options.reuse.overlap = overlap;
    const Labelling found = label(snapshot_, base, picture, matte, options);
    int equal = 0;
    for (const auto& [p, q] : found.search.target.edges)
      equal += found.search.candidates.rows_of(p)[found.labels[p]] ==
               found.search.candidates.rows_of(q)[found.labels[q]];
    EXPECT_LE(found.assignment.lower_bound, found.assignment.energy + 1e-6);
    return equal;
  };
  EXPECT_GT(equal_neighbours(0), 3);
  EXPECT_EQ(equal_neighbours(0.5), 0);
}

}  // namespace
}  // namespace freshet::query
