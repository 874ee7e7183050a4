#include "synth/simulate/simulate.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/video.hpp>

#include "freshet/error.h"
#include "tests/harness/fault.h"
#include "tests/synth/simulate/sample_hash.h"

namespace freshet::synth::simulate {
namespace {

std::uint64_t hash_of(const SceneOptions& options, int threads) {
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(threads));
  Simulation clip(options);
  SimulatedFrame frame;
  std::uint64_t hash = 1;
  while (clip.next(frame))
    for (const cv::Mat& mat : {frame.picture, frame.alpha, frame.motion}) hash = hash_of_samples(mat, hash);
  return hash;
}

class EveryPreset : public ::testing::TestWithParam<SceneKind> {};
INSTANTIATE_TEST_SUITE_P(Presets, EveryPreset,
                         ::testing::ValuesIn(all_clip_kinds().begin(), all_clip_kinds().end()),
                         [](const auto& tested) { return std::string(scene_kind_name(tested.param)); });

TEST_P(EveryPreset, GivesTheSameBytesForAnyNumberOfThreads) {
  const SceneOptions options{.kind = GetParam(), .size = {210, 134}, .frames = 3, .warm_up_frames = 12};
  const std::uint64_t one = hash_of(options, 1);
  EXPECT_EQ(one, hash_of(options, 2));
  EXPECT_EQ(one, hash_of(options, 8));
}

// What simulate.h promises of every x86-64. Whoever changes what a clip looks like puts the new hashes here, and says
// so in the history: clips of the same name and seed are then others than before.
TEST_P(EveryPreset, GivesTheBytesThatItGaveOnOtherMachines) {
  const std::map<SceneKind, std::uint64_t> expected{
      {SceneKind::kSmoke, 0xe5af0529786986edULL},    {SceneKind::kFire, 0xab4416d4ab5b5bd0ULL},
      {SceneKind::kInk, 0x636345ad26cf3cccULL},      {SceneKind::kWaterfall, 0x9ef3e1a114da82a6ULL},
      {SceneKind::kRiver, 0xf3a79bc81c1fdd62ULL},    {SceneKind::kClouds, 0x04b5b7dde4e2d353ULL},
      {SceneKind::kSea, 0x28ceb5cbc4f111d2ULL},      {SceneKind::kRain, 0x55e0cd4a09bb3ff8ULL},
      {SceneKind::kFountain, 0xd3262e1f04aeccfcULL}, {SceneKind::kBreakers, 0x944e7ec41e664617ULL}};
  const SceneOptions options{
      .kind = GetParam(), .size = {210, 134}, .frames = 3, .seed = 20, .warm_up_frames = 12};
  EXPECT_EQ(hash_of(options, 2), expected.at(GetParam()));
}

TEST_P(EveryPreset, ChangesWithTheSeed) {
  std::map<std::uint64_t, std::uint64_t> seen;
  for (const std::uint64_t seed : {0ULL, 1ULL, 2ULL, ~0ULL}) {
    SceneOptions options{
        .kind = GetParam(), .size = {96, 64}, .frames = 1, .seed = seed, .warm_up_frames = 10};
    EXPECT_TRUE(seen.emplace(hash_of(options, 2), seed).second) << seed;
  }
}

TEST_P(EveryPreset, YieldsAsManyFramesAsAskedOfTheRightShape) {
  const cv::Size sizes[] = {{16, 16}, {17, 301}, {333, 16}, {101, 77}};
  for (const cv::Size size : sizes) {
    Simulation clip({.kind = GetParam(), .size = size, .frames = 4, .warm_up_frames = 20});
    SimulatedFrame frame;
    int frames = 0;
    for (; clip.next(frame); ++frames) {
      ASSERT_EQ(frame.picture.size(), size);
      ASSERT_EQ(frame.picture.type(), CV_8UC3);
      ASSERT_EQ(frame.alpha.size(), size);
      ASSERT_EQ(frame.alpha.type(), CV_8U);
      ASSERT_EQ(frame.motion.size(), size);
      ASSERT_EQ(frame.motion.type(), CV_32FC2);
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          const cv::Vec2f m = frame.motion.at<cv::Vec2f>(y, x);
          ASSERT_TRUE(std::isfinite(m[0]) && std::isfinite(m[1]));
          ASSERT_TRUE(frame.alpha.at<std::uint8_t>(y, x) > 0 || (m[0] == 0.0f && m[1] == 0.0f));
        }
      }
    }
    EXPECT_EQ(frames, 4);
    EXPECT_FALSE(clip.next(frame));
  }
}

/// Speed of the fluid, and how far measured flow lies from the field, both over textured pixels that the
/// fluid covers.
struct Agreement {
  double speed = 0.0, error = 0.0, still_error = 0.0, covered = 0.0;
};
Agreement agreement(SceneKind kind, std::uint64_t seed) {
  Simulation clip({.kind = kind, .size = {320, 180}, .frames = 7, .seed = seed});
  SimulatedFrame frame;
  clip.next(frame);
  cv::Mat before, after, motion, alpha, flow, gx, gy;
  const cv::Ptr<cv::DISOpticalFlow> dis = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
  Agreement sum;
  double pixels = 0.0, frames = 0.0;
  cv::cvtColor(frame.picture, before, cv::COLOR_BGR2GRAY);
  motion = frame.motion.clone(), alpha = frame.alpha.clone();
  while (clip.next(frame)) {
    cv::cvtColor(frame.picture, after, cv::COLOR_BGR2GRAY);
    dis->calc(before, after, flow);
    cv::Sobel(before, gx, CV_32F, 1, 0), cv::Sobel(before, gy, CV_32F, 0, 1);
    for (int y = 8; y < flow.rows - 8; ++y) {
      for (int x = 8; x < flow.cols - 8; ++x) {
        if (alpha.at<std::uint8_t>(y, x) < 64) continue;
        sum.covered += 1.0;
        if (std::hypot(gx.at<float>(y, x), gy.at<float>(y, x)) < 60.0f) continue;
        const cv::Vec2f d = flow.at<cv::Vec2f>(y, x), m = motion.at<cv::Vec2f>(y, x);
        sum.error += std::hypot(d[0] - m[0], d[1] - m[1]);
        sum.speed += std::hypot(m[0], m[1]);
        pixels += 1.0;
      }
    }
    std::swap(before, after);
    motion = frame.motion.clone(), alpha = frame.alpha.clone();
    frames += 1.0;
  }
  sum.speed /= pixels, sum.error /= pixels, sum.covered /= frames * 320 * 180;
  return sum;
}

TEST_P(EveryPreset, ShowsEachOfItsVariations) {
  const auto hash_with = [](const ClipVariation& variation) {
    return hash_of({.kind = GetParam(),
                    .size = {96, 64},
                    .frames = 2,
                    .seed = 3,
                    .variation = variation,
                    .warm_up_frames = 10},
                   2);
  };
  const std::uint64_t plain = hash_with({});
  EXPECT_NE(plain, hash_with({.speed = 1.7f}));
  EXPECT_NE(plain, hash_with({.zoom = 0.6f}));
  EXPECT_NE(plain, hash_with({.amount = 0.5f}));
}

TEST_P(EveryPreset, GoesOnFasterAsItDoesSlower) {
  const SceneOptions slow{.kind = GetParam(), .size = {96, 64}, .frames = 6, .seed = 3, .warm_up_frames = 10};
  SceneOptions fast = slow;
  fast.variation.speed = 2.0f;
  fast.warm_up_frames = 5;
  Simulation one(slow), other(fast);
  SimulatedFrame a, b;
  for (int i = 0; i < 3; ++i) {
    one.next(a), one.next(a), other.next(b);
    EXPECT_EQ(cv::norm(a.alpha, b.alpha, cv::NORM_INF), 0.0) << i;
    EXPECT_EQ(cv::norm(a.motion * 2, b.motion, cv::NORM_INF), 0.0) << i;
  }
}

TEST_P(EveryPreset, MovesAsItsMotionFieldSays) {
  // Waves go through each other: where one goes is not where the light on them goes.
  if (GetParam() == SceneKind::kSea || GetParam() == SceneKind::kRain || GetParam() == SceneKind::kBreakers)
    return;
  const Agreement a = agreement(GetParam(), 3);
  EXPECT_GT(a.speed, 0.5) << "px per frame at 320 x 180: it hardly moves";
  EXPECT_LT(a.speed, 8.0);
  EXPECT_GT(a.covered, 0.02) << "hardly any fluid in the picture";
  // Against a field of zeros the error would be the speed itself.
  // Flames are lit and burn out while they rise, which an estimator of motion takes for motion.
  const double fraction = GetParam() == SceneKind::kFire ? 0.8 : 0.6;
  EXPECT_LT(a.error, fraction * a.speed) << a.speed << " px per frame";
}

TEST(Simulation, KeepsItsBackgroundStill) {
  Simulation clip(
      {.kind = SceneKind::kRiver, .size = {240, 136}, .frames = 6, .seed = 3, .warm_up_frames = 5});
  SimulatedFrame first, later;
  ASSERT_TRUE(clip.next(first));
  first = {first.picture.clone(), first.alpha.clone(), first.motion.clone(), {}};
  int still = 0;
  while (clip.next(later)) {
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 240; ++x) {
        // Bloom reaches a little into the land: look where nothing wet is near.
        if (y > 8 || first.alpha.at<std::uint8_t>(y, x) || later.alpha.at<std::uint8_t>(y, x)) continue;
        const cv::Vec3b a = first.picture.at<cv::Vec3b>(y, x), b = later.picture.at<cv::Vec3b>(y, x);
        for (int c = 0; c < 3; ++c) ASSERT_LE(std::abs(a[c] - b[c]), 6);
        ++still;
      }
    }
  }
  EXPECT_GT(still, 1000);
}

TEST(SceneOptions, RefuseWhatIsOutOfRangeAndSayWhatIsAllowed) {
  const std::vector<SceneOptions> wrong{{.size = {15, 100}}, {.size = {100, 4097}}, {.frames = 0},
                                        {.fps = 0.0},        {.fps = std::nan("")}, {.warm_up_frames = -2}};
  for (const SceneOptions& options : wrong) {
    fault_of(ErrorKind::kUsage, [&] { Simulation clip(options); });
  }
}

TEST(SceneOptions, AnUnknownPresetIsAnsweredWithTheList) {
  for (const SceneKind kind : all_clip_kinds()) EXPECT_EQ(parse_scene_kind(scene_kind_name(kind)), kind);
  const std::string fault = fault_of(ErrorKind::kUsage, [&] { parse_scene_kind("lava"); });
  for (const SceneKind kind : all_clip_kinds())
    EXPECT_NE(fault.find(scene_kind_name(kind)), std::string::npos);
}

}  // namespace
}  // namespace freshet::synth::simulate
