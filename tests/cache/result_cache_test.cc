#include "cache/result_cache.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/parallel_for.h>

#include <fstream>
#include <iterator>
#include <random>

#include "freshet/error.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::cache {
namespace {

namespace fs = std::filesystem;

Key key_of(int number) {
  KeyHash hash;
  hash.add(number);
  return hash.key();
}

std::vector<std::byte> value_of(int number, std::size_t length = 300) {
  std::vector<std::byte> bytes(length);
  std::mt19937 random(static_cast<unsigned>(number));
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << text;
}

void fill(const fs::path& folder, int first, int count, std::uintmax_t max_bytes = 1 << 20) {
  ResultCache cache(folder, max_bytes);
  for (int i = first; i < first + count; ++i) cache.keep(key_of(i), value_of(i));
  cache.finish();
}

TEST(ResultCache, FindsWhatThisRunAndEarlierOnesKept) {
  const ScratchFolder folder;
  const fs::path place = folder.path() / "new" / "cache";
  fill(place, 0, 20);
  fill(place, 20, 5);
  ResultCache cache(place);
  cache.keep(key_of(100), value_of(100));
  for (const int number : {0, 7, 19, 20, 24, 100}) EXPECT_EQ(cache.find(key_of(number)), value_of(number));
  EXPECT_FALSE(cache.find(key_of(25)));
  cache.finish();
  EXPECT_EQ(cache.find(key_of(100)), value_of(100));
  EXPECT_TRUE(cache.take_notices().empty());
  EXPECT_EQ(files_in(place).size(), 3u);
}

TEST(ResultCache, KeepsFromManyThreads) {
  const ScratchFolder folder;
  {
    ResultCache cache(folder.path());
    oneapi::tbb::parallel_for(0, 500, [&](int i) { cache.keep(key_of(i % 400), value_of(i % 400)); });
  }
  ResultCache cache(folder.path());
  for (int i = 0; i < 400; ++i) EXPECT_EQ(cache.find(key_of(i)), value_of(i));
}

TEST(ResultCache, ARunThatKeepsNothingLeavesNothing) {
  const ScratchFolder folder;
  { ResultCache cache(folder.path()); }
  EXPECT_TRUE(files_in(folder.path()).empty());
}

// Each byte of a pack flipped, and the pack cut at each length: what is found is right, or not there.
TEST(ResultCache, DamageAnywhereIsSaidAndNeverBelieved) {
  const ScratchFolder whole, folder;
  {
    ResultCache cache(whole.path());
    for (int i = 0; i < 3; ++i) cache.keep(key_of(i), value_of(i, 40));
  }
  const std::string text = text_of(files_in(whole.path())[0]);
  const fs::path file = folder.path() / "0123456789abcdef0123456789abcdef.labels";
  write(folder.path() / "mine.labels", "somebody else's");
  write(folder.path() / "new-things", "also");
  std::size_t lost = 0;
  const auto check = [&](const std::string& damaged) {
    write(file, damaged);
    ResultCache cache(folder.path());
    bool all = true;
    for (int i = 0; i < 3; ++i) {
      const auto found = cache.find(key_of(i));
      if (found) {
        EXPECT_EQ(*found, value_of(i, 40));
      }
      all = all && found;
    }
    EXPECT_FALSE(all);
    const auto notices = cache.take_notices();
    ASSERT_EQ(notices.size(), 1u);
    EXPECT_NE(notices[0].find("0123456789abcdef.labels"), std::string::npos);
    ++lost;
    cache.finish();
    EXPECT_FALSE(fs::exists(file));
    EXPECT_TRUE(fs::exists(folder.path() / "mine.labels"));
    EXPECT_TRUE(fs::exists(folder.path() / "new-things"));
  };
  for (std::size_t at = 0; at < text.size(); ++at) {
    std::string damaged = text;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    check(damaged);
  }
  for (std::size_t length = 0; length < text.size(); ++length) check(text.substr(0, length));
  check(text + "more");
  EXPECT_EQ(lost, 2 * text.size() + 1);
}

TEST(ResultCache, HostileLengthsTakeNoMemory) {
  const ScratchFolder folder;
  fill(folder.path(), 0, 3);
  const fs::path file = files_in(folder.path())[0];
  std::string text = text_of(file);
  std::fill(text.begin() + 12, text.begin() + 16, '\xff');  // number of entries
  write(file, text);
  EXPECT_EQ(ResultCache(folder.path()).take_notices().size(), 1u);
}

TEST(ResultCache, WhatWasNotUsedForLongestGoesFirst) {
  const ScratchFolder folder;
  for (int pack = 0; pack < 4; ++pack) {
    fill(folder.path(), 10 * pack, 10);
    for (const fs::path& file : files_in(folder.path()))
      fs::last_write_time(file, fs::last_write_time(file) - std::chrono::hours(1));
  }
  {
    ResultCache cache(folder.path(), 15000);  // a pack has some 3400 bytes
    EXPECT_TRUE(cache.find(key_of(5)));       // the oldest is used again
    cache.keep(key_of(90), value_of(90, 3000));
  }
  ResultCache cache(folder.path(), 15000);
  EXPECT_TRUE(cache.find(key_of(5)));
  EXPECT_FALSE(cache.find(key_of(15)));
  EXPECT_TRUE(cache.find(key_of(25)));
  EXPECT_TRUE(cache.find(key_of(35)));
  EXPECT_TRUE(cache.find(key_of(90)));
}

TEST(ResultCache, StopsKeepingWhenARunAloneWouldFillIt) {
  const ScratchFolder folder;
  ResultCache cache(folder.path(), 2000);
  for (int i = 0; i < 20; ++i) cache.keep(key_of(i), value_of(i));
  const auto notices = cache.take_notices();
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_NE(notices[0].find("this run alone fills its"), std::string::npos);
  EXPECT_EQ(cache.find(key_of(0)), value_of(0));
  EXPECT_FALSE(cache.find(key_of(19)));
  cache.finish();
  EXPECT_EQ(cache.find(key_of(3)), value_of(3));
}

TEST(ResultCache, SaysWhenItsFolderCannotBe) {
  const ScratchFolder folder;
  write(folder.path() / "file", "");
  EXPECT_THROW(ResultCache(folder.path() / "file"), Error);
  EXPECT_THROW(ResultCache(folder.path() / "file" / "below"), Error);
}

TEST(KeyHash, TellsListsFromTheirNeighbours) {
  KeyHash a, b;
  a.add(std::string("ab"));
  a.add(std::string("c"));
  b.add(std::string("a"));
  b.add(std::string("bc"));
  EXPECT_NE(a.key(), b.key());
}

}  // namespace
}  // namespace freshet::cache
