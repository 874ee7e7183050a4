#include "platform/likeness.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace freshet {
namespace {

TEST(Likeness, FindsTheNameThatWasMeant) {
  const std::vector<std::string> names{"clouds", "fire", "smoke", "water"};
  EXPECT_EQ(likest("watr", names), "water");
  EXPECT_EQ(likest("Water", names), "water");
  EXPECT_EQ(likest("wtaer", names), "");  // two of five bytes
  EXPECT_EQ(likest("smokes", names), "smoke");
  EXPECT_EQ(likest("cluods", names), "clouds");
  EXPECT_EQ(likest("lava", names), "");
  EXPECT_EQ(likest("", names), "");
  EXPECT_EQ(likest("fire", std::vector<std::string>{}), "");
}

TEST(Likeness, OfEqualsTheFirst) { EXPECT_EQ(likest("cat", std::vector<std::string>{"bat", "rat"}), "bat"); }

TEST(Likeness, IsAskedOrNothingIsSaid) {
  EXPECT_EQ(did_you_mean("fir", std::vector<std::string>{"fire"}), "Did you mean \"fire\"? ");
  EXPECT_EQ(did_you_mean("xyz", std::vector<std::string>{"fire"}), "");
}

}  // namespace
}  // namespace freshet
