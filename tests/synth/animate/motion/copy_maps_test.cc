#include "synth/animate/motion/copy_maps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace freshet::synth::animate {
namespace {

constexpr int kStep = 4, kInterval = 8;
const cv::Size kSize(40, 30);
const cv::Mat kFluid(kSize, CV_32FC4, cv::Scalar(1, 0.5, 0, 0));  // all fluid, all of one look

/// A picture that ends at its sides.
CopyPlaces alone(const cv::Mat& places) { return {places, cv::Rect({}, places.size())}; }

/// A displacement that changes from frame to frame and is the same everywhere.
cv::Vec2f blown(int i) {
  return {2 + std::sin(0.7f * static_cast<float>(i)), std::cos(0.4f * static_cast<float>(i))};
}
cv::Mat everywhere(int i) {
  const cv::Vec2f v = blown(i);
  return cv::Mat(kSize, CV_32FC2, cv::Scalar(v[0], v[1]));
}

CopyMaps blown_copies(int loop_frames = 0, const cv::Mat& astray = {}) {
  return CopyMaps(
      everywhere, alone(kFluid), kStep,
      {.interval = kInterval, .loop_frames = loop_frames, .wander = 30, .astray = astray, .patch = 6});
}
const cv::Mat kAstray(kSize, CV_32F, cv::Scalar(10));

TEST(CopyMaps, SourcesAreTheSumOfTheStepsFromTheCopysOwnFrame) {
  CopyMaps maps = blown_copies();
  for (int i = 0; i < 5 * kInterval; ++i) {
    maps.prepare(i, 1);
    for (const CopyMap& copy : maps.at(i)) {
      // Which copy it is, its source in the middle tells: one of those that are alive.
      double nearest = 1e9;
      for (int j = -5; j < 10; ++j) {
        if (std::abs(i - j * kInterval) > 2.5 * kInterval) continue;
        cv::Vec2f expected(0, 0);
        const int own = maps.own_frame(j);
        for (int t = own; t < i; ++t) expected -= blown(t);
        for (int t = i; t < own; ++t) expected += blown(t);
        nearest = std::min(nearest, cv::norm(expected - copy.source.at<cv::Vec2f>(15, 20)));
      }
      EXPECT_LT(nearest, 1e-3) << i;
    }
  }
}

TEST(CopyMaps, WeightsSumToOneWhereCopiesGoWithThePlaceAndOneCopyShowsMost) {
  CopyMaps maps = blown_copies();
  double most = 0, least_in_all = 1;
  for (int i = 0; i < 5 * kInterval; ++i) {
    maps.prepare(i, 1);
    cv::Mat sum = cv::Mat::zeros(kSize, CV_32F), largest = sum.clone();
    for (const CopyMap& copy : maps.at(i)) {
      sum += copy.weight;
      largest = cv::max(largest, copy.weight);
    }
    double greatest = 0;
    cv::minMaxLoc(sum, nullptr, &greatest);
    EXPECT_LT(greatest, 1 + 1e-5) << i;
    EXPECT_NEAR(sum.at<float>(15, 30), 1, 1e-5) << i;
    least_in_all = std::min(least_in_all, cv::mean(sum)[0]);
    most += cv::mean(largest)[0] / (5 * kInterval);
  }
  EXPECT_GT(least_in_all, 0.95) << "what is guessed shows rather than nothing";
  EXPECT_GT(most, 0.75);  // weights of (1 + cos) / 3 have .57
}

TEST(CopyMaps, PlacesAreAstrayInTheCopysOwnFrameWhereTheyAreAskedToBe) {
  // Without motion sources are what they are in the own frame; on the left half nothing is to be astray.
  constexpr float kMost = 10;
  cv::Mat astray(kSize, CV_32F, cv::Scalar(kMost));
  astray.colRange(0, kSize.width / 2) = 0;
  CopyMaps maps([](int) { return cv::Mat(cv::Mat::zeros(kSize, CV_32FC2)); }, alone(kFluid), kStep,
                {.interval = kInterval, .wander = 30, .astray = astray, .patch = 3});
  std::set<float> found;
  for (int i = 0; i < 6 * kInterval; ++i) {
    maps.prepare(i, 1);
    for (const CopyMap& copy : maps.at(i)) {
      EXPECT_EQ(cv::norm(copy.source.colRange(0, kSize.width / 2), cv::NORM_INF), 0) << i;
      const cv::Mat goes = copy.source.colRange(kSize.width / 2, kSize.width);
      EXPECT_LT(cv::norm(goes, cv::NORM_INF), 1.9 * kMost) << i;
      found.insert(static_cast<float>(cv::norm(goes, cv::NORM_L2) /
                                      std::sqrt(2.0 * static_cast<double>(goes.total()))));
    }
  }
  EXPECT_EQ(*found.begin(), 0);  // the picture itself, with which a film begins
  EXPECT_GE(found.size(), 6U);   // the others are unlike each other,
  EXPECT_GT(*std::next(found.begin()), 0.2 * kMost);
}

TEST(CopyMaps, PlacesGoOverToAnotherCopyAtTimesOfTheirOwn) {
  // Without motion: which copy shows at a place, told by its size, as sources are all alike.
  CopyMaps maps([](int) { return cv::Mat(cv::Mat::zeros(kSize, CV_32FC2)); }, alone(kFluid), kStep,
                {.interval = kInterval, .wander = 30, .patch = 6});
  const auto changed = [&](int i) {
    maps.prepare(i, 2);
    const auto before = maps.at(i), after = maps.at(i + 1);
    double sum = 0;
    for (const CopyMap& copy : before) {
      double smallest = 1;
      for (const CopyMap& other : after)
        smallest = std::min(smallest, cv::norm(copy.weight, other.weight, cv::NORM_L1));
      sum += smallest / kSize.area();
    }
    return sum;
  };
  double least = 1e9, greatest = 0;
  for (int i = 2 * kInterval; i < 6 * kInterval; ++i) {
    least = std::min(least, changed(i));
    greatest = std::max(greatest, changed(i));
  }
  EXPECT_GT(least, 0.3 * greatest);  // the picture never changes over as a whole
}

TEST(CopyMaps, ACopyThatWouldBringWhatIsNotFluidLeavesThePlaceToOthers) {
  // Fluid goes right at 2 samples a frame; copies from the past would come from beyond the left edge there, where the
  // picture, mirrored, is a guess: from four samples on it hardly counts.
  const auto right = [](int) { return cv::Mat(kSize, CV_32FC2, cv::Scalar(2 * kStep, 0)); };
  CopyMaps maps(right, alone(kFluid), kStep, {.interval = kInterval, .wander = 30, .patch = 6});
  double within = 0, all = 0;
  for (int i = 2 * kInterval; i < 8 * kInterval; ++i) {
    maps.prepare(i, 1);
    for (const CopyMap& copy : maps.at(i)) {
      const float from = 4 * kStep + copy.source.at<cv::Vec2f>(15, 4)[0],
                  weight = copy.weight.at<float>(15, 4);
      all += weight;
      if (from >= -4 * kStep && from < (kSize.width + 4) * kStep) within += weight;
    }
  }
  EXPECT_GT(within, 0.85 * all);  // some half of them without a preference
}

TEST(CopyMaps, WhereNothingGoesWithAPlaceTheLongExposureIsLeftRoom) {
  // Still fluid, and a place that no copy looks like: a copy of it is nowhere but where it stands.
  cv::Mat places = kFluid.clone();
  places(cv::Rect(17, 0, 3, kSize.height)).setTo(cv::Scalar(1, 0.02, 0.4, 0));
  const auto fast = [](int) { return cv::Mat(kSize, CV_32FC2, cv::Scalar(8 * kStep, 0)); };
  CopyMaps maps(fast, alone(places), kStep, {.interval = kInterval, .wander = 60, .patch = 6});
  maps.prepare(0, 30);
  const auto shown = [&](int i) {
    double sum = 0;
    for (const CopyMap& copy : maps.at(i)) sum += copy.weight.at<float>(15, 19);
    return sum;
  };
  EXPECT_NEAR(shown(0), 1, 1e-5) << "the still";
  double mean = 0;
  for (int i = kInterval; i < 30; ++i) mean += shown(i) / (30 - kInterval);
  EXPECT_LT(mean, 0.3);
}

TEST(CopyMaps, ACopyThatIsDrawnOutLeavesThePlaceToOthers) {
  // From the left fluid comes at 1 px a frame, and speeds up to nine times that on its way to the right.
  const auto faster = [](int) {
    cv::Mat out(kSize, CV_32FC2);
    for (int y = 0; y < out.rows; ++y)
      for (int x = 0; x < out.cols; ++x)
        out.at<cv::Vec2f>(y, x) = {1 + 8 * static_cast<float>(x) / static_cast<float>(kSize.width), 0};
    return out;
  };
  CopyMaps maps(faster, alone(kFluid), kStep, {.interval = kInterval, .wander = 30, .patch = 6});
  double drawn_out = 0, all = 0, time_alone = 0;
  for (int i = 2 * kInterval; i < 8 * kInterval; ++i) {
    maps.prepare(i, 1);
    const std::vector<CopyMap> copies = maps.at(i);
    for (const CopyMap& copy : copies) {
      const float across = copy.source.at<cv::Vec2f>(15, 21)[0] - copy.source.at<cv::Vec2f>(15, 19)[0];
      const bool out = 1 + across / (2 * kStep) < 0.6f;
      const float weight = copy.weight.at<float>(15, 20);
      all += weight;
      if (out) drawn_out += weight, time_alone += 1.0 / static_cast<double>(copies.size());
    }
  }
  ASSERT_GT(time_alone, 5) << "there are such copies";
  EXPECT_LT(drawn_out, 0.2 * all);
}

TEST(CopyMaps, ACopyThatLooksUnlikeThePlaceLeavesItToOthers) {
  // A fall of 15 samples above a dark pool, going down at 1 sample a frame.
  cv::Mat places = kFluid.clone();
  places.rowRange(15, kSize.height).setTo(cv::Scalar(1, 0.1, 0, 0));
  const auto down = [](int) { return cv::Mat(kSize, CV_32FC2, cv::Scalar(0, kStep)); };
  const auto climbed = [&](const cv::Mat& looks) {
    CopyMaps maps(down, alone(looks), kStep, {.interval = kInterval, .wander = 30, .patch = 6});
    double sum = 0;
    for (int i = 2 * kInterval; i < 8 * kInterval; ++i) {
      maps.prepare(i, 1);
      for (const CopyMap& copy : maps.at(i))
        if (10 * kStep + copy.source.at<cv::Vec2f>(10, 20)[1] >= 15 * kStep)
          sum += copy.weight.at<float>(10, 20) / (6 * kInterval);
    }
    return sum;
  };
  EXPECT_GT(climbed(kFluid), 0.2);
  EXPECT_LT(climbed(places), 0.75 * climbed(kFluid));
}

TEST(CopyMaps, WhatLiesBeyondASideIsBroughtAsItLooks) {
  // All goes right by a sample a frame; ten samples are known beyond the left side.
  const auto right = [](int) { return cv::Mat(kSize, CV_32FC2, cv::Scalar(kStep, 0)); };
  const auto brought = [&](double luma) {
    CopyPlaces places{cv::Mat(kSize.height, kSize.width + 10, CV_32FC4, cv::Scalar(1, 0.5, 0, 0)),
                      cv::Rect({10, 0}, kSize)};
    places.all.colRange(0, 10).setTo(cv::Scalar(1, luma, 0, 0));
    CopyMaps maps(right, places, kStep, {.interval = kInterval, .wander = 30, .patch = 6});
    double sum = 0;
    for (int i = 2 * kInterval; i < 8 * kInterval; ++i) {
      maps.prepare(i, 1);
      for (const CopyMap& copy : maps.at(i))
        if (const float from = 3 + copy.source.at<cv::Vec2f>(15, 3)[0] / kStep; from < -1 && from > -9)
          sum += copy.weight.at<float>(15, 3) / (6 * kInterval);
    }
    return sum;
  };
  EXPECT_GT(brought(0.5), 0.02);
  EXPECT_LT(brought(0.05), 0.5 * brought(0.5));
}

/// Copies of a texture: all goes right, or the lower half left; no edges.
CopyStarts starts(bool parted = false) {
  CopyStarts out{cv::Mat(kSize, CV_32FC2, cv::Scalar(1, 0)), cv::Mat::zeros(kSize, CV_32F), 8};
  if (parted) out.direction.rowRange(15, kSize.height).setTo(cv::Scalar(-1, 0));
  return out;
}
const auto standing_water = [](int) { return cv::Mat(cv::Mat::zeros(kSize, CV_32FC2)); };

TEST(CopyMaps, TowardsAHorizonCopiesOfATextureKeepToTheirSize) {
  CopyStarts plain = starts(), plane = starts();
  plane.nearness.create(kSize, CV_32F);
  for (int y = 0; y < kSize.height; ++y) plane.nearness.row(y).setTo(static_cast<float>(y + 1));
  const auto unlike = [&](const CopyStarts& from) {
    CopyMaps maps(standing_water, alone(kFluid), kStep, {.interval = kInterval, .patch = 6}, from);
    double sum = 0, mass = 0;
    for (int i = kInterval; i < 8 * kInterval; i += kInterval / 2) {
      maps.prepare(i, 1);
      for (const CopyMap& copy : maps.at(i))
        for (int y = 0; y < kSize.height; ++y) {
          const float weight = copy.weight.at<float>(y, 20),
                      came = static_cast<float>(y) + copy.source.at<cv::Vec2f>(y, 20)[1] / kStep;
          if (came < 0 || came >= static_cast<float>(kSize.height)) continue;
          sum += weight * std::abs(std::log((came + 1) / static_cast<float>(y + 1)));
          mass += weight;
        }
    }
    return sum / mass;
  };
  EXPECT_LT(unlike(plane), 0.6 * unlike(plain));
}

TEST(CopyMaps, CopiesOfATextureBeginDisplacedEachByAnother) {
  CopyMaps maps(standing_water, alone(kFluid), kStep, {.interval = kInterval, .patch = 6}, starts());
  std::set<std::pair<float, float>> seen;
  for (int i = 0; i < 8 * kInterval; i += kInterval) {
    maps.prepare(i, 1);
    for (const CopyMap& copy : maps.at(i)) {
      const cv::Vec2f away = copy.source.at<cv::Vec2f>(15, 20);
      seen.insert({away[0], away[1]});
      if (cv::norm(away) > 0) {
        EXPECT_GE(cv::norm(away), 0.5 * 8 * kStep - kStep) << i;
      }
    }
  }
  EXPECT_GE(seen.size(), 8U);
}

TEST(CopyMaps, ATextureBeginsAsTheStillAndCoversAllPlaces) {
  CopyMaps maps(everywhere, alone(kFluid), kStep, {.interval = kInterval, .patch = 6}, starts());
  maps.prepare(0, 1);
  const std::vector<CopyMap> first = maps.at(0);
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(cv::norm(first[0].source, cv::NORM_INF), 0);
  for (int i = 1; i < 40; ++i) {
    maps.prepare(i, 1);
    cv::Mat sum = cv::Mat::zeros(kSize, CV_32F);
    for (const CopyMap& copy : maps.at(i)) sum += copy.weight;
    EXPECT_LT(cv::norm(sum, cv::Mat(kSize, CV_32F, cv::Scalar(1)), cv::NORM_INF), 1e-4) << i;
  }
}

TEST(CopyMaps, ATextureComesFromWhereTheFlowGoesTheSameWayAndBringsNoEdge) {
  CopyStarts parted = starts(true);
  parted.edges.colRange(10, 14).setTo(1);
  CopyMaps maps(standing_water, alone(kFluid), kStep, {.interval = kInterval, .patch = 6}, parted);
  double other_way = 0, edge = 0, all = 0;
  for (int i = 3 * kInterval; i < 12 * kInterval; i += 3) {
    maps.prepare(i, 1);
    for (const CopyMap& copy : maps.at(i))
      for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width; ++x) {
          const cv::Vec2f away = copy.source.at<cv::Vec2f>(y, x) / kStep;
          const auto from_x = static_cast<float>(x) + away[0], from_y = static_cast<float>(y) + away[1];
          const float weight = copy.weight.at<float>(y, x);
          all += weight;
          if ((y < 15) != (from_y < 15)) other_way += weight;
          if (from_x >= 10 && from_x <= 13) edge += weight;
        }
  }
  EXPECT_LT(other_way, 0.1 * all);
  EXPECT_LT(edge, 0.02 * all);  // .1 of the picture
}

TEST(CopyMaps, OfALoopTheDisplacementsComeAgainToo) {
  const auto right = [](int) { return cv::Mat(kSize, CV_32FC2, cv::Scalar(2, 1)); };
  CopyMaps maps(right, alone(kFluid), kStep,
                {.interval = kInterval, .loop_frames = 5 * kInterval, .patch = 6}, starts());
  maps.prepare(0, 5 * kInterval + 3);
  for (int i = 0; i < 3; ++i) {
    const auto a = maps.at(i), b = maps.at(i + 5 * kInterval);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
      EXPECT_LT(cv::norm(a[k].weight, b[k].weight, cv::NORM_INF), 1e-4);
  }
}

TEST(CopyMaps, OfALoopPlacesAreAstrayAlikeAgainAndTheStillIsNotAtAll) {
  constexpr int kLoop = 5 * kInterval;
  CopyMaps maps = blown_copies(kLoop, kAstray);
  maps.prepare(kLoop, kLoop + 1);
  // By how much a copy is astray in its own frame.
  const auto astray = [&](int copy) {
    const int own = maps.own_frame(copy);
    double least = 1e9;
    for (const CopyMap& one : maps.at(own)) least = std::min(least, cv::norm(one.source, cv::NORM_INF));
    return least;
  };
  EXPECT_EQ(astray(5), 0) << "the still, once more";
  EXPECT_GT(astray(6), 2);
}

TEST(CopyMaps, AreTheSameWhateverIsPreparedAtOnce) {
  CopyMaps one = blown_copies(0, kAstray), many = blown_copies(0, kAstray);
  many.prepare(0, 40);
  for (int i = 0; i < 40; ++i) {
    one.prepare(i, 1);
    const auto a = one.at(i), b = many.at(i);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(cv::norm(a[k].weight, b[k].weight, cv::NORM_INF), 0);
      EXPECT_EQ(cv::norm(a[k].source, b[k].source, cv::NORM_INF), 0);
    }
  }
}

TEST(CopyMaps, TheStillIsLeftWithoutAJumpAndComeBackToInALoop) {
  CopyMaps maps = blown_copies(), loop = blown_copies(5 * kInterval);
  EXPECT_EQ(maps.still(0), 1);
  EXPECT_EQ(maps.still(kInterval), 0);
  EXPECT_EQ(maps.still(5 * kInterval), 0);
  EXPECT_EQ(loop.still(5 * kInterval), 1);
  for (int i = 1; i <= kInterval; ++i) EXPECT_LT(maps.still(i - 1) - maps.still(i), 0.2);
}

TEST(CopyMaps, OwnFramesLieAwayFromLivesSoThatNothingComesAgain) {
  CopyMaps maps = blown_copies();
  EXPECT_EQ(maps.own_frame(0), 0);
  std::set<int> away;
  for (int j = -5; j < 5; ++j) {
    if (j == 0) continue;
    away.insert(maps.own_frame(j) - j * kInterval);

    EXPECT_GE(std::abs(maps.own_frame(j) - j * kInterval), 3) << j;
    EXPECT_LE(std::abs(maps.own_frame(j) - j * kInterval), 15) << j;
  }
  EXPECT_GE(away.size(), 6U);
}

TEST(CopyMaps, WhatGoesTheOtherWayShowsWhereItIsToAndBothTogetherAreThePicture) {
  const auto going = [](float down) {
    return [down](int) { return cv::Mat(kSize, CV_32FC2, cv::Scalar(0, down)); };
  };
  const CopyOptions options{.interval = kInterval, .wander = 30, .patch = 6};
  cv::Mat share = cv::Mat::zeros(kSize, CV_32F);
  share.colRange(0, 10).setTo(1);
  share.colRange(10, 20).setTo(0.25);
  CopyMaps up(going(-2), alone(kFluid), kStep, options), down(going(3), alone(kFluid), kStep, options);
  CopyMaps both(going(-2), alone(kFluid), kStep, options, std::nullopt, OtherWay{going(3), share});
  for (int i = 0; i < 4 * kInterval; ++i) {
    for (CopyMaps* maps : {&up, &down, &both}) maps->prepare(i, 1);
    // Where the copies that show have the middle row's place x from, on the average.
    const auto source = [i](const CopyMaps& maps, int x) {
      double from = 0, sum = 0;
      for (const CopyMap& copy : maps.at(i)) {
        from += copy.weight.at<float>(15, x) * copy.source.at<cv::Vec2f>(15, x)[1];
        sum += copy.weight.at<float>(15, x);
      }
      EXPECT_NEAR(sum, 1, 1e-4) << i;
      return from;
    };
    EXPECT_NEAR(source(both, 5), source(down, 5), 1e-3) << i;
    EXPECT_NEAR(source(both, 15), 0.75 * source(up, 15) + 0.25 * source(down, 15), 1e-3) << i;
    EXPECT_NEAR(source(both, 30), source(up, 30), 1e-3) << i;
  }
}

}  // namespace
}  // namespace freshet::synth::animate
