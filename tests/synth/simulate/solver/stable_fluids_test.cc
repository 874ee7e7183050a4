#include "synth/simulate/solver/stable_fluids.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "platform/random.h"
#include "synth/simulate/clips/gas.h"

namespace freshet::synth::simulate {
namespace {

TEST(StableFluids, StaysFiniteAndBoundedUnderHostileForces) {
  const float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  const float confinements[] = {0.0f, 50.0f, kNan, -1e30f};
  for (const float confinement : confinements) {
    StableFluids flow(48, 33, {.bottom = Edge::kFixed, .confinement = confinement, .max_speed = 20.0f});
    VectorGrid force(48, 33);
    const Random random(3, 3);
    for (int frame = 0; frame < 200; ++frame) {
      for (std::size_t i = 0; i < force.values.size(); ++i) {
        const std::uint64_t draw = static_cast<std::uint64_t>(frame) * 10000 + i;
        force.values[i] = {2e6f * (random.at(draw) - 0.5f), i % 97 == 0 ? kNan : i % 89 == 0 ? -kInf : 1e30f};
      }
      flow.step(&force);
      for (const Vec2 v : flow.velocity().values) {
        ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y)) << "frame " << frame << ", " << confinement;
      }
    }
  }
}

TEST(StableFluids, KeepsAUniformFlowUniform) {
  StableFluids flow(40, 30, {.left = Edge::kFixed, .top = Edge::kFixed, .bottom = Edge::kFixed});
  flow.set_inflow_left(std::vector<float>(30, 1.25f));
  const VectorGrid none(40, 30);
  for (int frame = 0; frame < 50; ++frame) flow.step(&none);
  for (const Vec2 v : flow.velocity().values) {
    ASSERT_NEAR(v.x, 1.25f, 1e-3f);
    ASSERT_NEAR(v.y, 0.0f, 1e-3f);
  }
}

TEST(StableFluids, FlowsRoundASolidAndNotThroughIt) {
  GridOf<std::uint8_t> solid(60, 40);
  for (int y = 15; y < 25; ++y) {
    for (int x = 20; x < 30; ++x) solid(x, y) = 1;
  }
  StableFluids flow(
      60, 40, {.left = Edge::kFixed, .top = Edge::kFixed, .bottom = Edge::kFixed, .confinement = 0}, solid);
  flow.set_inflow_left(std::vector<float>(40, 1.0f));
  const VectorGrid none(60, 40);
  ProjectionReport report;
  for (int frame = 0; frame < 40; ++frame) report = flow.step(&none);
  EXPECT_LT(report.divergence_after, 4e-3);
  EXPECT_EQ(flow.velocity()(25, 20).x, 0.0f);
  // 40 rows of inflow squeeze through the 30 that are free.
  float through = 0.0f;
  for (int y = 0; y < 40; ++y) through += flow.u()(25, y);
  EXPECT_NEAR(through, 40.0f, 0.5f);
  EXPECT_GT(flow.velocity()(25, 12).x, 1.15f);
}

struct Carried {
  float minimum = 1e9f, maximum = -1e9f;
  double mass_before = 0.0, mass_after = 0.0;
};
Carried carry(Gas::Edges edges, float inside, float outside) {
  Gas gas(Domain({.size = {96, 80}}, 0.1f, 0.1f, 0.1f), 1.0f,
          {.left = Edge::kFixed, .right = Edge::kFixed, .top = Edge::kFixed, .bottom = Edge::kFixed}, 1, 20);
  Grid& field = gas.fields[0];
  for (int y = 0; y < field.height; ++y) {
    for (int x = 0; x < field.width; ++x) {
      const int dx = x - field.width / 2, dy = y - field.height / 2;
      field(x, y) = dx * dx + dy * dy < 400 ? inside : outside;
    }
  }
  Carried result;
  for (const float value : field.values) result.mass_before += static_cast<double>(value);
  for (int frame = 0; frame < 60; ++frame) {
    for (int y = 0; y < gas.force.height; ++y) {
      for (int x = 0; x < gas.force.width; ++x)
        gas.force(x, y) = {0.05f * static_cast<float>((x / 20 + frame / 9) % 3 - 1),
                           y < gas.force.height / 2 ? 0.04f : -0.05f};
    }
    gas.advance(edges);
  }
  for (const float value : gas.fields[0].values) {
    result.minimum = std::min(result.minimum, value), result.maximum = std::max(result.maximum, value);
    result.mass_after += static_cast<double>(value);
  }
  return result;
}

TEST(Advection, KeepsAConstantFieldConstant) {
  for (const Gas::Edges edges : {Gas::Edges::kSoft, Gas::Edges::kSharp}) {
    const Carried c = carry(edges, 0.625f, 0.625f);
    EXPECT_NEAR(c.minimum, 0.625f, 1e-5f);
    EXPECT_NEAR(c.maximum, 0.625f, 1e-5f);
  }
}

TEST(Advection, MakesNoNewExtremesAndKeepsMassWithinATenth) {
  for (const Gas::Edges edges : {Gas::Edges::kSoft, Gas::Edges::kSharp}) {
    const Carried c = carry(edges, 1.0f, 0.0f);
    EXPECT_GE(c.minimum, -1e-6f);
    EXPECT_LE(c.maximum, 1.0f + 1e-6f);
    EXPECT_NEAR(c.mass_after / c.mass_before, 1.0, 0.1);
  }
}

TEST(Advection, SharpEdgesKeepMoreOfAFieldThanSoftOnes) {
  EXPECT_GT(carry(Gas::Edges::kSharp, 1.0f, 0.0f).maximum,
            carry(Gas::Edges::kSoft, 1.0f, 0.0f).maximum - 1e-6f);
}

}  // namespace
}  // namespace freshet::synth::simulate
