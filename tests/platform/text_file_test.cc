#include "platform/text_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/harness/scratch_folder.h"

namespace freshet {
namespace {

TEST(TextFile, NestingIsThatOfTheTextAndNotOfItsStrings) {
  EXPECT_EQ(json_nesting(""), 0U);
  EXPECT_EQ(json_nesting(R"({"a": [[1], [2, "]][[["], "\"[[["]})"), 3U);
  EXPECT_EQ(json_nesting("]]]]["), 1U);
  EXPECT_EQ(json_nesting(std::string(100000, '[')), 100000U);
  EXPECT_EQ(toml_nesting("a.b.c = 1\n"), 2U);
  EXPECT_EQ(toml_nesting("a = 1.5 # ....\nb = '....'\nc = \"....\\\"...\"\n"), 1U);
  EXPECT_EQ(toml_nesting("a = \"\"\"...\n\"...\n\"\"\"\n[b.c]\n"), 2U);
  EXPECT_EQ(toml_nesting("\"a.b\".c = {x.y = [[1]]}"), 3U);
  EXPECT_EQ(toml_nesting("unclosed = \"..."), 0U);
  EXPECT_EQ(toml_nesting("#"), 0U);
}

TEST(TextFile, OnlyRegularFilesWithinTheLimitAreRead) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.file("a", "twelve bytes"), pipe = folder / "b";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(read_text_file(file, 12, ""), "twelve bytes");
  EXPECT_THROW(read_text_file(file, 11, ""), Error);
  EXPECT_THROW(read_text_file(pipe, 100, ""), Error);
  EXPECT_THROW(read_text_file(folder.path(), 100, ""), Error);
  EXPECT_THROW(read_text_file("/dev/zero", 100, ""), Error);
}

}  // namespace
}  // namespace freshet
