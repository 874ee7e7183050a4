#include "ingest/clip_sources.h"

#include <gtest/gtest.h>

namespace freshet::ingest {
namespace {

TEST(ClipSources, TheLongestNameThatHoldsTheClipCounts) {
  const std::vector<ClipSource> sources{{.name = "water", .author = "folder"},
                                        {.name = "water/far/", .author = "deeper"},
                                        {.name = "water/fall.mp4", .author = "clip"}};
  const auto author = [&](const char* clip) {
    const ClipSource* const found = source_of(sources, clip);
    return found == nullptr ? std::string() : found->author;
  };
  EXPECT_EQ(author("water/fall.mp4"), "clip");
  EXPECT_EQ(author("water/fall.mp4@2.000-7.500"), "clip") << "a part of the film";
  EXPECT_EQ(author("water/fall.mp42"), "folder");
  EXPECT_EQ(author("water/far/a.mkv"), "deeper");
  EXPECT_EQ(author("water/b.mkv"), "folder");
  EXPECT_EQ(author("waterfall/b.mkv"), "");
  EXPECT_EQ(author("fire/water"), "");
  EXPECT_EQ(source_of({}, "water"), nullptr);
}

}  // namespace
}  // namespace freshet::ingest
