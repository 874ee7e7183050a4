#include "query/search/coherent_candidates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "query/index/index_builder.h"
#include "query/index/search_base.h"
#include "query/labelling/labelling.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

class CoherentCandidates : public testing::Test {
 protected:
  CoherentCandidates() : store_(made_store(folder_.path() / "a.store", some_clips())) {
    build_index(store_);
    snapshot_ = store_.snapshot();
    base_ = open_search(*snapshot_);
  }
  CandidateSearch search(int coherent, const CandidateOptions& more = {}) {
    LabelOptions options;
    options.candidates = more;
    options.candidates.k = 5;
    options.candidates.coherent = coherent;
    cv::Mat picture;
    cv::cvtColor(made_texture(11), picture, cv::COLOR_GRAY2BGR);
    return search_candidates(*snapshot_, base_, picture, cv::Mat(144, 192, CV_8U, cv::Scalar(255)), options);
  }

  ScratchFolder folder_;
  store::Store store_;
  std::optional<store::Snapshot> snapshot_;
  SearchBase base_;
};

TEST_F(CoherentCandidates, PatchesAreFoundWhereTheyLieAndNowhereElse) {
  const stored::PatchTable& table = base_.table;
  for (stored::Row row = 0; row < table.size(); ++row) {
    EXPECT_EQ(find_patch(table, table.clip[row], table.variant[row], table.x[row], table.y[row]), row);
    EXPECT_EQ(find_patch(table, table.clip[row], table.variant[row], table.x[row] + 1, table.y[row]),
              stored::kNoRow);
  }
  EXPECT_EQ(find_patch(table, 0, 0, -24, 0), stored::kNoRow);
  EXPECT_EQ(find_patch(table, 0, 255, 0, 0), stored::kNoRow);
}

// The slow twin: every patch of the store that continues one of the neighbours' best.
TEST_F(CoherentCandidates, AreExactlyTheContinuationsOfTheNeighboursBest) {
  constexpr std::size_t kEach = 3;
  const CandidateSearch plain = search(0), joined = search(kEach);
  const stored::PatchTable& table = base_.table;
  std::size_t added = 0;
  for (std::size_t p = 0; p < plain.target.size(); ++p) {
    const auto own = plain.candidates.rows_of(p);
    std::set<stored::Row> expected(own.begin(), own.end());
    for (std::size_t q = 0; q < plain.target.size(); ++q) {
      const cv::Point step = plain.target.places[p] - plain.target.places[q];
      if (std::abs(step.x) + std::abs(step.y) != 1) continue;
      for (std::size_t i = 0; i < kEach; ++i) {
        const stored::Row from = plain.candidates.rows_of(q)[i];
        for (stored::Row row = 0; row < table.size(); ++row)
          if (table.clip[row] == table.clip[from] && table.variant[row] == table.variant[from] &&
              table.x[row] == table.x[from] + 24 * step.x && table.y[row] == table.y[from] + 24 * step.y)
            expected.insert(row);
      }
    }
    const auto found = joined.candidates.rows_of(p);
    EXPECT_EQ(std::set<stored::Row>(found.begin(), found.end()), expected);
    EXPECT_EQ(found.size(), expected.size()) << "a row twice";
    const auto scores = joined.candidates.scores_of(p);
    EXPECT_TRUE(std::is_sorted(scores.rbegin(), scores.rend()));
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_FLOAT_EQ(scores[i], static_cast<float>(vision::intersection(
                                     plain.target.queries[p].words, table.words[found[i]],
                                     base_.codebook.words, &plain.target.queries[p].mask)) /
                                     static_cast<float>(max_score(plain.target.queries[p])));
    added += found.size() - own.size();
  }
  EXPECT_GT(added, plain.target.size());
}

TEST_F(CoherentCandidates, KeepToTheConditions) {
  const CandidateSearch found = search(10, {.excluded_clips = {"fall.mp4", "river.mp4"}});
  for (std::size_t p = 0; p < found.target.size(); ++p)
    for (const stored::Row row : found.candidates.rows_of(p)) EXPECT_TRUE(found.filtered.rows.allows(row));
}

}  // namespace
}  // namespace freshet::query
