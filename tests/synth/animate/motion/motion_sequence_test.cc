#include "synth/animate/motion/motion_sequence.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/sampling/pull_push.h"
#include "tests/synth/animate/flowing_clip.h"

namespace freshet::synth::animate {
namespace {

constexpr double kFps = 25;
constexpr int kSquare = 8;

std::vector<ShownFrame> shown(std::initializer_list<std::uint32_t> frames, double rate = 1) {
  std::vector<ShownFrame> shown;
  for (const std::uint32_t frame : frames) shown.push_back({.frame = frame, .rate = rate});
  return shown;
}

Placement placement_of(store::ClipId clip, const vision::Variant& variant, cv::Point patch) {
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 4; ++column)
      placement.patches.push_back({.piece = {24 * column - 8, 24 * row - 8},
                                   .clip = clip,
                                   .variant = variant,
                                   .patch = patch + cv::Point(5 * column, 3 * row)});
  return placement;
}

PlayedPatches all_of(const Placement& placement, std::vector<ShownFrame> frames) {
  PlayedPatches played{.clip = placement.patches.front().clip, .patches = {}, .shown = std::move(frames)};
  for (std::size_t p = 0; p < placement.patches.size(); ++p) played.patches.push_back(p);
  return played;
}

MotionSequence sequence_of(const store::Snapshot& snapshot, const vision::Settings& settings,
                           const Placement& placement, std::span<const PlayedPatches> played,
                           cv::Size picture, int frames) {
  MotionSums sums(snapshot, settings, placement, picture, frames);
  for (const PlayedPatches& group : played) sums.add(group);
  return std::move(sums).means();
}

TEST(MotionSequence, SteadyFlowIsTurnedScaledAndPlayedAsItsVariantIs) {
  const FlowingClip clip{.size = {220, 180}, .steady = {2.0f, -1.0f}, .varying = 0};
  const FlowingStore store({clip});
  const cv::Size picture(100, 70);
  for (const vision::Variant variant :
       {vision::Variant{}, vision::Variant{1, 0, true}, vision::Variant{0.5f, 0, false},
        vision::Variant{1, 22.5f, false}, vision::Variant{0.75f, -22.5f, true}})
    for (const double rate : {1.0, 0.6})
      for (const double scale : {1.0, 1.5}) {
        Placement placement = placement_of(store.id(), variant, {20, 20});
        placement.piece_scale = scale;
        const std::vector played{all_of(placement, shown({0, 19, 7}, rate))};
        const MotionSequence sequence =
            sequence_of(store.snapshot(), store.settings(), placement, played, picture, 3);
        const cv::Vec2d expected = vision::variant_frame(clip.size, variant).variant_from_source_velocity *
                                   cv::Vec2d(2 * kFps * rate * scale, -1 * kFps * rate * scale);
        for (int i = 0; i < 3; ++i) {
          const cv::Mat motion = sequence.at(i);
          ASSERT_EQ(motion.size(), picture);
          ASSERT_EQ(motion.type(), CV_32FC2);
          const cv::Scalar value(expected[0], expected[1]);
          EXPECT_LT(cv::norm(motion, cv::Mat(picture, CV_32FC2, value), cv::NORM_INF), 0.01)
              << variant.scale << " " << variant.rotation_deg << " " << variant.flip << " " << rate;
        }
      }
}

TEST(MotionSequence, FramesThatLieFurtherApartMoveNoFaster) {
  FlowingClip clip{.size = {220, 180}, .frames = 4, .steady = {2.0f, -1.0f}, .varying = 0};
  clip.rates = {kFps, kFps / 2, 2 * kFps};
  const FlowingStore store({clip});
  const Placement placement = placement_of(store.id(), {}, {20, 20});
  const std::vector played{all_of(placement, shown({0, 1, 2}))};
  const MotionSequence sequence =
      sequence_of(store.snapshot(), store.settings(), placement, played, {100, 70}, 3);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(sequence.at(i).at<cv::Vec2f>(30, 50)[0], 2 * clip.rates[static_cast<std::size_t>(i)], 0.01)
        << i;
  clip.rates = {kFps, 0, kFps};
  const FlowingStore broken({clip});
  EXPECT_THROW(sequence_of(broken.snapshot(), broken.settings(), placement_of(broken.id(), {}, {20, 20}),
                           played, {100, 70}, 3),
               Error);
}

TEST(MotionSequence, TellsHowMuchEachPatchDiffersFromItsMean) {
  FlowingClip clip{.size = {220, 180}, .frames = 40, .steady = {2.0f, -1.0f}, .varying = 0};
  clip.rates.assign(39, kFps);
  for (int i = 0; i < 39; i += 2) clip.rates[static_cast<std::size_t>(i)] = 2 * kFps;
  const FlowingStore store({clip});
  Placement placement = placement_of(store.id(), {}, {20, 20});
  placement.piece_scale = 1.5;
  // Patches that go fast while others are slow: what they do together is even. A frame that is shown again counts so.
  std::vector<PlayedPatches> played(2, {.clip = store.id(), .patches = {}, .shown = {}});
  for (std::size_t p = 0; p < placement.patches.size(); ++p) played[p % 2].patches.push_back(p);
  played[0].shown = shown({0, 0, 33, 1});
  played[1].shown = shown({33, 1, 0, 0});
  const cv::Size size(25, 17);
  const cv::Mat variance =
      sequence_of(store.snapshot(), store.settings(), placement, played, {100, 70}, 4).own_variance(4, size);
  const double half = 0.5 * std::hypot(2, 1) * kFps * placement.piece_scale;  // twice as fast, and as slow
  EXPECT_LT(cv::norm(variance, cv::Mat(size, CV_32F, cv::Scalar(half * half)), cv::NORM_INF), 1);
}

TEST(MotionSequence, GoesOnWhereAClipShowsAFrameTwice) {
  FlowingClip clip{.size = {220, 180}, .frames = 20, .steady = {2.0f, -1.0f}, .varying = 0};
  clip.rates.assign(19, kFps);
  clip.rates[7] = kFps / 100;
  const FlowingStore store({clip});
  const Placement placement = placement_of(store.id(), {}, {20, 20});
  const auto of = [&](std::initializer_list<std::uint32_t> frames) {
    return sequence_of(store.snapshot(), store.settings(), placement,
                       std::vector{all_of(placement, shown(frames))}, {100, 70},
                       static_cast<int>(frames.size()));
  };
  const MotionSequence whole = of({5, 6, 7, 8, 9});
  EXPECT_NEAR(whole.at(2).at<cv::Vec2f>(30, 50)[0], 2 * kFps, 0.01);
  EXPECT_LT(cv::norm(whole.own_variance(4, {25, 17}), cv::NORM_INF), 1);
  // What stands longer than a step has come to rest.
  EXPECT_NEAR(of({6, 7}).at(1).at<cv::Vec2f>(30, 50)[0], 2 * clip.rates[7], 0.01);
}

/// The same, square by square and sample by sample, for one upright or mirrored variant at scale 1.
cv::Mat obvious_squares(const FlowingClip& clip, const Placement& placement, std::uint32_t frame, double rate,
                        cv::Size grid) {
  const auto flow = clip.flow(static_cast<int>(std::min<std::uint32_t>(frame, clip.frames - 2)));
  const auto sample = [&](int component, int x, int y) {
    return flow[component].at<std::int16_t>(std::clamp(y, 0, flow[component].rows - 1),
                                            std::clamp(x, 0, flow[component].cols - 1)) /
           64.0 * kFps;
  };
  const auto averaged = [&](int component, int x, int y) {  // over 5 x 5 samples: about a square
    double sum = 0;
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx) sum += sample(component, x + dx, y + dy);
    return sum / 25;
  };
  const auto between = [&](int component, double x, double y) {
    x = std::clamp(x, 0.0, flow[0].cols - 1.0), y = std::clamp(y, 0.0, flow[0].rows - 1.0);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const int x1 = std::min(x0 + 1, flow[0].cols - 1), y1 = std::min(y0 + 1, flow[0].rows - 1);
    const double fx = x - x0, fy = y - y0;
    return (1 - fy) * ((1 - fx) * averaged(component, x0, y0) + fx * averaged(component, x1, y0)) +
           fy * ((1 - fx) * averaged(component, x0, y1) + fx * averaged(component, x1, y1));
  };
  cv::Mat sum = cv::Mat::zeros(grid, CV_64FC2), mass = cv::Mat::zeros(grid, CV_64F);
  constexpr int kPerSide = 48 / kSquare;
  for (const PlacedPatch& placed : placement.patches)
    for (int row = 0; row < kPerSide; ++row)
      for (int column = 0; column < kPerSide; ++column) {
        const auto fall = [](int i) { return 1 - std::abs((2.0 * i + 1) / kPerSide - 1); };
        const double weight = fall(row) * fall(column);
        double x = placed.patch.x + column * kSquare + (kSquare - 1) / 2.0;
        const double y = placed.patch.y + row * kSquare + (kSquare - 1) / 2.0;
        if (placed.variant.flip) x = clip.size.width - 1 - x;
        const double fx = (x + 0.5) / clip.flow_step - 0.5, fy = (y + 0.5) / clip.flow_step - 0.5;
        const cv::Vec2d v((placed.variant.flip ? -1 : 1) * between(0, fx, fy), between(1, fx, fy));
        const cv::Point at((placed.piece.x + 8) / kSquare + column, (placed.piece.y + 8) / kSquare + row);
        sum.at<cv::Vec2d>(at) += weight * rate * v;
        mass.at<double>(at) += weight;
      }
  // Means; nothing faster than 2.5 times the mean; what hardly moves counts little; smoothed.
  cv::Mat squares = cv::Mat::zeros(grid, CV_32FC2), trust = cv::Mat::zeros(grid, CV_32F);
  double speeds = 0, covered = 0;
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      if (mass.at<double>(y, x) == 0) continue;
      squares.at<cv::Vec2f>(y, x) = sum.at<cv::Vec2d>(y, x) / mass.at<double>(y, x);
      speeds += cv::norm(squares.at<cv::Vec2f>(y, x)), ++covered;
    }
  const double mean = speeds / covered;
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      auto& v = squares.at<cv::Vec2f>(y, x);
      const double speed = cv::norm(v);
      if (speed > 2.5 * mean) v *= 2.5 * mean / speed;
      trust.at<float>(y, x) = static_cast<float>(std::pow(std::min(1.0, 2 * speed / mean), 2));
    }
  cv::Mat smooth = sampling::pull_push(squares, trust);
  cv::GaussianBlur(smooth, smooth, {}, 1.25, 1.25, cv::BORDER_REPLICATE);
  return smooth;
}

TEST(MotionSequence, IsTheWeightedMeanOfItsPatchesFlowSquareBySquare) {
  const FlowingClip clip{.size = {200, 160}, .frames = 40, .steady = {1.0f, 0.5f}, .varying = 1.5f};
  const FlowingStore store({clip});
  const cv::Size picture(112, 80);
  for (const bool flip : {false, true}) {
    Placement placement = placement_of(store.id(), {1, 0, flip}, {40, 30});
    placement.patches[1].patch = {0, 0};  // at the clip's corners the flow's edge goes on
    placement.patches[2].patch = {152, 112};
    // Out of order, over several slabs, and the last frame, from which no flow leads on.
    const std::vector<ShownFrame> frames = shown({33, 2, 15, 16, 39, 2}, 0.8);
    const std::vector played{all_of(placement, frames)};
    const MotionSequence sequence = sequence_of(store.snapshot(), store.settings(), placement, played,
                                                picture, static_cast<int>(frames.size()));
    // The first square begins with the first piece, 8 px before the picture.
    const cv::Size grid((picture.width + 8) / kSquare, (picture.height + 8) / kSquare);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const cv::Mat squares = obvious_squares(clip, placement, frames[i].frame, 0.8, grid);
      const cv::Mat motion = sequence.at(static_cast<int>(i));
      for (int row = 1; row < grid.height; ++row)
        for (int column = 1; column < grid.width; ++column) {
          // Pixels around the middle of a square: their mean is the square's, where motion is all but straight.
          const cv::Rect middle((column - 1) * kSquare + 3, (row - 1) * kSquare + 3, 2, 2);
          const cv::Scalar mean = cv::mean(motion(middle));
          const cv::Vec2f expected = squares.at<cv::Vec2f>(row, column);
          EXPECT_NEAR(mean[0], expected[0], 0.5) << i << " " << row << " " << column;
          EXPECT_NEAR(mean[1], expected[1], 0.5) << i << " " << row << " " << column;
        }
    }
  }
}

TEST(MotionSequence, IsTheSameForAnyNumberOfThreadsAndOrderOfFrames) {
  const FlowingClip clip{.size = {200, 160}, .frames = 40, .varying = 2};
  const FlowingStore store({clip, {.size = {150, 110}, .frames = 30, .steady = {0, 2}, .seed = 3}});
  Placement placement = placement_of(store.id(0), {0.75f, 22.5f, false}, {30, 25});
  placement.patches[3] = {
      .piece = placement.patches[3].piece, .clip = store.id(1), .variant = {}, .patch = {9, 8}};
  const auto made = [&](int threads, const std::vector<ShownFrame>& frames) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
    std::vector played{all_of(placement, frames), PlayedPatches{store.id(1), {3}, frames}};
    std::erase(played[0].patches, 3u);
    const MotionSequence sequence =
        sequence_of(store.snapshot(), store.settings(), placement, played, {100, 70}, 4);
    std::vector<cv::Mat> motion;
    for (int i = 0; i < 4; ++i) motion.push_back(sequence.at(i));
    motion.push_back(sequence.own_variance(4, {25, 17}));
    return motion;
  };
  const auto reference = made(1, shown({3, 12, 20, 28}));
  for (const int threads : {2, 8}) {
    const auto motion = made(threads, shown({3, 12, 20, 28}));
    for (std::size_t i = 0; i < motion.size(); ++i)
      EXPECT_EQ(cv::norm(motion[i], reference[i], cv::NORM_INF), 0);
  }
  const auto backwards = made(2, shown({28, 20, 12, 3}));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(cv::norm(backwards[i], reference[3 - i], cv::NORM_INF), 0);
}

TEST(MotionSequence, IsTheSameOfFlowThatIsInMemory) {
  const FlowingClip clip{.size = {200, 160}, .frames = 40, .varying = 2};
  const FlowingStore store({clip});
  const Placement placement = placement_of(store.id(), {1, 0, true}, {40, 30});
  const PlayedPatches played = all_of(placement, shown({3, 12, 20, 39}, 1.5));
  // Part of the planes: what lies 8 samples and more beyond the patches is not read.
  const cv::Rect part(36, 5, 54, 50);
  const HeldFlow held{part, [&](std::uint32_t frame) {
                        const auto flow = clip.flow(static_cast<int>(frame));
                        return std::array<cv::Mat, 2>{flow[0](part), flow[1](part)};
                      }};
  std::vector<MotionSequence> sequences;
  for (const HeldFlow* flow : {static_cast<const HeldFlow*>(nullptr), &held}) {
    MotionSums sums(store.snapshot(), store.settings(), placement, {100, 70}, 4);
    sums.add(played, flow);
    sequences.push_back(std::move(sums).means());
  }
  for (int i = 0; i < 4; ++i) {
    EXPECT_GT(cv::norm(sequences[0].at(i), cv::NORM_INF), 5) << i;
    EXPECT_EQ(cv::norm(sequences[0].at(i), sequences[1].at(i), cv::NORM_INF), 0) << i;
  }
  const auto variance = [&](int k) {
    return sequences[static_cast<std::size_t>(k)].own_variance(4, {25, 17});
  };
  EXPECT_EQ(cv::norm(variance(0), variance(1), cv::NORM_INF), 0);
}

// It was 115 KB a frame at 1280 x 720.
TEST(MotionSequence, TakesNoMemoryForFramesThatShowAClipAgain) {
  const FlowingClip clip{.size = {200, 160}, .frames = 20, .varying = 2};
  const FlowingStore store({clip});
  const Placement placement = placement_of(store.id(), {}, {40, 30});
  const auto made = [&](int frames) {
    std::vector<ShownFrame> shown;
    for (int i = 0; i < frames; ++i) shown.push_back({.frame = static_cast<std::uint32_t>(i % 19)});
    const std::vector played{all_of(placement, shown)};
    return sequence_of(store.snapshot(), store.settings(), placement, played, {640, 480}, frames);
  };
  const MotionSequence few = made(19), more = made(5000), most = made(10000);
  EXPECT_EQ(most.bytes() - more.bytes(), 5000 * sizeof(std::uint32_t));
  EXPECT_LT(more.bytes(), std::size_t{70} << 20);
  for (const int i : {0, 18, 19, 4000, 37, 9999, 0})
    EXPECT_EQ(cv::norm(most.at(i), few.at(i % 19), cv::NORM_INF), 0) << i;
}

TEST(MotionSequence, RefusesAFlowThatDoesNotFitItsFrames) {
  const FlowingClip clip;
  const FlowingStore store({clip});
  vision::Settings settings = store.settings();
  settings.flow_step = 3;
  const Placement placement = placement_of(store.id(), {}, {10, 10});
  const std::vector played{all_of(placement, shown({0}))};
  EXPECT_THROW(sequence_of(store.snapshot(), settings, placement, played, {100, 70}, 1), Error);
}

}  // namespace
}  // namespace freshet::synth::animate
