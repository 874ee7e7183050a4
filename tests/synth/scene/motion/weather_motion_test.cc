// What moves in a wind that changes: trees, water, boats and clouds, from calm to storm and round a loop.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "synth/scene/motion/boat_ride.h"
#include "synth/scene/motion/cloud_drift.h"
#include "synth/scene/motion/tree_sway.h"
#include "synth/scene/motion/water_surface.h"

namespace freshet::synth::scene {
namespace {

const Cycle kLongFilm{.frames = 1500, .fps = 25};
const cv::Size kPicture(200, 240);

Wind rising(double direction = 0) {
  return {.speed_m_per_s = 2,
          .direction_deg = direction,
          .gustiness = 0.3,
          .at = {{.time_s = 22, .speed_m_per_s = 2},
                 {.time_s = 30, .speed_m_per_s = 12},
                 {.time_s = 52, .speed_m_per_s = 12},
                 {.time_s = 60, .speed_m_per_s = 2}}};
}
Wind stationary_storm() { return {.speed_m_per_s = 12, .gustiness = 0.3}; }

TreeMotion poplar() {
  return {.armatures = {{{100, 220}, {100, 40}}}, .frequency_hz = 0.7, .damping_per_s = 0.6, .mass = 6};
}

struct Spread {
  double mean = 0, variance = 0;
};
Spread spread_of(const std::vector<float>& values, std::size_t first, std::size_t last) {
  Spread spread;
  const auto count = static_cast<double>(last - first);
  for (std::size_t i = first; i < last; ++i) spread.mean += values[i] / count;
  for (std::size_t i = first; i < last; ++i) spread.variance += std::pow(values[i] - spread.mean, 2) / count;
  return spread;
}

TEST(TreeSway, LeansWithTheMeanWindAndSwingsWithItsTurbulence) {
  double calm = 0, storm = 0, steady = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Wind wind = rising();
    wind.seed = seed;
    TreeSway sway(poplar(), Gusts(wind, kLongFilm, 200), kLongFilm, 1, {0, 0, 16, 16});
    const std::vector<float>& lean = sway.lean(0);
    // At rest Eq. 4 says w / (4 pi^2 f0^2 m).
    const double expected = (12 - 2) / (4 * CV_PI * CV_PI * 0.7 * 0.7 * 6);
    EXPECT_NEAR(lean[1250], expected, 0.02 * expected);
    EXPECT_NEAR(lean[500], 0, 0.02 * expected);
    EXPECT_GT(*std::min_element(lean.begin(), lean.end()), -0.05 * expected);
    calm += spread_of(sway.tip(0), 100, 500).variance;
    storm += spread_of(sway.tip(0), 850, 1250).variance;
    wind = stationary_storm();
    wind.seed = seed;
    TreeSway same(poplar(), Gusts(wind, kLongFilm, 200), kLongFilm, 1, {0, 0, 16, 16});
    EXPECT_TRUE(same.lean(0).empty());
    steady += spread_of(same.tip(0), 850, 1250).variance;
  }
  EXPECT_NEAR(storm / steady, 1, 0.25);
  EXPECT_GT(storm, 40 * calm);  // (12 / 2)^2, and the spectrum moves up to the tree's frequency
}

TEST(TreeSway, NeverStepsFurtherThanInAStormThatStays) {
  const auto furthest = [](const std::vector<float>& of) {
    float most = 0;
    for (std::size_t t = 0; t < of.size(); ++t)
      most = std::max(most, std::abs(of[(t + 1) % of.size()] - of[t]));
    return most;
  };
  const Gusts gusts(rising(), kLongFilm, 200), steady(stationary_storm(), kLongFilm, 200);
  TreeSway sway(poplar(), gusts, kLongFilm, 1, {0, 0, 16, 16}),
      same(poplar(), steady, kLongFilm, 1, {0, 0, 16, 16});
  std::vector<float> sum(sway.tip(0));
  for (std::size_t t = 0; t < sum.size(); ++t) sum[t] += sway.lean(0)[t];
  EXPECT_LT(furthest(sum), 1.25 * furthest(same.tip(0)));
}

TEST(TreeSway, GrassThatIsBentAsFarAsItGoesStillSwings) {
  TreeMotion grass = poplar();
  grass.frequency_hz = 1.6, grass.damping_per_s = 2, grass.mass = 0.03;
  const Gusts gusts(rising(), kLongFilm, 200);
  TreeSway sway(grass, gusts, kLongFilm, 1, {0, 0, 200, 240});
  std::vector<float> turns;
  for (int frame = 900; frame < 1250; frame += 5) {
    sway.go_to(frame);
    float dx = 0, dy = 0;
    sway.row(0, 100, 40, 1, &dx, &dy);
    turns.push_back(-dx / 180);
  }
  const Spread spread = spread_of(turns, 0, turns.size());
  EXPECT_GT(spread.mean, 0.15);
  EXPECT_LT(spread.mean, 0.3);
  EXPECT_GT(std::sqrt(spread.variance), 0.1);
  EXPECT_LT(*std::max_element(turns.begin(), turns.end()), 0.65);
}

TEST(LeafShimmer, IsAsMuchLessAsTheWindIsSlower) {
  TreeMotion tree = poplar();
  tree.mass = 1e5, tree.shimmer_px = 2;
  Wind wind = rising(90);  // no lean in the picture
  TreeSway sway(tree, Gusts(wind, kLongFilm, 200), kLongFilm, 1, {0, 0, 200, 240});
  const auto power = [&](int first, int last) {
    double sum = 0;
    for (int frame = first; frame < last; frame += 10) {
      sway.go_to(frame);
      for (int y = 10; y < 220; y += 10)
        for (int x = 10; x < 190; x += 10) {
          float dx = 0, dy = 0;
          sway.row(0, x, y, 1, &dx, &dy);
          sum += dx * dx;
        }
    }
    return sum / ((last - first) / 10);
  };
  EXPECT_NEAR(std::sqrt(power(900, 1250) / power(100, 450)), 6, 0.7);
}

CloudMotion drifting_sky() { return {}; }

TEST(CloudDrift, GoesTheIntegralOfTheWind) {
  const Wind wind = rising();
  const CloudCourse course = course_of(drifting_sky(), wind, kLongFilm, false, 900, 1000);
  ASSERT_EQ(course.gone_px.size(), 1501u);
  const Weather weather(wind, kLongFilm);
  double gone = 0;
  constexpr int kFine = 40;
  for (int frame = 0; frame < 1500; ++frame) {
    EXPECT_NEAR(course.gone_px[static_cast<std::size_t>(frame)], gone, 0.02 + 1e-4 * gone);
    for (int i = 0; i < kFine; ++i)
      gone += weather.at((frame + (i + 0.5) / kFine) / 25).speed_m_per_s * 0.006 * 1000 / 25 / kFine;
  }
  const auto speed = [&](std::size_t at) { return (course.gone_px[at + 1] - course.gone_px[at]) * 25; };
  EXPECT_NEAR(speed(200), 12, 0.01);
  EXPECT_NEAR(speed(1000), 72, 0.01);
  // A speed of their own is that under the strongest wind.
  const CloudCourse own = course_of({.speed_px_per_s = -30.0}, wind, kLongFilm, false, 900, 1000);
  EXPECT_NEAR((own.gone_px[1001] - own.gone_px[1000]) * 25, -30, 0.01);
  EXPECT_NEAR((own.gone_px[201] - own.gone_px[200]) * 25, -5, 0.01);
}

TEST(CloudDrift, ComesRoundInALoopThatIsLongAndBackWithAWindThatTurns) {
  const CloudCourse round = course_of(drifting_sky(), rising(), kLongFilm, true, 900, 1000);
  EXPECT_FALSE(round.dissolves);
  const double rounds = round.gone_px.back() / round.period_px;
  EXPECT_NEAR(rounds, std::round(rounds), 1e-9);
  EXPECT_GE(rounds, 0.99);
  // There with the wind, and back with one that blows the other way as long.
  const Cycle cycle{.frames = 400, .fps = 20};
  const Wind turning{.speed_m_per_s = 5,
                     .at = {{.time_s = 5, .direction_deg = 0},
                            {.time_s = 10, .direction_deg = 180},
                            {.time_s = 15, .direction_deg = 180},
                            {.time_s = 20, .direction_deg = 0}}};
  const CloudCourse back = course_of(drifting_sky(), turning, cycle, true, 900, 1000);
  EXPECT_EQ(back.dissolves, std::abs(back.gone_px.back()) >= 0.5);
  EXPECT_GT(back.furthest_px(400, 20), 100);
  // A short loop: both copies are where they say at both ends.
  const CloudCourse brief = course_of(
      drifting_sky(),
      {.speed_m_per_s = 1, .at = {{.time_s = 2, .speed_m_per_s = 6}, {.time_s = 4, .speed_m_per_s = 1}}},
      {.frames = 80, .fps = 20}, true, 900, 1000);
  EXPECT_TRUE(brief.dissolves);
  CloudDrift drift(brief, drifting_sky(), {.frames = 80, .fps = 20}, {0, 0, 900, 300}, 3);
  float dx = 0, dy = 0, part = 0;
  drift.go_to(80);
  EXPECT_FALSE(drift.second(10, 10, 1, &part));
  drift.row(0, 10, 10, 1, &dx, &dy);
  EXPECT_EQ(dx, 0);
  drift.go_on_from(79);
  drift.row(1, 10, 10, 1, &dx, &dy);
  EXPECT_EQ(dx, 0);
}

WaterMotion bay(WaterMapping mapping) {
  return {.horizon = Line{{0, 40}, {200, 40}},
          .focal_px = 240.0,
          .camera_height_m = 2,
          .tile = 128,
          .roughness = 8,
          .amplitude = mapping == WaterMapping::kNormals ? 0.1 : 1.0,
          .mapping = mapping};
}

TEST(WaterSurface, GrowsFromCalmToStormWithoutAJumpAndClosesItsLoop) {
  for (const WaterMapping mapping : {WaterMapping::kDisplacement, WaterMapping::kNormals}) {
    Wind wind = rising(60), storm = stationary_storm();
    storm.direction_deg = 60;
    const Gusts gusts(wind, kLongFilm, 200), steady(storm, kLongFilm, 200);
    const cv::Rect region(0, 41, 200, 199);
    WaterSurface surface(bay(mapping), gusts, kLongFilm, 3, region, kPicture),
        same(bay(mapping), steady, kLongFilm, 3, region, kPicture);
    struct Field {
      std::vector<float> dx, dy;
    };
    const auto field = [](WaterSurface& of, int frame) {
      Field all;
      of.go_to(frame);
      for (int y = 60; y < 240; y += 6) {
        std::vector<float> dx(200), dy(200);
        of.row(0, 0, y, 200, dx.data(), dy.data());
        all.dx.insert(all.dx.end(), dx.begin(), dx.end()), all.dy.insert(all.dy.end(), dy.begin(), dy.end());
      }
      return all;
    };
    const auto power = [](const Field& of) {
      double sum = 0;
      for (const float v : of.dy) sum += static_cast<double>(v) * v;
      return sum / static_cast<double>(of.dy.size());
    };
    double calm = 0, high = 0, stays = 0;
    for (int frame = 0; frame < 400; frame += 20)
      calm += power(field(surface, 100 + frame)), high += power(field(surface, 850 + frame)),
          stays += power(field(same, 850 + frame));
    EXPECT_GT(high, 4 * calm);
    EXPECT_GT(calm, 0);
    EXPECT_NEAR(high / stays, 1, 0.35) << static_cast<int>(mapping);
    const auto step = [&](WaterSurface& of, int frame) {
      const Field now = field(of, frame), next = field(of, frame + 1);
      double sum = 0;
      for (std::size_t i = 0; i < now.dy.size(); ++i) sum += std::pow(next.dy[i] - now.dy[i], 2);
      return std::sqrt(sum / static_cast<double>(now.dy.size()));
    };
    double most = 0, usual = 0;
    // From 30 to 52 s the storm stays.
    for (int frame = 770; frame < 1290; frame += 9) usual = std::max(usual, step(surface, frame));
    for (int frame = 540; frame < 760; frame += 7) most = std::max(most, step(surface, frame));
    for (const int frame : {1499, 0, 750, 549, 550}) most = std::max(most, step(surface, frame));
    EXPECT_LT(most, 1.1 * usual) << static_cast<int>(mapping);
    EXPECT_EQ(field(surface, 0).dy, field(surface, 1500).dy);
    EXPECT_EQ(field(surface, 0).dx, field(surface, 1500).dx);
  }
}

TEST(WaterSurface, WavesThatGrowAreMadeLowerBeforeTheyFoldThePicture) {
  WaterMotion water = bay(WaterMapping::kDisplacement);
  water.amplitude = 60;
  const Gusts gusts(rising(60), kLongFilm, 200);
  WaterSurface surface(water, gusts, kLongFilm, 3, {0, 41, 200, 199}, kPicture);
  std::vector<float> dx(200), above(200), below(200);
  double square = 0, calm = 0, storm = 0;
  int count = 0;
  for (int frame = 100; frame < 1250; frame += 23) {
    surface.go_to(frame);
    for (int y = 50; y < 238; ++y) {
      surface.row(0, 0, y, 200, dx.data(), above.data());
      surface.row(0, 0, y + 1, 200, dx.data(), below.data());
      for (std::size_t x = 0; x < 200; ++x) {
        const double step = below[x] - above[x];
        square += step * step, ++count;
        (frame < 500 ? calm : storm) += frame < 500 || frame > 800 ? above[x] * above[x] : 0;
      }
    }
  }
  EXPECT_LT(std::sqrt(square / count), 0.42);
  EXPECT_GT(storm, 4 * calm);
}

TEST(BoatRide, HeavesMoreInTheStorm) {
  const Gusts gusts(rising(60), kLongFilm, 200);
  WaterSurface water(bay(WaterMapping::kNormals), gusts, kLongFilm, 3, {0, 41, 200, 199}, kPicture,
                     {60, 140, 80, 20});
  BoatRide ride({.hull = Line{{60, 150}, {140, 150}}}, water, false, {40, 100, 120, 60});
  const auto heave = [&](int first) {
    double sum = 0;
    for (int frame = first; frame < first + 400; frame += 10) {
      water.go_to(frame), ride.go_to(frame);
      float dx = 0, dy = 0;
      ride.row(0, 100, 150, 1, &dx, &dy);
      sum += dy * dy;
    }
    return sum;
  };
  EXPECT_GT(heave(850), 4 * heave(100));
}

}  // namespace
}  // namespace freshet::synth::scene
