#include "media/picture/picture_sequence.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/harness/scratch_folder.h"
#include "tests/media/generated_clip.h"

namespace freshet::media {
namespace {

TEST(NaturalLess, ComparesNumbersByValueAndAllElseByBytes) {
  const std::vector<std::string> sorted{"A", "a", "a1", "a01", "a2", "a10", "a10b", "b", "ä"};
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    for (std::size_t j = 0; j < sorted.size(); ++j) {
      // "a1" and "a01" are equal as numbers: bytes decide, '0' before '1'.
      const bool swapped = (i == 2 && j == 3) || (i == 3 && j == 2);
      EXPECT_EQ(natural_less(sorted[i], sorted[j]), swapped ? i > j : i < j) << sorted[i] << " " << sorted[j];
    }
  }
}

TEST(Pattern, ARunOfHashesStandsForAsManyDigits) {
  EXPECT_TRUE(is_pattern("shot/f.####.png"));
  EXPECT_EQ(numbered("shot/f.####.png", 7), "shot/f.0007.png");
  EXPECT_EQ(numbered("f##.png", 123), "f123.png");
  for (const char* name : {"take#1.png", "a##b##.png", "shot##/f.png", "plain.png"})
    EXPECT_FALSE(is_pattern(name)) << name;
  const ScratchFolder scratch;
  for (const char* name : {"f.0099.png", "f.0100.png", "f.101.png", "g.0001.png"})
    put_bytes(scratch / name, {'x'});
  const PictureSequence found = list_pattern(scratch / "f.####.png");
  EXPECT_EQ(found.numbers, (std::vector<std::int64_t>{99, 100}));
}

TEST(FirstMissing, NamesTheFileOfTheFirstGap) {
  const auto missing = [](const std::vector<const char*>& names) {
    PictureSequence sequence;
    for (const char* name : names) sequence.files.emplace_back(name);
    return first_missing(sequence).value_or("").string();
  };
  EXPECT_EQ(missing({"a/f.0099.png", "a/f.0101.png", "a/f.0104.png"}), "a/f.0100.png");
  EXPECT_EQ(missing({"f8.png", "f9.png", "f11.png"}), "f10.png");
  EXPECT_EQ(missing({"v2_08.flo", "v2_10.flo"}), "v2_09.flo");
  EXPECT_EQ(missing({"f.1001.png", "f.1002.png"}), "");
  EXPECT_EQ(missing({"one.png", "two.png"}), "");
  EXPECT_EQ(missing({"a1.png", "b3.png"}), "");
  EXPECT_EQ(missing({}), "");
}

TEST(ListFolder, PassesOverWhatIsHiddenOrNoPicture) {
  const ScratchFolder scratch;
  for (const char* name : {"f10.png", "f9.PNG", "._f9.png", ".f8.png", "notes.txt"})
    put_bytes(scratch / name, {'x'});
  std::vector<std::string> names;
  for (const auto& file : list_folder(scratch.path()).files) names.push_back(file.filename().string());
  EXPECT_EQ(names, (std::vector<std::string>{"f9.PNG", "f10.png"}));
}

}  // namespace
}  // namespace freshet::media
