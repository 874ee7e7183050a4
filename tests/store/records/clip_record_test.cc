#include "store/records/clip_record.h"

#include <gtest/gtest.h>

namespace freshet::store {
namespace {

StoredClip clip_of_rows(std::uint64_t rows) {
  StoredClip clip;
  clip.record.name = "a";
  clip.record.rows = rows;
  clip.columns["patch.x"] = {.element_bytes = 2, .flags = 0, .bytes = 2 * rows, .sum = {1, 7}};
  clip.columns["frame.time"] = {.element_bytes = 8, .flags = 0, .bytes = 80, .sum = {1, 7}};
  return clip;
}

TEST(ClipRecord, ComesBackAsItWas) {
  const Bytes bytes = serialise_clip(clip_of_rows(10));
  const auto clip = parse_clip(bytes);
  ASSERT_TRUE(clip);
  EXPECT_EQ(serialise_clip(*clip), bytes);
}

// Readers allocate for the rows before they read a column.
TEST(ClipRecord, WhoseRowsAreNotThoseOfItsColumnsIsRefused) {
  StoredClip clip = clip_of_rows(10);
  clip.record.rows = 1ull << 31;
  EXPECT_FALSE(parse_clip(serialise_clip(clip)));
  clip = clip_of_rows(10);
  clip.columns["patch.x"].bytes += 1;
  EXPECT_FALSE(parse_clip(serialise_clip(clip)));
  clip = clip_of_rows(10);
  clip.columns.erase("patch.x");
  EXPECT_FALSE(parse_clip(serialise_clip(clip)));
}

// No record holds more than a chunk.
TEST(ClipRecord, WhoseColumnsHaveMoreBytesThanTheirRecordsHoldIsRefused) {
  EXPECT_FALSE(parse_clip(serialise_clip(clip_of_rows(1ull << 31))));
  StoredClip clip = clip_of_rows(kChunkBytes);
  EXPECT_FALSE(parse_clip(serialise_clip(clip)));
  clip.columns["patch.x"].sum.records = 2;
  EXPECT_TRUE(parse_clip(serialise_clip(clip)));
}

}  // namespace
}  // namespace freshet::store
