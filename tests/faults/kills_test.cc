// SIGKILL at random instants: what was committed is there, and nothing else.

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "tests/faults/campaign.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

/// Clips whose commit the command has reported: it says [I/N] when the I-th begins.
std::size_t reported(const std::string& said) {
  std::size_t most = 0;
  for (std::size_t i = 1; i <= 3; ++i)
    if (said.find(std::string("[").append(std::to_string(i)).append("/")) != std::string::npos) most = i;
  return most == 0 ? 0 : most - 1;
}

std::string judge_killed(const Campaign& c, const std::string& store, std::size_t committed) {
  if (!fs::exists(c.folder / store)) return committed == 0 ? "" : "the store is gone";
  const Outcome verify = c.run({"store", "verify", store});
  if (verify.exit_code != 0) return "verify: " + verify.out + verify.err;
  const std::size_t there = c.clips_in(store);
  if (there < committed || there > committed + 1)
    return std::to_string(committed) + " clips were committed, " + std::to_string(there) + " are there";
  return "";
}

TEST(Kills, AnIngestAtAnyInstantLosesAtMostTheClipInHand) {
  const Campaign& c = campaign();
  std::mt19937 random(3);
  const int rounds = at_full_length() ? 10000 : 3;
  const std::vector<std::string> ingest = c.ingest("k.store", {"clip1.mkv", "clip2.mkv", "clip3.mkv"});
  for (int round = 0; round < rounds; ++round) {
    c.begin_with("", "k.store");
    std::vector<std::string> command = ingest;
    command.insert(command.begin(), executable());
    const Started started = c.folder.start(command);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 900000));
    ::kill(started.process, SIGKILL);
    const Outcome outcome = WorkFolder::wait(started);
    const std::size_t committed = outcome.exit_code == 0 ? 3 : reported(outcome.err);
    ASSERT_EQ(judge_killed(c, "k.store", committed), "") << "round " << round;
    ASSERT_EQ(c.run(ingest).exit_code, 0);
    ASSERT_EQ(c.judge("k.store", {c.all}), "") << "round " << round;
  }
}

TEST(Kills, AnIndexAtAnyInstantLeavesTheClips) {
  const Campaign& c = campaign();
  std::mt19937 random(5);
  const int rounds = at_full_length() ? 2000 : 2;
  for (int round = 0; round < rounds; ++round) {
    c.begin_with("all.store", "k.store");
    const Started started = c.folder.start({executable(), "index", "k.store"});
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 600000));
    ::kill(started.process, SIGKILL);
    WorkFolder::wait(started);
    ASSERT_EQ(c.judge("k.store", {c.all, c.indexed}), "") << "round " << round;
    ASSERT_EQ(c.run({"index", "k.store"}).exit_code, 0);
    ASSERT_EQ(c.judge("k.store", {c.indexed}), "") << "round " << round;
  }
}

TEST(Kills, ARewriteAtAnyInstantIsDoneOrNot) {
  const Campaign& c = campaign();
  std::mt19937 random(9);
  const int rounds = at_full_length() ? 500 : 1;
  for (const Job& job : rewrites()) {
    c.begin_with(job.begins_with, "f.store");
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(c.run(job.arguments).exit_code, 0) << job.name;
    const std::chrono::microseconds took =
        std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
    for (int round = 0; round < rounds; ++round) {
      c.begin_with(job.begins_with, "f.store");
      std::vector<std::string> command = job.arguments;
      command.insert(command.begin(), executable());
      const Started started = c.folder.start(command);
      std::this_thread::sleep_for(
          std::chrono::microseconds(random() % static_cast<std::uint32_t>(took.count() + 1000)));
      ::kill(started.process, SIGKILL);
      WorkFolder::wait(started);
      ASSERT_EQ(c.judge("f.store", {job.before, job.after}), "") << job.name << ", round " << round;
      ASSERT_EQ(judge_again(c, job), "") << job.name << ", round " << round;
    }
  }
}

TEST(Kills, ALostClipThatIsPlantedIsSeen) {
  const Campaign& c = campaign();
  c.begin_with("one.store", "k.store");
  EXPECT_EQ(judge_killed(c, "k.store", 1), "");
  EXPECT_NE(judge_killed(c, "k.store", 2), "");
  EXPECT_NE(judge_killed(c, "none.store", 1), "");
  EXPECT_NE(c.judge("k.store", {c.all}), "");
}

}  // namespace
}  // namespace freshet::tools
