#include "synth/transfer/open_places.h"

#include <algorithm>
#include <cstdlib>
#include <set>

#include <gtest/gtest.h>

#include "platform/random.h"

namespace freshet::synth::transfer {
namespace {

TEST(OpenPlaces, DrawsOnlyWhatIsLeftUntilNothingIs) {
  Random random(3, 0);
  std::set<int> left;
  while (left.size() < 200) left.insert(random.below(37 * 21));
  OpenPlaces open(37, 21, {left.begin(), left.end()});
  while (!left.empty()) {
    const int x = random.below(60) - 10, y = random.below(40) - 10;
    const int drawn = open.near(x, y, random.bits(left.size()));
    ASSERT_TRUE(left.count(drawn)) << drawn;
    // Squares of 2 << k px at (x, y): it lies in the first that has one.
    const int cx = std::clamp(x, 0, 36), cy = std::clamp(y, 0, 20);
    for (int k = 0;; ++k) {
      const auto in_square = [&](int place) {
        return place % 37 >> k == cx >> k && place / 37 >> k == cy >> k;
      };
      if (!std::any_of(left.begin(), left.end(), in_square)) continue;
      ASSERT_TRUE(in_square(drawn));
      break;
    }
    open.remove(drawn);
    left.erase(drawn);
    ASSERT_EQ(open.count(), static_cast<int>(left.size()));
  }
  EXPECT_EQ(open.near(5, 5, 1), -1);
}

TEST(OpenPlaces, EveryPlaceOfASquareComesUp) {
  const OpenPlaces open(8, 8, {1, 7, 56, 63, 36});
  std::set<int> drawn;
  const Random random(1, 0);
  for (std::uint64_t i = 0; i < 200; ++i) drawn.insert(open.near(2, 5, random.bits(i)));
  EXPECT_EQ(drawn.size(), 1u);  // 36 is no neighbour in its square of 4; 56 is
  EXPECT_TRUE(drawn.count(56));
  drawn.clear();
  for (std::uint64_t i = 0; i < 200; ++i)
    drawn.insert(OpenPlaces(8, 8, {1, 7, 63}).near(2, 5, random.bits(i)));
  EXPECT_EQ(drawn.size(), 3u);
}

TEST(OpenPlaces, OneThatIsAddedIsFound) {
  OpenPlaces open(33, 20, {});
  EXPECT_EQ(open.near(4, 4, 1), -1);
  open.add(7 * 33 + 30);
  EXPECT_EQ(open.near(4, 4, 1), 7 * 33 + 30);
  open.remove(7 * 33 + 30);
  EXPECT_EQ(open.near(4, 4, 1), -1);
}

}  // namespace
}  // namespace freshet::synth::transfer
