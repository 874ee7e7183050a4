// One system call fails, takes half, or is the last: the store is as before or as after, and the message says why.

#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "tests/faults/campaign.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

Outcome run_with_fault(const Campaign& c, const Job& run, const std::string& fault) {
  std::vector<std::string> command{"timeout",
                                   "-s",
                                   "KILL",
                                   "120",
                                   "env",
                                   "LD_PRELOAD=" FRESHET_FAILING_CALLS,
                                   "FRESHET_FAULT=" + fault,
                                   "FRESHET_FAULT_FILES=f.store",
                                   "FRESHET_FAULT_COUNT=" + (c.folder / "count").string(),
                                   executable()};
  command.insert(command.end(), run.arguments.begin(), run.arguments.end());
  return c.folder.run(command);
}

/// The number of calls of an undisturbed run.
long calls_of(const Campaign& c, const Job& run) {
  c.begin_with(run.begins_with, "f.store");
  EXPECT_EQ(run_with_fault(c, run, "none:0").exit_code, 0);
  return std::stol(text_of(c.folder / "count"));
}

/// What is wrong after a run with a fault; empty when all is as it should be.
std::string judge_fault(const Campaign& c, const Job& run, const std::string& fault) {
  c.begin_with(run.begins_with, "f.store");
  const Outcome outcome = run_with_fault(c, run, fault);
  const bool killed = fault.starts_with("kill");
  std::set<std::string> states{run.before, run.after};
  if (outcome.exit_code == 0) {
    states = {run.after};
  } else if (killed) {
    if (outcome.exit_code != 137 && outcome.signal == 0) return "it was not killed";
  } else {
    if (outcome.signal != 0 || outcome.exit_code > 3 || outcome.exit_code < 0)
      return "it died, " + std::to_string(outcome.exit_code) + ": " + outcome.err;
    if (outcome.err.find("f.store") == std::string::npos ||
        outcome.err.find("unexpected") != std::string::npos)
      return "its message is not clear: " + outcome.err;
  }
  if (!run.in_steps || outcome.exit_code == 0) {
    if (const std::string wrong = c.judge("f.store", states); !wrong.empty()) return wrong;
  } else if (fs::exists(c.folder / "f.store")) {
    const Outcome verify = c.run({"store", "verify", "f.store"});
    if (verify.exit_code != 0) return "verify: " + verify.out + verify.err;
  } else if (!run.before.empty()) {
    return "the store is gone";
  }
  return judge_again(c, run);
}

TEST(FailingCalls, LeaveTheStoreAsItWasAndSayWhy) {
  const Campaign& c = campaign();
  std::mt19937 random(7);
  const std::vector<std::string> kinds{"enospc", "full", "eio", "eintr", "short", "kill"};
  for (const Job& run : jobs()) {
    const long calls = calls_of(c, run);
    ASSERT_GT(calls, 5) << run.name;
    std::cout << run.name << ": " << calls << " calls\n";
    std::set<std::pair<std::string, long>> faults;
    if (at_full_length()) {
      for (const std::string& kind : kinds)
        for (long n = 1; n <= calls; ++n) faults.insert({kind, n});
    } else {
      // Anywhere, or in the commit.
      const auto somewhere = [&] {
        return random() % 2 == 0 ? 1 + static_cast<long>(random() % calls)
                                 : calls - static_cast<long>(random() % 3);
      };
      for (int i = 0; i < (run.begins_with.empty() && run.in_steps ? 6 : 2); ++i)
        faults.insert({"kill", 1 + static_cast<long>(random() % calls)});
      for (int i = 0; i < 2; ++i) faults.insert({kinds[random() % 5], somewhere()});
    }
    for (const auto& [kind, n] : faults) {
      const std::string fault = kind + ":" + std::to_string(n);
      EXPECT_EQ(judge_fault(c, run, fault), "") << run.name << ", " << fault;
    }
  }
}

TEST(FailingCalls, AWriteThatIsLostIsSeen) {
  const Campaign& c = campaign();
  const Job run = jobs()[1];
  const long calls = calls_of(c, run);
  int seen = 0;
  for (long n = calls - 3; n <= calls; ++n)
    seen += judge_fault(c, run, "lost:" + std::to_string(n)).empty() ? 0 : 1;
  EXPECT_GE(seen, 1) << "of " << calls;
}

}  // namespace
}  // namespace freshet::tools
