#include "platform/text.h"

#include <gtest/gtest.h>

#include <array>

namespace freshet {
namespace {

TEST(Text, LowersLettersAndLeavesAllOtherBytes) {
  EXPECT_EQ(lower_case("AZ az 09 [\\]^_` \xc3\x84"), "az az 09 [\\]^_` \xc3\x84");
  EXPECT_EQ(lower_ending("Some.Folder/CLIP.Mp4"), ".mp4");
  EXPECT_EQ(lower_ending("Some.Folder/clip"), "");
}

TEST(Text, WritesTwoHexadecimalDigitsAByte) {
  EXPECT_EQ(hex(std::array<std::uint8_t, 3>{0x00, 0x9f, 0xa1}), "009fa1");
  EXPECT_EQ(hex(0x0123456789abcdefu), "0123456789abcdef");
  EXPECT_EQ(hex(std::uint64_t{10}), "000000000000000a");
}

}  // namespace
}  // namespace freshet
