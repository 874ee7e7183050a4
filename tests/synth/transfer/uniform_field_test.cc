#include "synth/transfer/uniform_field.h"

#include <cstdio>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "tests/synth/transfer/made_pictures.h"

namespace freshet::synth::transfer {
namespace {

TEST(UniformField, EveryPassKeepsUniformUseAndComesNearer) {
  // More targets than sources, fewer, many more.
  const cv::Size sizes[][2] = {{{40, 36}, {70, 60}}, {{60, 60}, {40, 30}}, {{20, 20}, {90, 90}}};
  for (const auto& size : sizes) {
    const MadePictures pictures(size[0], size[1], 5);
    const PatchDistance distance = pictures.distance();
    for (const Segment segment : {Segment::kBoundary, Segment::kInterior}) {
      const std::vector<int>&sources = pictures.from[segment], &targets = pictures.to[segment];
      NearestField field = pictures.field();
      UniformField uniform(distance, sources, targets, 1, field);
      double before = 1e30;
      for (int pass = 0; pass < 6; ++pass) {
        expect_uniform(field, sources, targets);
        double sum = 0;
        for (const int target : targets) {
          const auto at = static_cast<std::size_t>(target);
          ASSERT_EQ(field.distance[at], distance(field.source[at], target));
          sum += static_cast<double>(field.distance[at]);
        }
        EXPECT_LT(sum, before);
        before = sum;
        uniform.exchange(pass);
      }
      // The other segment was left alone.
      for (std::size_t i = 0; i < field.source.size(); ++i)
        ASSERT_TRUE(pictures.to.of.values[i] == segment || field.source[i] == -1);
    }
  }
}

TEST(UniformField, KeepsWhatIsUniformAlready) {
  const MadePictures pictures({40, 36}, {70, 60}, 5);
  const std::vector<int>&sources = pictures.from[Segment::kInterior],
        &targets = pictures.to[Segment::kInterior];
  NearestField field = pictures.field();
  for (std::size_t i = 0; i < targets.size(); ++i)
    field.source[static_cast<std::size_t>(targets[i])] = sources[i % sources.size()];
  const std::vector<std::int32_t> given = field.source;
  const PatchDistance distance = pictures.distance();
  UniformField uniform(distance, sources, targets, 1, field);
  EXPECT_EQ(field.source, given);
  // Of a source that is used too often, the nearest stay.
  for (const int target : targets) field.source[static_cast<std::size_t>(target)] = sources[7];
  UniformField again(distance, sources, targets, 1, field);
  expect_uniform(field, sources, targets);
  float farthest_kept = 0;
  for (const int target : targets)
    if (field.source[static_cast<std::size_t>(target)] == sources[7])
      farthest_kept = std::max(farthest_kept, field.distance[static_cast<std::size_t>(target)]);
  std::size_t nearer = 0;
  for (const int target : targets) nearer += distance(sources[7], target) < farthest_kept;
  EXPECT_LE(nearer, targets.size() / sources.size());
}

TEST(UniformField, IsTheSameForAnyNumberOfThreads) {
  const MadePictures pictures({64, 60}, {96, 80}, 3);
  NearestField fields[2] = {pictures.field(), pictures.field()};
  const PatchDistance distance = pictures.distance();
  for (std::size_t k = 0; k < 2; ++k) {
    const oneapi::tbb::global_control threads(oneapi::tbb::global_control::max_allowed_parallelism,
                                              1 + 3 * k);
    UniformField uniform(distance, pictures.from[Segment::kInterior], pictures.to[Segment::kInterior], 4,
                         fields[k]);
    for (int pass = 0; pass < 4; ++pass) uniform.exchange(pass);
  }
  EXPECT_EQ(fields[0].source, fields[1].source);
}

}  // namespace
}  // namespace freshet::synth::transfer
