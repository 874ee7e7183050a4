#include "studio/beneath.h"

#include <sys/stat.h>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/harness/fault.h"
#include "tests/tools/work_folder.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;

TEST(Beneath, ReadsAndWritesInTheFolder) {
  const tools::WorkFolder folder;
  write_beneath(folder.path(), "a/b/c.txt", "one");
  write_beneath(folder.path(), "a/b/c.txt", "two");
  EXPECT_EQ(read_beneath(folder.path(), "a/b/c.txt", 3), "two");
  EXPECT_THROW(read_beneath(folder.path(), "a/b/c.txt", 2), Error);
  const std::shared_ptr<const OpenFile> file = open_beneath(folder.path(), "a/b/c.txt");
  char bytes[8];
  EXPECT_EQ(file->bytes(), 3u);
  EXPECT_EQ(std::string(bytes, file->read(bytes, 8, 1)), "wo");
  EXPECT_THROW(open_beneath(folder.path(), "a/b"), Error);
  EXPECT_THROW(open_beneath(folder.path(), "a/b/d.txt"), Error);
  EXPECT_NO_THROW(expect_no_links(folder.path()));
}

TEST(Beneath, FollowsNothingOut) {
  const tools::WorkFolder outside, folder;
  outside.file("secret", "secret");
  fs::create_directories(folder / "ways");
  fs::create_directory_symlink(outside.path(), folder / "ways/design");
  fs::create_symlink(outside / "secret", folder / "ways/link");
  fs::create_symlink(outside / "secret", folder / "ways/new.new");
  ::mkfifo((folder / "ways/pipe").c_str(), 0600);
  const std::string up = "../" + outside.path().filename().string() + "/secret";
  for (const std::string& within :
       {std::string("ways/design/secret"), std::string("ways/link"), up, "ways/" + std::string("../") + up,
        (outside / "secret").string(), std::string("ways/pipe")})
    EXPECT_THROW(open_beneath(folder.path(), within), Error) << within;
  for (const char* within : {"ways/design/secret", "ways/design/motion/secret", "ways/new"})
    EXPECT_THROW(write_beneath(folder.path(), within, "spoilt"), Error) << within;
  EXPECT_THROW(write_beneath(folder.path(), up, "spoilt"), Error);
  write_beneath(folder.path(), "ways/link", "ours");  // in place of the link
  EXPECT_EQ(tools::text_of(outside / "secret"), "secret");
  EXPECT_EQ(tools::text_of(folder / "ways/link"), "ours");
}

TEST(Beneath, FindsALinkHoweverDeep) {
  const tools::WorkFolder folder;
  fs::create_directories(folder / "ways/flowlines/clips");
  EXPECT_NO_THROW(expect_no_links(folder.path()));
  fs::create_symlink("nowhere", folder / "ways/flowlines/clips/leak.mp4");
  const std::string fault = fault_of([&] { expect_no_links(folder.path()); });
  EXPECT_NE(fault.find("clips/leak.mp4"), std::string::npos) << fault;
}

}  // namespace
}  // namespace freshet::studio
