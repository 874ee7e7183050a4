#include "platform/random.h"

#include <gtest/gtest.h>

namespace freshet {
namespace {

// The first draws that the authors' reference program gives for this seed.
TEST(SplitMix64, DrawsWhatTheReferenceDraws) {
  SplitMix64 draws(1234567);
  EXPECT_EQ(draws.next(), 6457827717110365317u);
  EXPECT_EQ(draws.next(), 3203168211198807973u);
  EXPECT_EQ(draws.next(), 9817491932198370423u);
}

TEST(Random, IsAFunctionOfItsIndexInAnyOrder) {
  Random walked(7, 3);
  const Random asked(7, 3);
  for (std::uint64_t i = 0; i < 20; ++i) EXPECT_EQ(walked.next(), asked.at(i));
}

TEST(Random, KeepsStreamsApart) { EXPECT_NE(Random(7, 3).bits(0), Random(7, 4).bits(0)); }

}  // namespace
}  // namespace freshet
