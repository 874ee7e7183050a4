#include "media/picture_sequence.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "generated_clip.h"

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

TEST(ListFolder, PassesOverWhatIsHiddenOrNoPicture) {
  const Scratch scratch;
  for (const char* name : {"f10.png", "f9.PNG", "._f9.png", ".f8.png", "notes.txt"})
    put_bytes(scratch / name, {'x'});
  std::vector<std::string> names;
  for (const auto& file : list_folder(scratch.folder()).files) names.push_back(file.filename().string());
  EXPECT_EQ(names, (std::vector<std::string>{"f9.PNG", "f10.png"}));
}

}  // namespace
}  // namespace freshet::media
