#include "platform/whole_file.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace freshet {
namespace {

namespace fs = std::filesystem;

class WholeFile : public testing::Test {
 protected:
  WholeFile() { fs::create_directories(folder_); }
  ~WholeFile() override { fs::remove_all(folder_); }
  fs::path at(const std::string& name) const { return folder_ / name; }

 private:
  fs::path folder_ =
      fs::temp_directory_path() /
      ("freshet_whole_file_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(WholeFile, IsWhatWasWritten) {
  write_whole_file(at("a"), "longer than what comes");
  write_whole_file(at("a"), std::string("one\0two", 7));
  EXPECT_EQ(fs::file_size(at("a")), 7u);
  write_whole_file(at("b"), std::string("one\0two", 7));
  EXPECT_TRUE(same_bytes(at("a"), at("b")));
}

TEST_F(WholeFile, AnotherByteAnotherLengthAndWhatCannotBeReadAreNotTheSame) {
  write_whole_file(at("a"), "one");
  write_whole_file(at("b"), "two");
  write_whole_file(at("c"), "ones");
  EXPECT_FALSE(same_bytes(at("a"), at("b")));
  EXPECT_FALSE(same_bytes(at("a"), at("c")));
  EXPECT_FALSE(same_bytes(at("a"), at("nothing")));
  EXPECT_FALSE(same_bytes(at("nothing"), at("nothing")));
  fs::create_directory(at("folder"));
  EXPECT_FALSE(same_bytes(at("folder"), at("folder")));
}

TEST_F(WholeFile, AFolderThatIsNotThereIsNamed) {
  try {
    write_whole_file(at("none") / "a", "one");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_NE(std::string(error.what()).find("none"), std::string::npos);
  }
}

}  // namespace
}  // namespace freshet
