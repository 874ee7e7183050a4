#include "platform/smoothstep.h"

#include <gtest/gtest.h>

namespace freshet {
namespace {

TEST(Smoothstep, RisesFromOneEndToTheOtherAndIsLevelThere) {
  EXPECT_EQ(smoothstep(2.0, 4.0, 1.0), 0);
  EXPECT_EQ(smoothstep(2.0, 4.0, 5.0), 1);
  EXPECT_DOUBLE_EQ(smoothstep(2.0, 4.0, 3.0), 0.5);
  EXPECT_DOUBLE_EQ(smoothstep(2.0, 4.0, 2.5), 3 / 16.0 - 2 / 64.0);
  EXPECT_FLOAT_EQ(smoothstep(1.0f, -1.0f, -0.5f), 1 - (3 / 16.0f - 2 / 64.0f)) << "falls";
}

}  // namespace
}  // namespace freshet
