#include "synth/simulate/solver/projection.h"

#include <gtest/gtest.h>

#include "platform/random.h"

namespace freshet::synth::simulate {
namespace {

struct Flow {
  Grid u, v, face_x, face_y;
};

/// Random velocities, at most 2 cells per frame, on faces that are open except for round obstacles and, if
/// asked, the rim.
Flow random_flow(int width, int height, bool closed, std::uint64_t seed) {
  Random random(seed, 1);
  Flow f{Grid(width + 1, height), Grid(width, height + 1), Grid(width + 1, height, 1.0f),
         Grid(width, height + 1, 1.0f)};
  const int ox = random.below(width), oy = random.below(height), radius = 2 + random.below(6);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if ((x - ox) * (x - ox) + (y - oy) * (y - oy) > radius * radius) continue;
      f.face_x(x, y) = f.face_x(x + 1, y) = f.face_y(x, y) = f.face_y(x, y + 1) = 0.0f;
    }
  }
  for (int y = 0; closed && y < height; ++y) f.face_x(0, y) = f.face_x(width, y) = 0.0f;
  for (int x = 0; closed && x < width; ++x) f.face_y(x, 0) = f.face_y(x, height) = 0.0f;
  for (std::size_t i = 0; i < f.u.values.size(); ++i)
    f.u.values[i] = f.face_x.values[i] * random.between(-2, 2);
  for (std::size_t i = 0; i < f.v.values.size(); ++i)
    f.v.values[i] = f.face_y.values[i] * random.between(-2, 2);
  return f;
}

TEST(Projection, LeavesNoDivergenceWhateverTheShapeAndTheRim) {
  const int sizes[][2] = {{4, 4}, {37, 23}, {64, 64}, {120, 71}, {5, 200}, {320, 180}};
  for (const auto& size : sizes) {
    for (const bool closed : {false, true}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        Flow f = random_flow(size[0], size[1], closed, seed);
        Projection projection(f.face_x, f.face_y);
        const ProjectionReport report =
            projection.apply(f.u, f.v, {.max_divergence = 1e-4, .max_iterations = 40});
        EXPECT_LT(divergence(f.u, f.v, f.face_x, f.face_y), 2e-4)
            << size[0] << "x" << size[1] << (closed ? " closed" : " open") << ", " << report.iterations
            << " iterations from " << report.divergence_before;
      }
    }
  }
}

TEST(Projection, NeedsFewIterations) {
  Flow f = random_flow(320, 180, false, 5);
  Projection projection(f.face_x, f.face_y);
  const ProjectionReport report = projection.apply(f.u, f.v);
  EXPECT_LT(report.divergence_after, 4e-3);
  EXPECT_LE(report.iterations, 12);
}

TEST(Projection, KeepsAFlowThatHasNoDivergence) {
  Flow f = random_flow(48, 32, false, 1);
  std::fill(f.u.values.begin(), f.u.values.end(), 1.5f);
  std::fill(f.v.values.begin(), f.v.values.end(), -0.25f);
  std::fill(f.face_x.values.begin(), f.face_x.values.end(), 1.0f);
  std::fill(f.face_y.values.begin(), f.face_y.values.end(), 1.0f);
  Projection projection(f.face_x, f.face_y);
  projection.apply(f.u, f.v);
  for (const float u : f.u.values) ASSERT_NEAR(u, 1.5f, 1e-5f);
  for (const float v : f.v.values) ASSERT_NEAR(v, -0.25f, 1e-5f);
}

TEST(Projection, LeavesPrescribedFacesAlone) {
  Flow f = random_flow(40, 40, true, 2);
  for (int y = 0; y < 40; ++y) f.u(0, y) = f.u(40, y) = 0.7f;  // in at one side, out at the other
  Projection projection(f.face_x, f.face_y);
  projection.apply(f.u, f.v, {.max_divergence = 1e-4, .max_iterations = 40});
  for (int y = 0; y < 40; ++y) EXPECT_EQ(f.u(0, y), 0.7f);
  EXPECT_LT(divergence(f.u, f.v, f.face_x, f.face_y), 2e-4);
}

TEST(Projection, LeavesTheDivergenceThatASourceAsksFor) {
  Flow f = random_flow(40, 30, false, 4);
  Grid source(40, 30);
  source(12, 9) = 0.5f, source(30, 20) = -0.25f;
  Projection projection(f.face_x, f.face_y);
  projection.apply(f.u, f.v, {.max_divergence = 1e-4, .max_iterations = 40}, &source);
  EXPECT_LT(divergence(f.u, f.v, f.face_x, f.face_y, &source), 2e-4);
  EXPECT_NEAR(f.u(13, 9) - f.u(12, 9) + f.v(12, 10) - f.v(12, 9), 0.5f, 2e-3f);
}

TEST(Projection, AResetIsAsGoodAsANewOne) {
  const Flow f = random_flow(61, 37, false, 6), other = random_flow(61, 37, true, 7);
  Projection fresh(f.face_x, f.face_y), reset(other.face_x, other.face_y);
  reset.reset(f.face_x, f.face_y);
  Flow a = f, b = f;
  fresh.apply(a.u, a.v);
  reset.apply(b.u, b.v);
  EXPECT_EQ(a.u.values, b.u.values);
  EXPECT_EQ(a.v.values, b.v.values);
}

}  // namespace
}  // namespace freshet::synth::simulate
