#include "store/records/column.h"

#include <gtest/gtest.h>

#include <random>

namespace freshet::store {
namespace {

// Counters: their high bytes are alike, so that every size from 2 on is worth shuffling.
Bytes counters(std::size_t bytes, std::size_t element) {
  Bytes raw(bytes);
  for (std::size_t i = 0; i < bytes; ++i)
    raw[i] = static_cast<std::byte>(i % element == 0 ? i / element * 37 : i % element * 11);
  return raw;
}

TEST(Column, ShuffledBytesComeBackForEverySizeOfElement) {
  int shuffled = 0;
  for (std::uint32_t element = 2; element <= 256; ++element) {
    for (const std::size_t count : {1, 15, 16, 31, 32, 33, 47, 48, 100}) {
      for (const std::size_t tail : {std::size_t{0}, std::size_t{element - 1}}) {
        const Bytes raw = counters(count * element + tail, element);
        Bytes stored;
        const Codec codec = compress_column(raw, element, stored);
        Bytes found(raw.size());
        ASSERT_TRUE(expand_column(codec, stored, element, found)) << element << " x " << count;
        ASSERT_EQ(found, raw) << element << " x " << count << " + " << tail;
        shuffled += codec == Codec::kShuffle;
      }
    }
  }
  EXPECT_GT(shuffled, 1000);
}

TEST(Column, NoiseIsKeptAsItIs) {
  std::mt19937 random(5);
  Bytes raw(1000);
  for (std::byte& byte : raw) byte = static_cast<std::byte>(random());
  Bytes stored;
  EXPECT_EQ(compress_column(raw, 8, stored), Codec::kRaw);
  EXPECT_EQ(stored, raw);
  Bytes found(raw.size());
  EXPECT_TRUE(expand_column(Codec::kRaw, stored, 8, found));
  EXPECT_EQ(found, raw);
  EXPECT_FALSE(expand_column(Codec::kShuffle, stored, 8, found));
}

}  // namespace
}  // namespace freshet::store
