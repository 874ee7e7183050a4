#include "synth/animate/clips/clip_layer.h"

#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/imgproc.hpp>

#include "tests/synth/animate/flowing_clip.h"

namespace freshet::synth::animate {
namespace {

constexpr int kOutputs = 12;

/// Patches of all kinds, which together touch all of the clip.
Placement some_placement(store::ClipId clip, double speed = 1, double other_speed = 1) {
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  const auto add = [&](cv::Point piece, vision::Variant variant, cv::Point patch, double at) {
    placement.patches.push_back(
        {.piece = piece, .clip = clip, .variant = variant, .patch = patch, .speed = at});
  };
  add({0, 0}, {}, {0, 0}, speed);
  add({24, 0}, {}, {102, 62}, other_speed);
  add({48, 0}, {1, 0, true}, {102, 62}, speed);  // mirrored: the lower left of the clip
  add({0, 24}, {0.5f, 0, false}, {20, 5}, other_speed);
  add({24, 24}, {1, 22.5f, false}, {60, 50}, speed);
  add({48, 24}, {0.5f, 22.5f, true}, {12, 10}, speed);
  return placement;
}

std::vector<std::size_t> all_patches(const Placement& placement) {
  std::vector<std::size_t> all(placement.patches.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}
std::vector<int> all_outputs() {
  std::vector<int> all(kOutputs);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// Luma of the whole clip at a moment.
cv::Mat luma_at(const FlowingStore& store, const FlowingClip& clip, double moment) {
  const cv::Rect whole({}, clip.size);
  ClipLuma luma(store.snapshot(), store.id(), ClipLuma::Size::kWhole, std::vector{whole}, clip.flow_step);
  const auto frame = static_cast<std::uint32_t>(moment);
  if (moment > frame)
    luma.load(std::vector{frame, frame + 1}, std::vector{frame});
  else
    luma.load(std::vector{frame});
  ClipLuma::Scratch scratch;
  cv::Mat out(clip.size, CV_32F);
  std::vector<float> part(ClipLuma::kCellWidth * ClipLuma::kCellHeight);
  for (int y = 0; y < clip.size.height; y += ClipLuma::kCellHeight)
    for (int x = 0; x < clip.size.width; x += ClipLuma::kCellWidth) {
      const cv::Rect cell = cv::Rect(x, y, ClipLuma::kCellWidth, ClipLuma::kCellHeight) & whole;
      luma.at(moment, cell, part.data(), scratch);
      cv::Mat(cell.size(), CV_32F, part.data()).copyTo(out(cell));
    }
  return out;
}

/// The layer's work done frame by frame and patch by patch, on whole frames.
std::vector<cv::Mat> obvious_fields(const FlowingStore& store, const FlowingClip& clip,
                                    const Placement& placement, const ClipLayer& layer) {
  Blender blender(placement, kOutputs, {});
  for (const ClipLayer::Played& group : layer.played()) {
    cv::Mat average = cv::Mat::zeros(clip.size, CV_32F);
    double total = 0;
    for (const playing::Moment& moment : group.moments)
      for (int k = 0; k < moment.count(); ++k) {
        // Of a moment between two frames the average has both, by their distance.
        const double at = moment.at[k], fraction = at - std::floor(at), weight = moment.weight[k];
        average += weight * (1 - fraction) * luma_at(store, clip, std::floor(at));
        if (fraction > 0) average += weight * fraction * luma_at(store, clip, std::floor(at) + 1);
        total += weight;
      }
    average /= total;
    for (int i = 0; i < kOutputs; ++i) {
      cv::Mat difference = cv::Mat::zeros(clip.size, CV_32F);
      const playing::Moment& moment = group.moments[i];
      for (int k = 0; k < moment.count(); ++k)
        difference += moment.weight[k] * (luma_at(store, clip, moment.at[k]) - average);
      for (const std::size_t p : group.patches) {
        const PlacedPatch& placed = placement.patches[p];
        cv::Mat reduced, window;
        const cv::Size size = sampling::reduced_to_scale(clip.size, placed.variant.scale);
        if (size == clip.size)
          reduced = difference;
        else
          cv::resize(difference, reduced, size, 0, 0, cv::INTER_AREA);
        sampling::PatchWindow(clip.size, placed.variant, placed.patch, placement.side).cut(reduced, window);
        blender.add(i, p, window);
      }
    }
  }
  std::vector<cv::Mat> fields;
  for (int i = 0; i < kOutputs; ++i) fields.push_back(blender.take(i));
  return fields;
}

std::vector<cv::Mat> fields_of(ClipLayer& layer, const Placement& placement, std::span<const int> kept) {
  layer.measure(kept);
  Blender blender(placement, kOutputs, {});
  layer.add(all_outputs(), blender);
  std::vector<cv::Mat> fields;
  for (int i = 0; i < kOutputs; ++i) fields.push_back(blender.take(i));
  return fields;
}

ClipLayer layer_of(const FlowingStore& store, const FlowingClip& clip, const Placement& placement,
                   Resampling resampling) {
  return ClipLayer(store.snapshot(), store.id(), clip.flow_step, placement, all_patches(placement),
                   {.frames = kOutputs}, resampling);
}

void expect_obvious(const Placement& placement, const FlowingStore& store, const FlowingClip& clip,
                    Resampling resampling) {
  ClipLayer layer = layer_of(store, clip, placement, resampling);
  const auto expected = obvious_fields(store, clip, placement, layer);
  const auto fields = fields_of(layer, placement, all_outputs());
  for (int i = 0; i < kOutputs; ++i) {
    EXPECT_GT(cv::norm(expected[i], cv::NORM_INF), 0.05) << i;
    EXPECT_LT(cv::norm(expected[i], fields[i], cv::NORM_INF), 2e-5) << i;
  }
}

TEST(ClipLayer, GivesTheDifferencesToTheAverageOfWhatIsShown) {
  const FlowingClip clip;
  const FlowingStore store({clip});
  expect_obvious(some_placement(store.id()), store, clip, Resampling::kNearest);
}

TEST(ClipLayer, PatchesOfDifferentSpeedsHaveTimelinesAndAveragesOfTheirOwn) {
  const FlowingClip clip;
  const FlowingStore store({clip});
  const Placement placement = some_placement(store.id(), 1.5, 0.5);
  expect_obvious(placement, store, clip, Resampling::kNearest);
  const ClipLayer layer = layer_of(store, clip, placement, Resampling::kNearest);
  const auto played = layer.played();
  ASSERT_EQ(played.size(), 2u);
  EXPECT_EQ(played[0].patches, (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(played[1].patches, (std::vector<std::size_t>{0, 2, 4, 5}));
  EXPECT_GT(played[1].moments.back().at[0], 2 * played[0].moments.back().at[0]);
}

TEST(ClipLayer, ShowsMomentsBetweenFramesAlongTheFlow) {
  const FlowingClip clip{.steady = {1, 0.5f}, .varying = 1.5f};
  const FlowingStore store({clip});
  expect_obvious(some_placement(store.id(), 0.7, 0.7), store, clip, Resampling::kFlow);
}

TEST(ClipLayer, IsTheSameHoweverMuchIsKeptInMemoryAndForAnyNumberOfThreads) {
  const FlowingClip clip{.frames = 75};
  const FlowingStore store({clip});
  // Fast: the frames that are shown lie in several slabs.
  const Placement placement = some_placement(store.id(), 6, 2.3);
  std::vector<cv::Mat> reference;
  for (const int threads : {1, 2, 8})
    for (const std::vector<int>& kept : {all_outputs(), std::vector<int>{}, std::vector<int>{0, 5, 11}}) {
      const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                              static_cast<std::size_t>(threads));
      ClipLayer layer = layer_of(store, clip, placement, Resampling::kFlow);
      const auto fields = fields_of(layer, placement, kept);
      if (reference.empty()) reference = fields;
      for (int i = 0; i < kOutputs; ++i) EXPECT_EQ(cv::norm(fields[i], reference[i], cv::NORM_INF), 0);
    }
}

TEST(ClipLayer, KnowsTheLevelsOfTheDifferences) {
  const FlowingClip clip{.size = {152, 112}, .frames = 75, .steady = {1, 0.5f}, .varying = 1.5f};
  const FlowingStore store({clip});
  const Placement placement = some_placement(store.id(), 6, 2.3), half = halved(placement);
  // A row for each output. The twin: means of whole differences, in the middles of their pieces.
  cv::Mat differences(kOutputs, static_cast<int>(placement.patches.size()), CV_32F);
  ClipLayer whole = layer_of(store, clip, placement, Resampling::kFlow);
  whole.measure(all_outputs());
  Blender blender(placement, kOutputs, {.low_band_reach = 0.2});
  whole.add(all_outputs(), blender);
  for (int i = 0; i < kOutputs; ++i) {
    const cv::Mat level = blender.take_level(i);
    for (int p = 0; p < differences.cols; ++p)
      differences.at<float>(i, p) = static_cast<float>(
          cv::mean(level(cv::Rect(placement.patches[p].piece + cv::Point(23, 23), cv::Size(2, 2))))[0]);
  }
  const auto levels_of = [&](const std::vector<int>& kept) {
    ClipLayer layer(store.snapshot(), store.id(), clip.flow_step, half, all_patches(half),
                    {.frames = kOutputs}, Resampling::kFlow, ClipDetail::kInnovation);
    layer.measure(kept);
    cv::Mat levels(differences.size(), CV_32F);
    layer.each_level([&](std::size_t patch, int output, float level) {
      levels.at<float>(output, static_cast<int>(patch)) = level;
    });
    return levels;
  };
  EXPECT_GT(cv::norm(differences, cv::NORM_INF), 0.02);
  // Of means of two by two, and no flow between frames.
  EXPECT_LT(cv::norm(differences, levels_of(all_outputs())), 0.1 * cv::norm(differences));
  for (const std::vector<int>& kept : {std::vector<int>{}, std::vector<int>{0, 5, 11}})
    EXPECT_EQ(cv::norm(levels_of(kept), levels_of(all_outputs()), cv::NORM_INF), 0);
}

TEST(ClipLayer, EstimatesHowMuchItChangesFromOutputToOutput) {
  const FlowingClip clip;
  const FlowingStore store({clip});
  const Placement placement = some_placement(store.id());
  ClipLayer layer = layer_of(store, clip, placement, Resampling::kNearest);
  std::vector<double> change(kOutputs, 0.0);
  layer.measure(all_outputs(), &change);
  for (int i = 0; i + 1 < kOutputs; ++i) {
    cv::Mat difference;
    cv::absdiff(luma_at(store, clip, i), luma_at(store, clip, i + 1), difference);
    const double expected = cv::mean(difference)[0] * static_cast<double>(placement.patches.size());
    EXPECT_NEAR(change[i], expected, 1e-4 * expected) << i;
  }
}

}  // namespace
}  // namespace freshet::synth::animate
