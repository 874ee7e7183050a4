#include "bench/quality/quality_agreement.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace freshet::bench {
namespace {

TEST(QualityAgreement, EqualValuesShareTheirRanks) {
  EXPECT_EQ(ranks_of(std::vector{5.0, 1.0, 5.0, 9.0}), (std::vector{2.5, 1.0, 2.5, 4.0}));
}

TEST(QualityAgreement, SpearmanIsOfOrderAlone) {
  const std::vector<double> a{1, 2, 3, 4}, same{1, 10, 100, 1000}, turned{9, 7, 5, 3}, all_one{2, 2, 2, 2};
  EXPECT_DOUBLE_EQ(spearman(a, same), 1);
  EXPECT_DOUBLE_EQ(spearman(a, turned), -1);
  EXPECT_DOUBLE_EQ(spearman(a, std::vector<double>{1, 3, 2, 4}), 0.8);
  EXPECT_TRUE(std::isnan(spearman(a, all_one)));
  EXPECT_TRUE(std::isnan(spearman(std::vector{1.0, 2.0}, std::vector{1.0, 2.0})));
}

Judged film(const char* clip, double badness, double faults) {
  Judged judged{.clip = clip, .class_name = "water", .method = "m", .render_s = 1};
  Distance& d = judged.distance;
  d.spectrum_db = d.texture = d.lifetime = d.flicker = d.pace = d.drift = badness;
  d.again_beyond = badness;
  d.patches = {badness, badness, badness, 0, 0};
  d.faults = faults;
  return judged;
}

TEST(QualityAgreement, TheChoiceAndTheFirstFilmHaveTheirPlacesInTheTruthsOrder) {
  const std::vector<Judged> judged{film("a", 3, 2), film("b", 1, 1), film("a", 1, 1),
                                   film("a", 2, 5), film("b", 2, 3), film("b", 3, 2)};
  const std::vector<Agreement> all = agreements(judged);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].films, 3);
  EXPECT_DOUBLE_EQ(all[0].correlation, 0.5);
  EXPECT_DOUBLE_EQ(all[0].chosen, 0);
  EXPECT_DOUBLE_EQ(all[0].first, 1);
  EXPECT_DOUBLE_EQ(all[1].first, 0);
}

TEST(QualityAgreement, ReferencesAndFilmsThatWereNotJudgedAreLeftOut) {
  std::vector<Judged> judged{film("a", 1, 1), film("a", 2, 2)};
  judged[0].render_s = 0;
  judged[1].distance.faults = kNotMeasured;
  EXPECT_TRUE(agreements(judged).empty());
}

TEST(QualityAgreement, HalvesOfTheTruthsMeasuresAgreeOrDoNot) {
  std::vector<Judged> judged{film("a", 1, 1), film("a", 2, 2), film("a", 3, 3)};
  EXPECT_DOUBLE_EQ(agreements(judged)[0].halves, 1);
  // Half of the measures order them the other way round: so do the halves of each halving, or they order nothing.
  for (Judged& one : judged) {
    Distance& d = one.distance;
    d.spectrum_db = d.texture = d.lifetime = d.flicker = 4 - d.pace;
  }
  EXPECT_DOUBLE_EQ(agreements(judged)[0].halves, -1);
}

// One measure that a film lacks does not count for the others.
TEST(QualityAgreement, AMeasureThatOneFilmLacksCountsForNone) {
  std::vector<Judged> judged{film("a", 1, 1), film("a", 2, 2), film("a", 3, 3)};
  judged[1].distance.lifetime = kNotMeasured;
  EXPECT_DOUBLE_EQ(agreements(judged)[0].correlation, 1);
}

}  // namespace
}  // namespace freshet::bench
