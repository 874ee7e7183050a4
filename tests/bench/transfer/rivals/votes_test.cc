#include "bench/transfer/rivals/votes.h"

#include <gtest/gtest.h>

namespace freshet::bench {
namespace {

using namespace synth::transfer;

/// A row of 9 x 9 px whose pixel x has the value of x.
PixelGrid steps() {
  PixelGrid out(9, 9);
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 9; ++x) out(x, y).c[0] = static_cast<float>(x) / 10;
  return out;
}
constexpr int at(int x, int y) { return 9 * y + x; }

TEST(RivalVotes, ADiscreteVoteIsTheProposalNearestToTheMean) {
  NearestField field(9, 9, 9, 9);
  // Three patches of 3 px over (4, 4): it is proposed .2, .5 and .6, whose mean is .433.
  field.source[at(4, 4)] = at(2, 4);
  field.source[at(3, 4)] = at(4, 4);
  field.source[at(4, 3)] = at(6, 3);
  PixelGrid into(9, 9);
  vote_discrete(steps(), field, 3, 0.6, into);
  EXPECT_EQ(into(4, 4).c[0], 0.5f);
  EXPECT_EQ(into(8, 8).c[0], 0.0f) << "no patch is there";
  field.distance[at(4, 4)] = 0, field.distance[at(3, 4)] = field.distance[at(4, 3)] = 100;
  vote_discrete(steps(), field, 3, 0.6, into);
  EXPECT_EQ(into(4, 4).c[0], 0.2f) << "the nearest patch weighs most";
}

TEST(RivalVotes, CompletionsJoinTheMean) {
  NearestField field(9, 9, 9, 9);
  field.source[at(4, 4)] = at(2, 4);
  PixelGrid into(9, 9);
  vote_bidirectional(steps(), field, {}, 3, 0.6, into);
  EXPECT_FLOAT_EQ(into(4, 4).c[0], 0.2f);
  const Completing pair{at(7, 4), at(4, 4), 3 * vote_weight(0, 0.6)};
  vote_bidirectional(steps(), field, {pair}, 3, 0.6, into);
  EXPECT_FLOAT_EQ(into(4, 4).c[0], (0.2f + 3 * 0.7f) / 4);
  EXPECT_FLOAT_EQ(into(5, 5).c[0], (0.3f + 3 * 0.8f) / 4);
}

}  // namespace
}  // namespace freshet::bench
