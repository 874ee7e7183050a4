#include "synth/transfer/retrieval.h"

#include <algorithm>
#include <cstdio>
#include <tuple>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "freshet/error.h"
#include "tests/synth/transfer/made_pictures.h"

namespace freshet::synth::transfer {
namespace {

double total(const NearestField& field, const std::vector<int>& targets) {
  double sum = 0;
  for (const int target : targets)
    sum += static_cast<double>(field.distance[static_cast<std::size_t>(target)]);
  return sum;
}

TEST(UniformRetrieval, UsesEverySourceKOrKPlusOneTimes) {
  // More targets than sources, fewer, many more.
  const cv::Size sizes[][2] = {{{40, 36}, {70, 60}}, {{60, 60}, {40, 30}}, {{20, 20}, {90, 90}}};
  for (const auto& size : sizes)
    for (const Search search : {Search::kPatchMatch, Search::kExact}) {
      const MadePictures pictures(size[0], size[1], 5);
      for (const Segment segment : {Segment::kBoundary, Segment::kInterior}) {
        NearestField field = pictures.field();
        RetrievalSeconds seconds;
        assign_uniformly(pictures.distance(), pictures.from[segment], pictures.to[segment],
                         {.search = search}, field, seconds);
        expect_uniform(field, pictures.from[segment], pictures.to[segment]);
        // The other segment was left alone.
        for (std::size_t i = 0; i < field.source.size(); ++i)
          ASSERT_TRUE(pictures.to.of.values[i] == segment || field.source[i] == -1);
      }
    }
}

TEST(UniformRetrieval, DistancesAreThoseOfTheirPairs) {
  const MadePictures pictures({40, 36}, {70, 60}, 5);
  NearestField field = pictures.field();
  RetrievalSeconds seconds;
  assign_uniformly(pictures.distance(), pictures.from[Segment::kInterior], pictures.to[Segment::kInterior],
                   {}, field, seconds);
  for (const int target : pictures.to[Segment::kInterior]) {
    const std::size_t at = static_cast<std::size_t>(target);
    ASSERT_EQ(field.distance[at], pictures.distance()(field.source[at], target));
  }
}

// What Sec. 4.1 says, word by word.
NearestField obvious(const MadePictures& pictures, const std::vector<int>& sources,
                     const std::vector<int>& targets) {
  NearestField field = pictures.field();
  const PatchDistance distance = pictures.distance();
  std::vector<int> used(field.source_places(), 0);
  const int min_uses = static_cast<int>(targets.size() / sources.size());
  int left_over = static_cast<int>(targets.size() % sources.size());
  for (std::size_t left = targets.size(); left > 0;) {
    struct Candidate {
      float distance;
      int target, source;
      bool operator<(const Candidate& o) const {
        return std::tie(distance, target, source) < std::tie(o.distance, o.target, o.source);
      }
    };
    std::vector<Candidate> candidates;
    for (const int source : sources) {
      const int uses = used[static_cast<std::size_t>(source)];
      if (!(uses < min_uses || (uses == min_uses && left_over > 0))) continue;
      Candidate best{1e30f, 0, source};
      for (const int target : targets)
        if (field.source[static_cast<std::size_t>(target)] < 0)
          best = std::min(best, Candidate{distance(source, target), target, source});
      candidates.push_back(best);
    }
    std::sort(candidates.begin(), candidates.end());
    for (const Candidate& one : candidates) {
      if (field.source[static_cast<std::size_t>(one.target)] >= 0) continue;  // a nearer one has it
      // A target whose nearest finder may not take it stays open in this round.
      const bool nearest = std::none_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
        return other.target == one.target && other < one;
      });
      int& uses = used[static_cast<std::size_t>(one.source)];
      if (!nearest || !(uses < min_uses || (uses == min_uses && left_over > 0))) continue;
      left_over -= uses == min_uses;
      ++uses;
      field.source[static_cast<std::size_t>(one.target)] = one.source;
      field.distance[static_cast<std::size_t>(one.target)] = one.distance;
      --left;
    }
  }
  return field;
}

TEST(UniformRetrieval, ExactIsThePapersProcedure) {
  const MadePictures pictures({24, 22}, {40, 36}, 9);
  NearestField field = pictures.field();
  RetrievalSeconds seconds;
  const std::vector<int>&sources = pictures.from[Segment::kBoundary],
        &targets = pictures.to[Segment::kBoundary];
  assign_uniformly(pictures.distance(), sources, targets, {.search = Search::kExact}, field, seconds);
  const NearestField truth = obvious(pictures, sources, targets);
  for (const int target : targets)
    ASSERT_EQ(field.source[static_cast<std::size_t>(target)], truth.source[static_cast<std::size_t>(target)]);
}

// From nothing, which no level of a frame but the coarsest begins with; then on from what is known.
TEST(UniformRetrieval, ExchangesComeNearTheExactRounds) {
  const MadePictures pictures({64, 60}, {96, 80}, 7);
  double exact_sum = 0, first_sum = 0, fourth_sum = 0;
  for (const Segment segment : {Segment::kBoundary, Segment::kInterior}) {
    NearestField exact = pictures.field(), fast = pictures.field();
    RetrievalSeconds seconds;
    const std::vector<int>&sources = pictures.from[segment], &targets = pictures.to[segment];
    assign_uniformly(pictures.distance(), sources, targets, {.search = Search::kExact}, exact, seconds);
    exact_sum += total(exact, targets);
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      assign_uniformly(pictures.distance(), sources, targets, {.seed = seed}, fast, seconds);
      expect_uniform(fast, sources, targets);
      if (seed == 1) first_sum += total(fast, targets);
      if (seed == 4) fourth_sum += total(fast, targets);
    }
  }
  std::printf("[ measured ] exchanges / exact: first %.3f, fourth %.3f\n", first_sum / exact_sum,
              fourth_sum / exact_sum);
  EXPECT_LT(fourth_sum, 0.9 * exact_sum);
}

TEST(UniformRetrieval, IsTheSameForAnyNumberOfThreads) {
  const MadePictures pictures({64, 60}, {96, 80}, 3);
  NearestField fields[2] = {pictures.field(), pictures.field()};
  for (std::size_t k = 0; k < 2; ++k) {
    const oneapi::tbb::global_control threads(oneapi::tbb::global_control::max_allowed_parallelism,
                                              1 + 3 * k);
    RetrievalSeconds seconds;
    assign_uniformly(pictures.distance(), pictures.from[Segment::kInterior], pictures.to[Segment::kInterior],
                     {}, fields[k], seconds);
  }
  EXPECT_EQ(fields[0].source, fields[1].source);
}

TEST(UniformRetrieval, RefusesAnExactSearchOfBigPictures) {
  const MadePictures pictures({400, 400}, {400, 400}, 3);
  NearestField field = pictures.field();
  RetrievalSeconds seconds;
  EXPECT_THROW(assign_uniformly(pictures.distance(), pictures.from[Segment::kInterior],
                                pictures.to[Segment::kInterior], {.search = Search::kExact}, field, seconds),
               Error);
}

TEST(NearestRetrieval, PatchMatchComesNearTheNearest) {
  const MadePictures pictures({64, 60}, {96, 80}, 7);
  NearestField exact = pictures.field(), fast = pictures.field();
  RetrievalSeconds seconds;
  const std::vector<int>&sources = pictures.from[Segment::kInterior],
        &targets = pictures.to[Segment::kInterior];
  assign_nearest(pictures.distance(), sources, targets, {.search = Search::kExact}, exact, seconds);
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    assign_nearest(pictures.distance(), sources, targets, {.seed = seed}, fast, seconds);
  EXPECT_GE(total(fast, targets), total(exact, targets));
  std::printf("[ measured ] PatchMatch / exact: %.3f\n", total(fast, targets) / total(exact, targets));
  EXPECT_LT(total(fast, targets), 1.1 * total(exact, targets));
}

}  // namespace
}  // namespace freshet::synth::transfer
