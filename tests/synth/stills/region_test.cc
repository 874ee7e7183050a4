#include "synth/stills/region.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "freshet/error.h"
#include "synth/stills/region_proposal.h"
#include "synth/stills/region_split.h"
#include "tests/harness/fault.h"
#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

constexpr int kStills = 14;
const cv::Size kSize(480, 200);

/// Three discs that swing each by its own phases; the first and the second by the same where `together`.
std::vector<cv::Mat> three_pendulums(bool together) {
  std::vector<cv::Mat> stills;
  const cv::Mat ground = made_ground(kSize);
  cv::RNG random(7);
  for (int i = 0; i < kStills; ++i) {
    stills.push_back(ground.clone());
    const double a = random.uniform(0., 1.), b = random.uniform(0., 1.), c = random.uniform(0., 1.);
    draw_pendulum(stills.back(), {20, 70, 110, 60}, a);
    draw_pendulum(stills.back(), {180, 70, 110, 60}, together ? a : b);
    draw_pendulum(stills.back(), {340, 70, 110, 60}, c);
  }
  return stills;
}

TEST(RegionProposal, FindsThingsThatMoveByThemselves) {
  const RegionProposal proposal = propose_regions(three_pendulums(false));
  ASSERT_GE(proposal.regions.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const cv::Rect box = cv::boundingRect(proposal.regions[i].mask);
    EXPECT_EQ(proposal.regions[i].kind, RegionKind::kIndependent);
    EXPECT_NEAR(box.x + box.width / 2, 75 + 160 * i, 15);
  }
  EXPECT_TRUE(proposal.regions.size() == 3u || proposal.regions[3].kind != RegionKind::kIndependent);
}

TEST(RegionProposal, WhatVariesTogetherIsOneRegion) {
  const RegionProposal proposal = propose_regions(three_pendulums(true));
  const auto moving =
      std::count_if(proposal.regions.begin(), proposal.regions.end(),
                    [](const Region& region) { return region.kind == RegionKind::kIndependent; });
  EXPECT_EQ(moving, 2);
}

/// Columns of discs side by side, all by their own phases. gap   px between where they swing.
std::vector<cv::Mat> crowd_of(int columns, int gap) {
  std::vector<cv::Mat> stills;
  const cv::Mat ground = made_ground(kSize);
  cv::RNG random(9);
  for (int i = 0; i < kStills; ++i) {
    stills.push_back(ground.clone());
    for (int k = 0; k < columns; ++k)
      draw_pendulum(stills.back(), {20 + (84 + gap) * k, 70, 84, 60}, random.uniform(0., 1.));
  }
  return stills;
}

TEST(RegionProposal, ACrowdOfPiecesThatTouchIsOneSurface) {
  const auto independent = [](const RegionProposal& proposal) {
    return std::count_if(proposal.regions.begin(), proposal.regions.end(),
                         [](const Region& region) { return region.kind == RegionKind::kIndependent; });
  };
  EXPECT_EQ(independent(propose_regions(crowd_of(2, 2))), 2);
  EXPECT_EQ(independent(propose_regions(crowd_of(3, 2))), 1);
  EXPECT_EQ(independent(propose_regions(crowd_of(5, 2))), 1);
  // .04 of the longer side are 19 px.
  EXPECT_EQ(independent(propose_regions(crowd_of(3, 12))), 1);
  EXPECT_EQ(independent(propose_regions(crowd_of(3, 30))), 3);
}

TEST(RegionProposal, SaysWhenNothingMoves) {
  const cv::Mat ground = made_ground(kSize);
  const std::string fault = fault_of([&] { propose_regions({ground, ground.clone(), ground.clone()}); });
  EXPECT_NE(fault.find("nothing moves"), std::string::npos);
}

TEST(RegionWeights, ASlowRegionDoesNotReachIntoWhatMoves) {
  cv::Mat moves(60, 80, CV_8U, cv::Scalar(0)), slow = moves.clone();
  moves(cv::Rect(0, 0, 40, 60)).setTo(255);
  slow(cv::Rect(40, 0, 40, 60)).setTo(255);
  const std::vector<cv::Mat> weights =
      region_weights({{.name = "1", .mask = moves, .parent = {}},
                      {.name = "slow", .kind = RegionKind::kSlow, .mask = slow, .parent = {}}},
                     3, 12);
  EXPECT_EQ(cv::norm(weights[1](cv::Rect(0, 0, 40, 60)), cv::NORM_INF), 0);
  EXPECT_EQ(weights[0].at<float>(30, 39), 1);
  EXPECT_NEAR(weights[0].at<float>(30, 50) + weights[1].at<float>(30, 50), 1, 1e-6) << "no gap between them";
}

TEST(RegionWeights, AreWholeInsideAndShareTheEdge) {
  Region left{.name = "1", .mask = cv::Mat(60, 100, CV_8U, cv::Scalar(0)), .parent = {}};
  Region right = left;
  right.mask = left.mask.clone();
  left.mask(cv::Rect(0, 0, 50, 60)).setTo(255);
  right.mask(cv::Rect(50, 0, 30, 60)).setTo(255);
  const std::vector<cv::Mat> weights = region_weights({left, right}, 2, 8);
  EXPECT_EQ(weights[0].at<float>(30, 10), 1);
  EXPECT_EQ(weights[1].at<float>(30, 70), 1);
  EXPECT_EQ(weights[1].at<float>(30, 99), 0);
  for (int x = 0; x < 100; ++x) {
    const float sum = weights[0].at<float>(30, x) + weights[1].at<float>(30, x);
    EXPECT_LE(sum, 1.0001f);
    if (x < 80) {
      EXPECT_NEAR(sum, 1, 1e-4) << "no third picture shows between two regions, at " << x;
    }
    if (x > 0) {
      EXPECT_LT(std::abs(weights[0].at<float>(30, x) - weights[0].at<float>(30, x - 1)), .2);
    }
  }
}

TEST(RegionSplit, CutsAlongTheCalmLines) {
  // Four textured fields with smooth lanes between them.
  std::vector<cv::Mat> stills;
  for (int i = 0; i < 4; ++i) {
    cv::Mat still(200, 320, CV_8UC3, cv::Scalar(90, 80, 70));
    cv::RNG random(static_cast<std::uint64_t>(i) + 1);
    for (const cv::Rect& field : {cv::Rect(0, 0, 145, 85), cv::Rect(175, 0, 145, 85),
                                  cv::Rect(0, 115, 145, 85), cv::Rect(175, 115, 145, 85)}) {
      cv::Mat noise(field.size(), CV_8UC3);
      random.fill(noise, cv::RNG::UNIFORM, 0, 255);
      noise.copyTo(still(field));
    }
    stills.push_back(still);
  }
  const Region whole{.name = "lake", .mask = cv::Mat(200, 320, CV_8U, cv::Scalar(255)), .parent = {}};
  const std::vector<Region> parts = split_region(whole, stills, {.parts = 4});
  ASSERT_GE(parts.size(), 3u);
  cv::Mat sum(200, 320, CV_8U, cv::Scalar(0));
  for (const Region& part : parts) {
    EXPECT_EQ(part.parent, "lake");
    sum += part.mask / 255;
    EXPECT_GT(cv::countNonZero(part.mask), .05 * 200 * 320);
  }
  EXPECT_LT(cv::countNonZero(sum != 1), .02 * 200 * 320) << "every place belongs to one part";
  // A field's middle and its corner belong together.
  for (const Region& part : parts)
    EXPECT_EQ(part.mask.at<std::uint8_t>(40, 70), part.mask.at<std::uint8_t>(10, 10));
}

double incompatibility(const std::vector<std::vector<double>>& borders, const std::vector<int>& order) {
  double cost = 0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    double sum = 0, most = 0;
    for (std::size_t before = 0; before < k; ++before) {
      sum += borders[order[k]][order[before]];
      most = std::max(most, borders[order[k]][order[before]]);
    }
    cost += sum - most + (most == 0 ? 1e6 : 0);
  }
  return cost;
}

TEST(ProcessingOrder, NoOtherIsBetter) {
  cv::RNG random(3);
  for (int trial = 0; trial < 5; ++trial) {
    std::vector<std::vector<double>> borders(5, std::vector<double>(5, 0));
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < i; ++j)
        borders[i][j] = borders[j][i] = random.uniform(0., 1.) < .5 ? 0 : random.uniform(1., 9.);
    const ProcessingOrder best = best_processing_order(borders);
    EXPECT_NEAR(best.incompatibility, incompatibility(borders, best.order), 1e-9);
    for (int draw = 0; draw < 200; ++draw) {
      std::vector<int> order{0, 1, 2, 3, 4};
      for (int i = 4; i > 0; --i) std::swap(order[i], order[random.uniform(0, i + 1)]);
      EXPECT_GE(incompatibility(borders, order), best.incompatibility - 1e-9);
    }
  }
}

}  // namespace
}  // namespace freshet::synth::stills
