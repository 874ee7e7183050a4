#include "bench/transfer/rivals/retrievals.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "synth/transfer/vote.h"
#include "tests/synth/transfer/made_pictures.h"

namespace freshet::bench {
namespace {

using namespace synth::transfer;

const std::vector<int>& interior(const Segments& of) { return of[Segment::kInterior]; }

std::int64_t most_used(const NearestField& field, const std::vector<int>& targets) {
  std::vector<std::int64_t> uses(field.source_places(), 0);
  for (const int target : targets)
    ++uses[static_cast<std::size_t>(field.source[static_cast<std::size_t>(target)])];
  return *std::max_element(uses.begin(), uses.end());
}

TEST(RivalRetrievals, NoOccurrenceIsMoreThanTwiceItsShare) {
  EXPECT_EQ(most_uses(100, 200), 4);
  EXPECT_EQ(most_uses(100, 125), 3);
  const MadePictures pictures({40, 36}, {70, 60}, 5);
  const std::vector<int>&sources = interior(pictures.from), &targets = interior(pictures.to);
  NearestField limited = pictures.field(), nearest = pictures.field();
  assign_limited(pictures.distance(), sources, targets, {}, limited);
  RetrievalSeconds seconds;
  assign_nearest(pictures.distance(), sources, targets, {}, nearest, seconds);
  EXPECT_GT(most_used(nearest, targets), most_uses(sources.size(), targets.size()));
  EXPECT_EQ(most_used(limited, targets), most_uses(sources.size(), targets.size()));
  for (const int target : targets) {
    const auto at = static_cast<std::size_t>(target);
    ASSERT_EQ(limited.distance[at], pictures.distance()(limited.source[at], target));
  }
}

TEST(RivalRetrievals, AnOverusedSourceIsAsManyTimesAsFarAsItIsOverused) {
  const MadePictures pictures({40, 36}, {70, 60}, 5);
  const std::vector<int>&sources = interior(pictures.from), &targets = interior(pictures.to);
  const PatchDistance distance = pictures.distance();
  NearestField field = pictures.field();
  RetrievalSeconds seconds;
  assign_nearest(distance, sources, targets, {}, field, seconds);
  std::vector<float> times(field.source_places(), 0.0f);
  for (const int target : targets)
    times[static_cast<std::size_t>(field.source[static_cast<std::size_t>(target)])] +=
        static_cast<float>(sources.size()) / static_cast<float>(targets.size());
  const auto cost = [&](int source, int target) {
    return static_cast<double>((distance(source, target) + kVoteFloor) *
                               std::max(1.0f, times[static_cast<std::size_t>(source)]));
  };
  double before = 0, found = 0, exact = 0;
  for (const int target : targets) {
    before += cost(field.source[static_cast<std::size_t>(target)], target);
    double least = std::numeric_limits<double>::infinity();
    for (const int source : sources) least = std::min(least, cost(source, target));
    exact += least;
  }
  assign_by_histogram(distance, sources, targets, {.passes = 8}, field);
  for (const int target : targets) {
    const auto at = static_cast<std::size_t>(target);
    found += cost(field.source[at], target);
    ASSERT_EQ(field.distance[at], distance(field.source[at], target));
  }
  EXPECT_GT(before, 1.5 * exact);
  EXPECT_LT(found, 1.1 * exact);
}

TEST(RivalRetrievals, CoherentCandidatesAreWhatNeighboursHaveAndWhatIsLikeIt) {
  const MadePictures pictures({40, 36}, {70, 60}, 5);
  const std::vector<int>&sources = interior(pictures.from), &targets = interior(pictures.to);
  const std::vector<float> none(pictures.source.values.size(), 0.0f);
  const PatchDistance to_itself(pictures.source, pictures.source, none, 5);
  const auto alike = most_alike(to_itself, sources, {40, 36}, 5, 8, 1);
  double found = 0, exact = 0;
  for (const int source : sources) {
    const int like = alike[static_cast<std::size_t>(source)];
    ASSERT_TRUE(std::abs(like % 40 - source % 40) > 5 || std::abs(like / 40 - source / 40) > 5);
    float least = std::numeric_limits<float>::infinity();
    for (const int other : sources)
      if (std::abs(other % 40 - source % 40) > 5 || std::abs(other / 40 - source / 40) > 5)
        least = std::min(least, to_itself(other, source));
    found += static_cast<double>(to_itself(like, source)), exact += static_cast<double>(least);
  }
  EXPECT_LT(found, 1.1 * exact);

  NearestField field = pictures.field();
  assign_coherent(pictures.distance(), sources, targets, alike, 5, {}, field);  // from nothing: the nearest
  const NearestField had = field;
  assign_coherent(pictures.distance(), sources, targets, alike, 5, {}, field);
  const std::set<int> open(sources.begin(), sources.end());
  for (const int target : targets) {
    float least = std::numeric_limits<float>::infinity();
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx) {
        const int beside = had.source[static_cast<std::size_t>(target + dy * 70 + dx)];
        if (beside < 0) continue;
        for (const int like : {beside, alike[static_cast<std::size_t>(beside)]})
          if (open.contains(like - dy * 40 - dx))
            least = std::min(least, pictures.distance()(like - dy * 40 - dx, target));
      }
    ASSERT_EQ(field.distance[static_cast<std::size_t>(target)], least);
  }
}

TEST(RivalRetrievals, EachSourceCompletesTheTargetNearestToIt) {
  const MadePictures pictures({30, 30}, {44, 40}, 3);
  const std::vector<int>&sources = interior(pictures.from), &targets = interior(pictures.to);
  std::vector<Completing> pairs;
  add_completing(pictures.distance(), sources, targets, {.passes = 8}, pictures.field(), 0.6, pairs);
  ASSERT_EQ(pairs.size(), sources.size());
  double found = 0, exact = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    ASSERT_EQ(pairs[i].source, sources[i]);
    const float distance = pictures.distance()(pairs[i].source, pairs[i].target);
    EXPECT_FLOAT_EQ(pairs[i].weight, static_cast<float>(targets.size()) / static_cast<float>(sources.size()) *
                                         vote_weight(distance, 0.6));
    float least = std::numeric_limits<float>::infinity();
    for (const int target : targets) least = std::min(least, pictures.distance()(sources[i], target));
    found += static_cast<double>(distance), exact += static_cast<double>(least);
  }
  EXPECT_LT(found, 1.1 * exact);
}

}  // namespace
}  // namespace freshet::bench
