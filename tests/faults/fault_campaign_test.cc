// Kills, failing calls and damages, against the executable: what a store answers afterwards is right, or there is
// no answer. Each campaign's own eyes are tested with a fault that is planted.

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <thread>

#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

bool at_full_length() { return std::getenv("FRESHET_LONG") != nullptr; }

/// Three small clips, and the stores that undisturbed runs make of them.
struct Campaign {
  WorkFolder folder;
  std::string one, all, indexed;  // digests: of the first clip, of all, and with an index

  Campaign() {
    for (int i = 1; i <= 3; ++i) {
      const std::string number = std::to_string(i);
      must({"synth", "simulate", "river", "--size", "96x96", "--frames", "16", "--seed", number, "-o",
            "clip" + number + ".mkv"});
    }
    must(ingest("one.store", {"clip1.mkv"}));
    fs::copy_file(folder / "one.store", folder / "all.store");
    must(ingest("all.store", {"clip2.mkv", "clip3.mkv"}));
    fs::copy_file(folder / "all.store", folder / "indexed.store");
    must({"index", "indexed.store"});
    one = digest(folder / "one.store");
    all = digest(folder / "all.store");
    indexed = digest(folder / "indexed.store");
  }
  void must(const std::vector<std::string>& arguments) const {
    const Outcome outcome = folder.freshet(arguments);
    if (outcome.exit_code != 0)
      throw std::runtime_error("the campaign's stores cannot be made: " + outcome.err);
  }
  static std::vector<std::string> ingest(const std::string& store, const std::vector<std::string>& clips) {
    std::vector<std::string> arguments{"ingest", store, "--no-index", "--force"};
    arguments.insert(arguments.end(), clips.begin(), clips.end());
    return arguments;
  }
  /// A store of the campaign under a new name, or none.
  void begin_with(const std::string& store, const std::string& name) const {
    for (const char* ending : {"", "-lock", ".making", ".making-lock"}) fs::remove(folder / (name + ending));
    if (!store.empty()) fs::copy_file(folder / store, folder / name);
  }
  /// Empty when the store is whole and has one of these digests (an empty digest: it need not be there); else
  /// what is wrong.
  std::string judge(const std::string& store, const std::set<std::string>& digests) const {
    if (!fs::exists(folder / store)) return digests.contains("") ? "" : "the store is gone";
    const Outcome verify = run({"store", "verify", store}), hash = run({"store", "digest", store});
    if (verify.exit_code != 0) return "verify: " + verify.out + verify.err;
    if (hash.exit_code != 0) return "digest: " + hash.err;
    if (!digests.contains(hash.out)) return "it is another store";
    return "";
  }
  /// Killed when it hangs.
  Outcome run(const std::vector<std::string>& arguments) const {
    std::vector<std::string> command{"timeout", "-s", "KILL", "120", executable()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return folder.run(command);
  }
  std::size_t clips_in(const std::string& store) const {
    const Outcome info = run({"store", "info", store, "--json"});
    if (info.exit_code != 0) return 0;
    const nlohmann::json json = nlohmann::json::parse(info.out);
    return json.contains("clips") ? json["clips"].size() : 0;
  }
};

const Campaign& campaign() {
  static const Campaign made;
  return made;
}

// ---- Kills

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
  const int rounds = at_full_length() ? 10000 : 6;
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
  const int rounds = at_full_length() ? 2000 : 3;
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

TEST(Kills, ALostClipThatIsPlantedIsSeen) {
  const Campaign& c = campaign();
  c.begin_with("one.store", "k.store");
  EXPECT_EQ(judge_killed(c, "k.store", 1), "");
  EXPECT_NE(judge_killed(c, "k.store", 2), "");
  EXPECT_NE(judge_killed(c, "none.store", 1), "");
  EXPECT_NE(c.judge("k.store", {c.all}), "");
}

// ---- Failing calls

struct Job {
  std::string name;
  std::string begins_with;  // a store of the campaign
  std::vector<std::string> arguments;
  std::string before, after;  // digests
};

std::vector<Job> runs() {
  const Campaign& c = campaign();
  return {{"ingest into a new store", "", c.ingest("f.store", {"clip1.mkv"}), "", c.one},
          {"ingest into a store", "one.store", c.ingest("f.store", {"clip2.mkv", "clip3.mkv"}), c.one, c.all},
          {"index", "all.store", {"index", "f.store"}, c.all, c.indexed}};
}

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
  // A clip of several may have been committed before.
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
  if (run.arguments.size() > 5 || run.before.empty()) {  // states between are possible
    if (fs::exists(c.folder / "f.store")) {
      const Outcome verify = c.run({"store", "verify", "f.store"});
      if (verify.exit_code != 0) return "verify: " + verify.out + verify.err;
    } else if (!run.before.empty() || outcome.exit_code == 0) {
      return "the store is gone";
    }
    if (outcome.exit_code == 0)
      if (const std::string wrong = c.judge("f.store", states); !wrong.empty()) return wrong;
  } else if (const std::string wrong = c.judge("f.store", states); !wrong.empty()) {
    return wrong;
  }
  const Outcome again = c.run(run.arguments);
  if (again.exit_code != 0) return "run again: " + again.err;
  return c.judge("f.store", {run.after});
}

TEST(FailingCalls, LeaveTheStoreAsItWasAndSayWhy) {
  const Campaign& c = campaign();
  std::mt19937 random(7);
  const std::vector<std::string> kinds{"enospc", "full", "eio", "eintr", "short", "kill"};
  for (const Job& run : runs()) {
    const long calls = calls_of(c, run);
    ASSERT_GT(calls, 5) << run.name;
    std::cout << run.name << ": " << calls << " calls\n";
    std::set<std::pair<std::string, long>> faults;
    if (at_full_length()) {
      for (const std::string& kind : kinds)
        for (long n = 1; n <= calls; ++n) faults.insert({kind, n});
    } else {
      for (long n = 1; run.begins_with.empty() && n <= calls; ++n) faults.insert({"kill", n});
      for (const std::string& kind : kinds) {
        // Anywhere, or in the commit.
        faults.insert({kind, random() % 2 == 0 ? 1 + static_cast<long>(random() % calls)
                                               : calls - static_cast<long>(random() % 3)});
      }
    }
    for (const auto& [kind, n] : faults) {
      const std::string fault = kind + ":" + std::to_string(n);
      EXPECT_EQ(judge_fault(c, run, fault), "") << run.name << ", " << fault;
    }
  }
}

TEST(FailingCalls, AWriteThatIsLostIsSeen) {
  const Campaign& c = campaign();
  const Job run = runs()[1];
  const long calls = calls_of(c, run);
  int seen = 0;
  for (long n = calls - 3; n <= calls; ++n)
    seen += judge_fault(c, run, "lost:" + std::to_string(n)).empty() ? 0 : 1;
  EXPECT_GE(seen, 1) << "of " << calls;
}

// ---- Damages

/// What is wrong with the answers that a damaged store gives; empty when each is right, or says that it is damaged.
std::string judge_damage(const Campaign& c, const std::string& store, const std::string& digest,
                         const std::string& info) {
  const Outcome verify = c.run({"store", "verify", store}), hash = c.run({"store", "digest", store}),
                shown = c.run({"store", "info", store});
  for (const Outcome* outcome : {&verify, &hash, &shown}) {
    if (outcome->signal != 0 || outcome->exit_code < 0 || outcome->exit_code > 3)
      return "it died, " + std::to_string(outcome->exit_code) + ": " + outcome->err;
    if (outcome->exit_code != 0 && outcome->err.find(store) == std::string::npos)
      return "its message names no file: " + outcome->err;
    if (outcome->err.find("unexpected") != std::string::npos) return outcome->err;
  }
  if (hash.exit_code == 0 && hash.out != digest) return "another digest, as if all were well";
  if (shown.exit_code == 0 && shown.out != info) return "other numbers, as if all were well";
  if (verify.exit_code == 0 && hash.exit_code != 0) return "verify is content, digest is not: " + hash.err;
  return "";
}

std::string damaged(std::mt19937& random, const std::string& whole, std::string& what) {
  std::string bytes = whole;
  const std::size_t pages = whole.size() / 4096;
  const std::size_t page = random() % pages, other = random() % pages;
  switch (random() % 6) {
    case 0:
    case 1: {
      // Half of all flips among the pages of keys: they are few.
      std::size_t at = random() % bytes.size();
      for (int i = 0; i < 2000 && random() % 2 == 0; ++i)
        if (at = random() % bytes.size();
            bytes[at / 4096 * 4096 + 10] == 2 && bytes[at / 4096 * 4096 + 11] == 0)
          break;
      const int bit = static_cast<int>(random() % 8);
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
      what = "bit " + std::to_string(bit) + " of byte " + std::to_string(at);
      break;
    }
    case 2:
      bytes.replace(page * 4096, 4096, 4096, '\0');
      what = "page " + std::to_string(page) + " zeroed";
      break;
    case 3:
      bytes.replace(page * 4096, 4096, whole, other * 4096, 4096);
      bytes.replace(other * 4096, 4096, whole, page * 4096, 4096);
      what = "pages " + std::to_string(page) + " and " + std::to_string(other) + " swapped";
      break;
    case 4:
      bytes.replace(page * 4096, 4096, whole, other * 4096, 4096);
      what = "page " + std::to_string(other) + " repeated as " + std::to_string(page);
      break;
    default:
      bytes.resize(random() % bytes.size());
      what = "cut to " + std::to_string(bytes.size());
  }
  return bytes;
}

TEST(Damages, AreHarmlessOrReported) {
  const Campaign& c = campaign();
  std::mt19937 random(11);
  const std::string whole = text_of(c.folder / "indexed.store");
  c.begin_with("indexed.store", "d.store");
  const Outcome info = c.run({"store", "info", "d.store"});
  ASSERT_EQ(info.exit_code, 0);
  const int rounds = at_full_length() ? 10000 : 24;
  int harmless = 0;
  for (int round = 0; round < rounds; ++round) {
    std::string what;
    c.folder.file("d.store", damaged(random, whole, what));
    EXPECT_EQ(judge_damage(c, "d.store", c.indexed, info.out), "") << what;
    harmless += c.run({"store", "verify", "d.store"}).exit_code == 0 ? 1 : 0;
  }
  std::cout << rounds << " damages, " << harmless << " of them harmless\n";
  EXPECT_LT(harmless, rounds / 2);
}

TEST(Damages, AnotherStoreThatIsPlantedIsSeen) {
  const Campaign& c = campaign();
  c.begin_with("indexed.store", "d.store");
  const Outcome info = c.run({"store", "info", "d.store"});
  EXPECT_EQ(judge_damage(c, "d.store", c.indexed, info.out), "");
  c.begin_with("all.store", "d.store");
  EXPECT_NE(judge_damage(c, "d.store", c.indexed, info.out), "");
}

}  // namespace
}  // namespace freshet::tools
