#include "platform/whole_file.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

namespace freshet {
namespace {

namespace fs = std::filesystem;

class WholeFile : public testing::Test {
 protected:
  fs::path at(const std::string& name) const { return folder_ / name; }

 private:
  ScratchFolder folder_;
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
  const std::string fault = fault_of(ErrorKind::kIo, [&] { write_whole_file(at("none") / "a", "one"); });
  EXPECT_NE(fault.find("none"), std::string::npos);
}

}  // namespace
}  // namespace freshet
