// Standard streams that are closed: what is meant for them must never land in a file of ours.

#include <gtest/gtest.h>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

TEST(ClosedStreams, MessagesAreNotWrittenOverTheStore) {
  for (const char* closed : {"exec 2>&-", "exec >&-", "exec 0<&- >&- 2>&-"}) {
    const WorkFolder folder;
    const Outcome outcome = folder.freshet_after(closed, {"ingest", "a.store", sample().clips});
    EXPECT_EQ(outcome.exit_code, 0) << closed << ": " << outcome.err;
    EXPECT_EQ(digest(folder / "a.store"), sample_digest()) << closed;
    EXPECT_EQ(folder.freshet({"store", "verify", "a.store"}).exit_code, 0) << closed;
  }
}

TEST(ClosedStreams, MessagesAreNotWrittenIntoAVideo) {
  const WorkFolder folder;
  const std::vector<std::string> simulate{"synth",    "simulate", "river", "--size", "96x64",
                                          "--frames", "8",        "-o",    "a.mkv"};
  ASSERT_EQ(folder.freshet(simulate).exit_code, 0);
  const std::string whole = text_of(folder / "a.mkv");
  fs::remove(folder / "a.mkv");
  ASSERT_EQ(folder.freshet_after("exec 2>&-", simulate).exit_code, 0);
  EXPECT_TRUE(text_of(folder / "a.mkv") == whole);
}

TEST(ClosedStreams, AResultThatCannotBeWrittenIsNoSuccess) {
  const WorkFolder folder;
  const Outcome outcome = folder.freshet_after("exec > /dev/full", {"store", "digest", sample().store});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("standard output: cannot be written"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace freshet::tools
