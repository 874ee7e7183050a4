// SIGKILL at random instants: what was committed is there, and nothing else.

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <iostream>
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

/// Starts f.store's or k.store's command and kills it at an instant of a time as long as an undisturbed run of it
/// takes.
class Killer {
 public:
  Killer(const Campaign& c, const std::vector<std::string>& arguments) : c_(c), arguments_(arguments) {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(c.run(arguments).exit_code, 0);
    took_ = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
  }
  Outcome run(std::mt19937& random) {
    const Started started = c_.folder.start_freshet(arguments_);
    std::this_thread::sleep_for(
        std::chrono::microseconds(random() % static_cast<std::uint32_t>(took_.count() + 1000)));
    ::kill(started.process, SIGKILL);
    Outcome outcome = WorkFolder::wait(started);
    killed_ += outcome.signal == SIGKILL ? 1 : 0;
    return outcome;
  }
  int killed() const { return killed_; }

 private:
  const Campaign& c_;
  std::vector<std::string> arguments_;
  std::chrono::microseconds took_{};
  int killed_ = 0;
};

TEST(Kills, AnIngestAtAnyInstantLosesAtMostTheClipInHand) {
  const Campaign& c = campaign();
  const std::vector<std::string> ingest = c.ingest("k.store", {"clip1.mkv", "clip2.mkv", "clip3.mkv"});
  c.begin_with("", "k.store");
  Killer killer(c, ingest);
  walk_rounds("ingests", at_full_length() ? 6000 : 3, [&](std::size_t, std::mt19937& random) {
    c.begin_with("", "k.store");
    const Outcome outcome = killer.run(random);
    const std::size_t committed = outcome.exit_code == 0 ? 3 : reported(outcome.err);
    ASSERT_EQ(judge_killed(c, "k.store", committed), "");
    ASSERT_EQ(c.run(ingest).exit_code, 0);
    ASSERT_EQ(c.judge("k.store", {c.all}), "");
  });
  std::cout << killer.killed() << " killed\n";
}

TEST(Kills, AnIndexAtAnyInstantLeavesTheClips) {
  const Campaign& c = campaign();
  c.begin_with("all.store", "k.store");
  Killer killer(c, {"index", "k.store"});
  walk_rounds("indexes", at_full_length() ? 2000 : 2, [&](std::size_t, std::mt19937& random) {
    c.begin_with("all.store", "k.store");
    killer.run(random);
    ASSERT_EQ(c.judge("k.store", {c.all, c.indexed}), "");
    ASSERT_EQ(c.run({"index", "k.store"}).exit_code, 0);
    ASSERT_EQ(c.judge("k.store", {c.indexed}), "");
  });
  std::cout << killer.killed() << " killed\n";
}

TEST(Kills, ARewriteAtAnyInstantIsDoneOrNot) {
  const Campaign& c = campaign();
  struct Kind {
    Job job;
    Killer killer;
  };
  std::vector<Kind> kinds;
  for (const Job& job : rewrites()) {
    c.begin_with(job.begins_with, "f.store");
    kinds.push_back({job, Killer(c, job.arguments)});
  }
  walk_rounds("rewrites", at_full_length() ? 2000 : kinds.size(),
              [&](std::size_t round, std::mt19937& random) {
                auto& [job, killer] = kinds[round % kinds.size()];
                c.begin_with(job.begins_with, "f.store");
                killer.run(random);
                ASSERT_EQ(c.judge("f.store", {job.before, job.after}), "") << job.name;
                ASSERT_EQ(judge_again(c, job), "") << job.name;
              });
  for (const Kind& kind : kinds) std::cout << kind.job.name << ": " << kind.killer.killed() << " killed\n";
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
