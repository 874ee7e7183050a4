#include "studio/studio_folder.h"

#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/tools/work_folder.h"

namespace freshet::studio {
namespace {

/// `freshet studio` that ends at once where the folder is taken.
tools::Outcome second(const tools::WorkFolder& folder) {
  return folder.freshet({"studio", "--no-browser", "--no-starter", "--folder", "room", "--page", "page"});
}

TEST(StudioFolder, IsOneServersAlone) {
  const tools::WorkFolder folder;
  folder.file("page", "");  // not reached: the folder is taken first
  {
    const StudioFolder ours(folder / "room");
    const tools::Outcome outcome = second(folder);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("process " + std::to_string(::getpid())), std::string::npos) << outcome.err;
  }
  const tools::Outcome outcome = second(folder);  // it is free again: the next fault is the page's
  EXPECT_EQ(outcome.err.find("another studio"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("page"), std::string::npos) << outcome.err;
}

TEST(StudioFolder, RemovesWhatWasSent) {
  const tools::WorkFolder folder;
  StudioFolder ours(folder / "room");
  std::filesystem::path path;
  {
    const IncomingFile file = ours.incoming_file();
    path = file.path();
    folder.file("room/incoming/" + path.filename().string(), "sent");
    EXPECT_TRUE(std::filesystem::exists(path));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace freshet::studio
