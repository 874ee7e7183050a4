// One system call or allocation fails, takes half, or is the last: the store is as before or as after, and the message
// says why.

#include <gtest/gtest.h>

#include <csignal>
#include <iostream>
#include <random>

#include "tests/faults/campaign.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

/// more   of the environment.
Outcome run_with_fault(const Campaign& c, const Job& run, const std::string& fault,
                       const std::vector<std::string>& more = {"FRESHET_FAULT_FILES=f.store"}) {
  std::vector<std::string> environment{"FRESHET_FAULT=" + fault,
                                       "FRESHET_FAULT_COUNT=" + (c.folder / "count").string()};
  environment.insert(environment.end(), more.begin(), more.end());
  return c.run_failing(run.arguments, environment);
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
    if (outcome.signal != SIGKILL) return "it was not killed";
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
  std::vector<std::pair<Job, std::string>> cases;
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
    for (const auto& [kind, n] : faults) cases.emplace_back(run, kind + ":" + std::to_string(n));
  }
  walk("failing calls", cases, [&](const auto& tried) {
    EXPECT_EQ(judge_fault(c, tried.first, tried.second), "") << tried.first.name << ", " << tried.second;
  });
}

/// Commands that only read the store.
std::vector<Job> readings() {
  const Campaign& c = campaign();
  std::vector<Job> all;
  for (const char* what : {"verify", "digest", "info"})
    all.push_back({.name = what,
                   .begins_with = "indexed.store",
                   .arguments = {"store", what, "f.store"},
                   .before = c.indexed,
                   .after = c.indexed});
  return all;
}

/// KIND:N for each kind: at full length each of n calls, or 500 of them; else `some` at random.
std::vector<std::string> faults_of(const std::vector<std::string>& kinds, long n, int some,
                                   std::mt19937& random) {
  const auto any = [&] { return 1 + static_cast<long>(random() % static_cast<unsigned long>(n)); };
  std::vector<std::string> faults;
  for (int i = 0; i < some && !at_full_length(); ++i)
    faults.push_back(kinds[random() % kinds.size()] + ":" + std::to_string(any()));
  for (const std::string& kind : kinds)
    for (long i = 1; i <= std::min(n, 500L) && at_full_length(); ++i)
      faults.push_back(kind + ":" + std::to_string(n <= 500 ? i : any()));
  return faults;
}

/// What is wrong after a read of `files` failed; empty when nothing is.
std::string judge_read_fault(const Campaign& c, const Job& job, const std::string& files,
                             const std::string& fault, const Outcome& undisturbed) {
  c.begin_with(job.begins_with, "f.store");
  const Outcome outcome =
      run_with_fault(c, job, fault, {"FRESHET_FAULT_FILES=" + files, "FRESHET_FAULT_READS=1"});
  // A clip that could not be read is said to have failed, and the others are taken.
  const bool without = files == "clip" && job.in_steps && outcome.err.find(" failed: ") != std::string::npos;
  if (outcome.signal != 0 || outcome.exit_code < 0 ||
      outcome.exit_code > 1)  // nothing is damaged, which 3 would say
    return "it ended with " + std::to_string(outcome.exit_code) + ": " + outcome.err;
  if (outcome.exit_code == 0) {
    if (job.arguments[1] == "digest" && outcome.out != undisturbed.out) return "another digest";
    if (without) {
      const Outcome verify = c.run({"store", "verify", "f.store"});
      if (verify.exit_code != 0) return "verify: " + verify.out + verify.err;
    } else if (const std::string wrong = c.judge("f.store", {job.after}); !wrong.empty())
      return wrong;
  } else if ((outcome.err + outcome.out).find(files) == std::string::npos ||
             outcome.err.find("unexpected") != std::string::npos) {
    return "its message is not clear: " + outcome.err;
  }
  return judge_again(c, job);
}

TEST(FailingReads, AreAnErrorAndNeverAnotherStore) {
  const Campaign& c = campaign();
  std::mt19937 random(19);
  std::vector<Job> all = readings();
  for (const Job& job : jobs()) all.push_back(job);
  struct Case {
    Job job;
    std::string files, fault;
    Outcome undisturbed;
  };
  std::vector<Case> cases;
  for (const Job& job : all)
    for (const std::string files : {"f.store", "clip"}) {
      if (files == "clip" && job.arguments.front() != "ingest") continue;
      c.begin_with(job.begins_with, "f.store");
      const Outcome undisturbed =
          run_with_fault(c, job, "none:0", {"FRESHET_FAULT_FILES=" + files, "FRESHET_FAULT_READS=1"});
      ASSERT_EQ(undisturbed.exit_code, 0) << undisturbed.err;
      const long reads = std::stol(text_of(c.folder / "count"));
      if (reads == 0) continue;
      for (const std::string& fault : faults_of({"eio", "eintr", "short"}, reads, 1, random))
        cases.push_back({job, files, fault, undisturbed});
    }
  walk("failing reads", cases, [&](const Case& tried) {
    EXPECT_EQ(judge_read_fault(c, tried.job, tried.files, tried.fault, tried.undisturbed), "")
        << tried.job.name << ", " << tried.files << ", " << tried.fault;
  });
}

TEST(FailingReads, OfAClipAreNeverItsEnd) {
  const Campaign& c = campaign();
  const Job job = jobs()[0];
  const std::vector<std::string> of_clips{"FRESHET_FAULT_FILES=clip", "FRESHET_FAULT_READS=1"};
  c.begin_with(job.begins_with, "f.store");
  const Outcome undisturbed = run_with_fault(c, job, "none:0", of_clips);
  const long reads = std::stol(text_of(c.folder / "count"));
  ASSERT_GT(reads, 1);
  for (long n = 1; n <= reads; n += 1 + reads / 12)
    EXPECT_EQ(judge_read_fault(c, job, "clip", "eio:" + std::to_string(n), undisturbed), "")
        << n << " of " << reads;
}

TEST(FailingReads, OfTheStoreAreNoDamage) {
  const Campaign& c = campaign();
  const Job verify = readings()[0];
  c.begin_with(verify.begins_with, "f.store");
  const Outcome undisturbed =
      run_with_fault(c, verify, "none:0", {"FRESHET_FAULT_FILES=f.store", "FRESHET_FAULT_READS=1"});
  const long reads = std::stol(text_of(c.folder / "count"));
  ASSERT_GT(reads, 12);
  for (long n = reads - 8; n <= reads; n += 4)
    EXPECT_EQ(judge_read_fault(c, verify, "f.store", "eio:" + std::to_string(n), undisturbed), "")
        << n << " of " << reads;
}

TEST(FailingReads, APageThatCannotBeReadIsAnError) {
  const Campaign& c = campaign();
  for (const Job& job : readings()) {
    const long calls = calls_of(c, job);
    int seen = 0;
    for (long n = 1; n <= calls; ++n) {  // of which one maps the store
      c.begin_with("indexed.store", "f.store");
      const Outcome outcome = run_with_fault(c, job, "cut:" + std::to_string(n));
      const std::string what = job.name + ", call " + std::to_string(n) + ": " + outcome.err;
      EXPECT_EQ(outcome.signal, 0) << what;
      EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 1) << what;
      seen += outcome.err.find("f.store: a part of it could not be read") != std::string::npos ? 1 : 0;
    }
    if (job.name != "info") {  // which needs little of the file
      EXPECT_GE(seen, 1) << job.name << ", of " << calls;
    }
  }
}

/// The C library ends the process where it cannot write down what a thread is to destroy at its end.
bool ended_by_c_library(const Outcome& outcome) {
  return outcome.signal == SIGABRT &&
         outcome.err.find("failed to register TLS destructor") != std::string::npos;
}

// Eigen's matrices free before they allocate, and what is resized in vain is freed again by its destructor.
TEST(FailingAllocations, OfAnIndexFreeNothingTwice) {
  const Campaign& c = campaign();
  const Job index = jobs()[2];
  c.begin_with(index.begins_with, "f.store");
  ASSERT_EQ(run_with_fault(c, index, "alloc:0").exit_code, 0);
  const long allocations = std::stol(text_of(c.folder / "count"));
  for (long n = allocations / 2; n <= allocations; n += 1 + allocations / 60) {
    c.begin_with(index.begins_with, "f.store");
    const Outcome outcome = run_with_fault(c, index, "allocs:" + std::to_string(n));
    EXPECT_TRUE(outcome.exit_code == 1 || ended_by_c_library(outcome)) << n << ": " << outcome.err;
  }
}

TEST(FailingAllocations, EndInAnErrorAndLeaveTheStore) {
  const Campaign& c = campaign();
  std::mt19937 random(23);
  std::vector<Job> all = readings();
  for (const Job& job : jobs()) all.push_back(job);
  int refused = 0, without_a_clip = 0, by_c_library = 0;
  std::vector<std::pair<Job, std::string>> cases;
  for (const Job& job : all) {
    c.begin_with(job.begins_with, "f.store");
    ASSERT_EQ(run_with_fault(c, job, "alloc:0").exit_code, 0);
    const long allocations = std::stol(text_of(c.folder / "count"));
    ASSERT_GT(allocations, 100) << job.name;
    for (const std::string& fault : faults_of({"alloc", "allocs"}, allocations, 1, random))
      cases.emplace_back(job, fault);
  }
  walk("failing allocations", cases, [&](const auto& tried) {
    const auto& [job, fault] = tried;
    c.begin_with(job.begins_with, "f.store");
    const Outcome outcome = run_with_fault(c, job, fault);
    const std::string what = job.name + ", " + fault + ": " + outcome.err;
    const bool ended = ended_by_c_library(outcome);
    EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 1 || ended) << outcome.signal << ", " << what;
    by_c_library += ended ? 1 : 0;
    // A clip for which there was no memory is said to have failed, and the others are taken.
    const bool without = job.in_steps && outcome.err.find(" failed: ") != std::string::npos;
    refused += outcome.exit_code == 1 && !without ? 1 : 0;
    without_a_clip += without ? 1 : 0;
    if (outcome.exit_code == 0 && !without) {
      EXPECT_EQ(c.judge("f.store", {job.after}), "") << what;
    }
    if (without && fs::exists(c.folder / "f.store")) {
      EXPECT_EQ(c.run({"store", "verify", "f.store"}).exit_code, 0) << what;
    }
    EXPECT_EQ(judge_again(c, job), "") << what;
  });
  std::cout << refused << " runs ended in an error, " << without_a_clip << " without a clip, " << by_c_library
            << " by the C library\n";
  EXPECT_GT(refused, 0);
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
