#include "synth/simulate/solver/shallow_water.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace freshet::synth::simulate {
namespace {

constexpr float kCell = 0.05f, kGravity = 2.0f;

ShallowWater pond(int width, int height, float depth, float friction = 0.0f) {
  return {Grid(width, height, -depth), {.cell = kCell, .gravity = kGravity, .friction = friction}};
}
void run(ShallowWater& water, float seconds) {
  while (seconds > 0.0f) {
    const float step = std::min(seconds, water.longest_step());
    water.step(step);
    seconds -= step;
  }
}
double volume(const ShallowWater& water) {
  double sum = 0.0;
  for (const float depth : water.depth().values) sum += depth;
  return sum;
}

TEST(ShallowWater, StaysAtRestOverAnyBed) {
  Grid bed(40, 30);
  for (int y = 0; y < bed.height; ++y) {
    for (int x = 0; x < bed.width; ++x)
      bed(x, y) =
          -0.4f + 0.6f * std::sin(0.7f * static_cast<float>(x)) * std::cos(0.4f * static_cast<float>(y));
  }
  ShallowWater water(bed, {.cell = kCell, .gravity = kGravity});
  run(water, 2.0f);
  int dry = 0;
  for (int y = 0; y < bed.height; ++y) {
    for (int x = 0; x < bed.width; ++x) {
      const float depth = water.depth()(x, y);
      EXPECT_NEAR(depth, std::max(0.0f, -bed(x, y)), 1e-5f) << x << ", " << y;
      EXPECT_NEAR(std::hypot(water.velocity()(x, y).x, water.velocity()(x, y).y), 0.0f, 1e-4f);
      dry += depth == 0.0f;
    }
  }
  EXPECT_GT(dry, 50) << "islands that stand out of the water are part of it";
}

TEST(ShallowWater, KeepsItsVolume) {
  ShallowWater water = pond(80, 70, 0.3f);
  for (int y = 30; y < 40; ++y) {
    for (int x = 35; x < 50; ++x) water.pull(x, y, 0.15f, {}, 1.0f);
  }
  const double before = volume(water);
  run(water, 0.8f);  // until shortly before it reaches the borders
  EXPECT_NEAR(volume(water), before, 1e-5 * before);
  EXPECT_NEAR(water.depth()(1, 1), 0.3f, 1e-6f);
  EXPECT_LT(water.depth()(42, 35), 0.42f);
}

// Stoker 1957: a dam between two depths is gone at once. Behind the bore that runs into the lower water depth and
// velocity are even, and follow from it and from the wave that runs back.
TEST(ShallowWater, BreaksADamAsStokerSays) {
  const double high = 0.5, low = 0.2, g = kGravity;
  double least = low, most = high;
  const auto behind_wave = [&](double h) { return 2.0 * (std::sqrt(g * high) - std::sqrt(g * h)); };
  const auto behind_bore = [&](double h) { return (h - low) * std::sqrt(0.5 * g * (h + low) / (h * low)); };
  for (int i = 0; i < 60; ++i) {
    const double h = 0.5 * (least + most);
    (behind_wave(h) > behind_bore(h) ? least : most) = h;
  }
  const double depth = least, speed = behind_bore(depth), bore = depth * speed / (depth - low);
  for (const bool along_x : {true, false}) {
    ShallowWater water = along_x ? pond(200, 3, 0.2f) : pond(3, 200, 0.2f);
    for (int i = 0; i < 100; ++i) {
      for (int j = 0; j < 3; ++j) water.pull(along_x ? i : j, along_x ? j : i, 0.3f, {}, 1.0f);
    }
    run(water, 3.0f);
    const auto depth_at = [&](int i) { return along_x ? water.depth()(i, 1) : water.depth()(1, i); };
    const Vec2 v = along_x ? water.velocity()(125, 1) : water.velocity()(1, 125);
    EXPECT_NEAR(depth_at(125), depth, 0.01 * depth);
    EXPECT_NEAR(along_x ? v.x : v.y, speed, 0.02 * speed);
    int front = 199;
    while (depth_at(front) < 0.5 * (depth + low)) --front;
    EXPECT_NEAR((front + 0.5 - 99.5) * kCell, 3.0 * bore, 2 * kCell);
  }
}

TEST(ShallowWater, RunsUpABeachAndDrainsOffIt) {
  Grid bed(3, 120);
  for (int y = 0; y < bed.height; ++y) {
    for (int x = 0; x < bed.width; ++x) bed(x, y) = 0.3f - 0.01f * static_cast<float>(y);
  }
  ShallowWater water(bed, {.cell = kCell, .gravity = kGravity, .friction = 0.01f});
  const auto shore = [&] {
    int y = 0;
    while (water.depth()(1, y) <= water.thinnest()) ++y;
    return y;
  };
  const int at_rest = shore();
  for (int y = 80; y < 100; ++y) {
    for (int x = 0; x < 3; ++x) water.pull(x, y, 0.15f, {0.0f, -0.25f}, 1.0f);
  }
  const auto go_on = [&] {
    run(water, 0.04f);
    for (int y = 100; y < 120; ++y) {
      for (int x = 0; x < 3; ++x) water.pull(x, y, 0.0f, {}, 0.2f);
    }
  };
  int highest = at_rest;
  for (int i = 0; i < 200; ++i) {
    go_on();
    highest = std::min(highest, shore());
    for (const float depth : water.depth().values) ASSERT_GE(depth, 0.0f);
  }
  EXPECT_LT(highest, at_rest - 4);
  for (int i = 0; i < 500; ++i) go_on();
  EXPECT_GT(shore(), highest + 2);
  for (std::size_t i = 0; i < bed.values.size(); ++i) {
    const Vec2 v = water.velocity().values[i];
    EXPECT_LT(water.depth().values[i] * std::hypot(v.x, v.y), 0.002f) << "a film may still run down";
  }
}

TEST(ShallowWater, IsHeldBackByItsBed) {
  ShallowWater smooth = pond(40, 3, 0.1f), rough = pond(40, 3, 0.1f, 0.05f);
  for (ShallowWater* water : {&smooth, &rough}) {
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < 40; ++x) water->pull(x, y, 0.0f, {0.3f, 0.0f}, 1.0f);
    }
    run(*water, 2.0f);
  }
  EXPECT_NEAR(smooth.velocity()(20, 1).x, 0.3f, 1e-4f);
  // dv/dt = -friction v^2 / depth
  EXPECT_NEAR(rough.velocity()(20, 1).x, 0.3f / (1.0f + 0.3f * 0.05f / 0.1f * 2.0f), 0.005f);
}

}  // namespace
}  // namespace freshet::synth::simulate
