// Ctrl-C: the process dies of the signal, and what it leaves is whole.

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// Waits until the command has said this on stderr.
bool has_said(const Started& started, const std::string& text) {
  for (int i = 0; i < 6000; ++i) {
    if (text_of(started.err).find(text) != std::string::npos) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

TEST(Interrupt, IngestKeepsTheClipsThatAreWholeAndGoesOnLater) {
  const WorkFolder folder;
  const Started started = folder.start({executable(), "ingest", "a.store", sample().clips});
  // The second clip begins when the first is in the store.
  ASSERT_TRUE(has_said(started, "[2/3]"));
  ::kill(started.process, SIGINT);
  const Outcome outcome = WorkFolder::wait(started);
  EXPECT_EQ(outcome.signal, SIGINT) << outcome.exit_code;
  EXPECT_NE(outcome.err.find("freshet: stopped"), std::string::npos) << outcome.err;

  const Outcome info = folder.freshet({"store", "info", "a.store", "--json"});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  const nlohmann::json clips = nlohmann::json::parse(info.out)["clips"];
  EXPECT_GE(clips.size(), 1U);
  EXPECT_LT(clips.size(), 3U);
  EXPECT_EQ(clips[0]["frames"], kFrames);
  EXPECT_EQ(folder.freshet({"store", "verify", "a.store"}).exit_code, 0);

  ASSERT_EQ(folder.freshet({"ingest", "a.store", sample().clips}).exit_code, 0);
  EXPECT_EQ(digest(folder / "a.store"), sample_digest());
}

TEST(Interrupt, BeforeTheFirstClipIsWholeNoStoreIsLeft) {
  const WorkFolder folder;
  const Started started = folder.start({executable(), "ingest", "a.store", sample().clips});
  ASSERT_TRUE(has_said(started, "[1/3]"));
  ::kill(started.process, SIGTERM);
  const Outcome outcome = WorkFolder::wait(started);
  EXPECT_EQ(outcome.signal, SIGTERM) << outcome.exit_code;
  EXPECT_FALSE(fs::exists(folder / "a.store"));
}

TEST(Interrupt, AnAnimationLeavesNoHalfVideo) {
  const WorkFolder folder;
  const Started started = folder.start({executable(), "synth", "animate", sample().store, sample().still,
                                        "--whole", "--frames", "32", "-o", "out.mkv", "-j", "1"});
  ASSERT_TRUE(has_said(started, "reading the clips"));
  ::kill(started.process, SIGINT);
  const Outcome outcome = WorkFolder::wait(started);
  EXPECT_EQ(outcome.signal, SIGINT) << outcome.exit_code;
  EXPECT_EQ(outcome.out, "");
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace freshet::tools
