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
    // What it found is told on stdout.
    const bool told = std::string(closed).find(" >&-") == std::string::npos;
    EXPECT_EQ(outcome.exit_code, told ? 0 : 1) << closed << ": " << outcome.err;
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
  const std::vector<std::vector<std::string>> commands{{"store", "digest", sample().store},
                                                       {"store", "info", sample().store, "--json"},
                                                       {"--help"},
                                                       {"synth", "animate", "--help-all"},
                                                       {"--version"}};
  for (const std::vector<std::string>& command : commands)
    for (const char* lost : {"exec > /dev/full", "exec >&-"}) {
      const Outcome outcome = folder.freshet_after(lost, command);
      EXPECT_EQ(outcome.exit_code, 1) << lost << ' ' << command.back() << ": " << outcome.err;
      EXPECT_NE(outcome.err.find("standard output: cannot be written"), std::string::npos) << outcome.err;
    }
}

TEST(ClosedStreams, AStderrThatCannotBeWrittenLosesNoResult) {
  const std::vector<std::string> simulate{"synth",    "simulate", "river", "--size", "96x64",
                                          "--frames", "8",        "-o",    "a.mkv"};
  const std::vector<std::string> animate{"synth",    "animate", sample().store, sample().still, "--whole",
                                         "--frames", "3",       "-o",           "film.mkv",     "--progress",
                                         "json"};
  // The second of them is a pipe that nobody reads any more.
  for (const char* full : {"exec 2> /dev/full", "mkfifo p; sleep 0 < p & exec 2> p; wait; sleep .1"}) {
    const WorkFolder folder;
    EXPECT_EQ(folder.freshet_after(full, {"ingest", "a.store", sample().clips}).exit_code, 0) << full;
    EXPECT_EQ(digest(folder / "a.store"), sample_digest()) << full;
    fs::remove(folder / "p");
    EXPECT_EQ(folder.freshet_after(full, simulate).exit_code, 0) << full;
    EXPECT_TRUE(fs::exists(folder / "a.mkv")) << full;
    fs::remove(folder / "p");
    EXPECT_EQ(folder.freshet_after(full, animate).exit_code, 0) << full;
    EXPECT_TRUE(fs::exists(folder / "film.mkv")) << full;
    fs::remove(folder / "p");
    // A fault is a fault nevertheless.
    EXPECT_EQ(folder.freshet_after(full, {"store", "info", "none.store"}).exit_code, 1) << full;
  }
}

}  // namespace
}  // namespace freshet::tools
