#include "synth/transfer/forward_warp.h"

#include <gtest/gtest.h>

#include "synth/transfer/motion_blur.h"

namespace freshet::synth::transfer {
namespace {

struct Moved {
  PixelGrid picture{20, 10};
  Grid mask{20, 10};
  VectorGrid flow{20, 10};

  // Fluid in columns 4 to 7, which moves by 2.5 px; the rest is empty and still.
  Moved() {
    for (int y = 0; y < 10; ++y)
      for (int x = 4; x < 8; ++x) {
        picture(x, y) = {{0.1f * static_cast<float>(x), 0, 0, 1}};
        mask(x, y) = 1;
        flow(x, y) = {2.5f, 0};
      }
  }
};

TEST(ForwardWarp, FluidCoversWhatIsEmptyAndLeavesNothingBehind) {
  const Moved moved;
  const WarpedFrame out = forward_warp(moved.picture, moved.mask, moved.flow);
  for (const int x : {0, 4, 5, 12}) EXPECT_EQ(out.mask(x, 5), 0) << x;
  for (const int x : {7, 8, 9}) {
    EXPECT_NEAR(out.mask(x, 5), 1, 0.01) << x;
    EXPECT_NEAR(out.picture(x, 5).c[0], 0.1 * (x - 2.5), 0.01) << x;
  }
}

TEST(ForwardWarp, MotionOutOfTheFrameIsDropped) {
  Moved moved;
  for (Vec2& by : moved.flow.values) by = {1e9f, -1e30f};
  const WarpedFrame out = forward_warp(moved.picture, moved.mask, moved.flow);
  for (const float value : out.mask.values) ASSERT_EQ(value, 0);
}

TEST(LocalLambda, IsZeroWhereAnEmitterMakesFluid) {
  const Moved moved;
  const WarpedFrame out = forward_warp(moved.picture, moved.mask, moved.flow);
  Grid now(20, 10, 1.0f);
  const Grid lambda = local_lambda(now, out.mask, 0.2);
  EXPECT_NEAR(lambda(8, 5), 0.2, 0.002);
  EXPECT_EQ(lambda(0, 5), 0);
  now(0, 5) = 0;  // no fluid, none before
  EXPECT_NEAR(local_lambda(now, out.mask, 0.2)(0, 5), 0.2, 1e-6);
}

TEST(MotionBlur, SmearsAlongTheFlowOnly) {
  PixelGrid picture(41, 41);
  VectorGrid flow(41, 41, {8, 0});
  for (int x = 0; x < 41; ++x) picture(x, 20) = {{1, 1, 1, 1}};
  EXPECT_NEAR(blurred_along(picture, flow, 1)(20, 20).c[0], 1, 1e-6);  // a line along the flow stays
  EXPECT_EQ(blurred_along(picture, flow, 1)(20, 21).c[0], 0);
  for (Vec2& by : flow.values) by = {0, 8};
  const PixelGrid across = blurred_along(picture, flow, 1);
  EXPECT_LT(across(20, 20).c[0], 0.3);
  EXPECT_GT(across(20, 24).c[0], 0);  // half of 8 px to each side
  EXPECT_EQ(across(20, 25).c[0], 0);
}

TEST(ForwardWarp, AddressesAreCarriedWhole) {
  GridOf<std::int32_t> addresses(9, 7);
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 9; ++x) addresses(x, y) = 100 * y + x;
  const GridOf<std::int32_t> out = carried(addresses, VectorGrid(9, 7, {2.4f, -0.6f}));
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 9; ++x)
      EXPECT_EQ(out(x, y), x >= 2 && y < 6 ? 100 * (y + 1) + x - 2 : -1) << x << ' ' << y;
}

}  // namespace
}  // namespace freshet::synth::transfer
