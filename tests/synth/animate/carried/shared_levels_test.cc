#include "synth/animate/carried/shared_levels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace freshet::synth::animate {
namespace {

constexpr int kPieces = 9, kMoments = 40;
constexpr double kAny = 1;  // luma: more than any level varies

Placement pieces() {
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  for (int row = 0; row < kPieces; ++row)
    for (int column = 0; column < kPieces; ++column)
      placement.patches.push_back(
          {.piece = {24 * column, 24 * row}, .clip = {}, .variant = {}, .patch = {}, .speed = 1});
  return placement;
}

/// A patch's level in a frame: of the left half .1 strong, of the right half so much; each this much later than the
/// one before.
double level_of(int piece, int frame, double later, double right) {
  return (piece % kPieces > kPieces / 2 ? right : 0.1) *
         std::sin(2 * std::numbers::pi * frame / kMoments * 3 + later * piece);
}

SharedLevels settled(double reach, double later, double right) {
  SharedLevels levels(pieces(), kMoments, reach);
  for (int piece = 0; piece < kPieces * kPieces; ++piece)
    for (int frame = 0; frame < kMoments; ++frame)
      levels.set(static_cast<std::size_t>(piece), frame,
                 static_cast<float>(level_of(piece, frame, later, right)));
  levels.settle();
  return levels;
}

/// Over time, of the middle of a piece.
template <class Levels>
double unrest_of(const Levels& levels, int row, int column) {
  double sum = 0;
  for (int frame = 0; frame < kMoments; ++frame)
    sum += std::pow(levels(frame).template at<float>(24 * row + 24, 24 * column + 24), 2);
  return std::sqrt(sum / kMoments);
}
double unrest_of_all(const SharedLevels& levels, int row, int column) {
  return unrest_of([&](int frame) { return levels.at(frame); }, row, column);
}
double unrest_of_liveliest(const SharedLevels& levels, double most, int row, int column) {
  return unrest_of([&](int frame) { return levels.liveliest(frame, most); }, row, column);
}

TEST(SharedLevels, WhatNeighboursDoTogetherStays) {
  const SharedLevels together = settled(1, 0, 0.1);
  EXPECT_NEAR(unrest_of_all(together, 4, 4), 0.1 / std::numbers::sqrt2, 1e-4);
  EXPECT_NEAR(unrest_of_liveliest(together, kAny, 4, 4), 0.1 / std::numbers::sqrt2, 1e-4);
  EXPECT_LT(unrest_of_all(settled(3, 2.4, 0.1), 4, 4), 0.01);
}

TEST(SharedLevels, APatchByItselfStaysHere) {
  // Each out of step with its neighbours across, in step with those above and below.
  const SharedLevels levels = settled(3, 2 * std::numbers::pi / kPieces, 0.1);
  const double here = unrest_of([&](int frame) { return levels.here(frame); }, 4, 4);
  EXPECT_GT(here, 0.6 * 0.1 / std::numbers::sqrt2);
  EXPECT_GT(here, 3 * unrest_of_all(levels, 4, 4));
}

TEST(SharedLevels, TheLiveliestLeadThoseThatStand) {
  // A piece from the border of those that are lively.
  const SharedLevels levels = settled(1, 0, 0);
  EXPECT_LT(unrest_of_all(levels, 4, 6), 0.1 * 0.1);
  EXPECT_NEAR(unrest_of_liveliest(levels, kAny, 4, 6), 0.1 / std::numbers::sqrt2, 1e-3);
}

TEST(SharedLevels, NothingVariesByMoreThanIsAskedAndAllInProportion) {
  const SharedLevels levels = settled(1, 0, 0.05);
  EXPECT_NEAR(unrest_of_liveliest(levels, 0.02, 4, 2), 0.02, 1e-4);
  for (int frame = 0; frame < kMoments; ++frame) {
    const cv::Mat whole = levels.liveliest(frame, kAny), less = levels.liveliest(frame, 0.02);
    const double ratio = 0.02 / unrest_of_liveliest(levels, kAny, 4, 2);
    EXPECT_NEAR(less.at<float>(120, 72), ratio * whole.at<float>(120, 72), 1e-4) << frame;
  }
}

TEST(SharedLevels, TheLiveliestGiveBackWhatIsLostUpToTwice) {
  // The twin: weights, means and deviations piece by piece.
  const double reach = 0.7;
  for (const double later : {0.2, 0.5, 2.4}) {
    double wanted = 0, total = 0, found = 0;
    for (int frame = 0; frame < kMoments; ++frame) {
      double sum = 0;
      total = wanted = 0;
      for (int row = 0; row < kPieces; ++row)
        for (int column = 0; column < kPieces; ++column) {
          double variance = 0;
          for (int t = 0; t < kMoments; ++t)
            variance += std::pow(level_of(row * kPieces + column, t, later, 0.05), 2) / kMoments;
          const double weight =
              variance * std::exp(-(std::pow(row - 4, 2) + std::pow(column - 4, 2)) / (2 * reach * reach));
          sum += weight * level_of(row * kPieces + column, frame, later, 0.05);
          total += weight;
          wanted += weight * std::sqrt(variance);
        }
      found += std::pow(sum / total, 2) / kMoments;
    }
    const double shown = std::min(wanted / total, SharedLevels::kMostGain * std::sqrt(found));
    // At the middle of piece (4, 4), which lies between pixels.
    EXPECT_NEAR(unrest_of_liveliest(settled(reach, later, 0.05), kAny, 4, 4), shown, 0.1 * shown) << later;
  }
}

}  // namespace
}  // namespace freshet::synth::animate
