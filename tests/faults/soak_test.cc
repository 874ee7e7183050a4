// Many processes on one store for a while: clips come and go, are searched, animated and checked, and some runs are
// stopped. FRESHET_SOAK_MINUTES says for how long (./test.sh --soak [MINUTES]); else it is some seconds.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <iostream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "tests/faults/campaign.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// What may stand against a command while others work on the store, and is no fault.
bool is_excused(const Outcome& outcome) {
  for (const char* reason : {"another process is writing to it", "is being compacted by another process",
                             "has been replaced while it was", "is open in another", "it holds no patches",
                             "has no index", "have been added since its index", "has no codebook",
                             "no clip named", "has no clip", "there is no such clip", "no patch"})
    if (outcome.exit_code == 1 && outcome.err.find(reason) != std::string::npos) return true;
  return false;
}

/// Runs of one kind of command.
struct Tally {
  int done = 0, excused = 0, stopped = 0;
  std::vector<long> peaks_kib;  // of those that were done, in order
};

class Soak {
 public:
  Soak(const Campaign& c, Clock::time_point end) : c_(c), end_(end) {}

  /// Runs commands at random, one after another, until the time is over.
  void act(const std::vector<std::vector<std::string>>& commands, unsigned seed) {
    std::mt19937 random(seed);
    while (Clock::now() < end_) run(commands[random() % commands.size()], random);
  }
  const std::map<std::string, Tally>& tallies() const { return tallies_; }
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  void run(const std::vector<std::string>& arguments, std::mt19937& random) {
    std::vector<std::string> command = arguments;
    command.insert(command.begin(), executable());
    const Started started = c_.folder.start(command);
    const bool stops = random() % 5 == 0;
    if (stops) {
      std::this_thread::sleep_for(std::chrono::milliseconds(random() % 1500));
      ::kill(started.process, SIGINT);
    }
    const Outcome outcome = WorkFolder::wait(started);
    const std::string name =
        arguments[0] + (arguments[0] == "ingest" || arguments[0] == "index" ? "" : " " + arguments[1]);
    const std::lock_guard lock(mutex_);
    Tally& tally = tallies_[name];
    if (outcome.exit_code == 0) {
      ++tally.done;
      tally.peaks_kib.push_back(outcome.peak_kib);
    } else if (stops && outcome.signal == SIGINT) {
      ++tally.stopped;
    } else if (is_excused(outcome)) {
      ++tally.excused;
    } else {
      faults_.push_back(name + ": exit " + std::to_string(outcome.exit_code) + ", signal " +
                        std::to_string(outcome.signal) + ": " + outcome.err + outcome.out);
    }
  }

  const Campaign& c_;
  const Clock::time_point end_;
  std::mutex mutex_;
  std::map<std::string, Tally> tallies_;
  std::vector<std::string> faults_;
};

/// What one in ten exceeds: many an ingest finds its clips there, and does nothing.
long high_of(std::vector<long> values, std::size_t first, std::size_t end) {
  const auto high = values.begin() + static_cast<std::ptrdiff_t>(first + (end - first) * 9 / 10);
  std::nth_element(values.begin() + static_cast<std::ptrdiff_t>(first), high,
                   values.begin() + static_cast<std::ptrdiff_t>(end));
  return *high;
}

/// The commands that change f.store, and those that read it.
std::vector<std::vector<std::string>> changes(const Campaign& c) {
  return {c.ingest("f.store", {"clip1.mkv"}),
          c.ingest("f.store", {"clip1.mkv", "clip2.mkv", "clip3.mkv"}),
          {"index", "f.store"},
          {"store", "remove", "f.store", "clip2.mkv"},
          {"store", "remove", "f.store", "clip1.mkv", "clip3.mkv"},
          {"store", "compact", "f.store"}};
}
/// number   of who reads: each has an animation of its own.
std::vector<std::vector<std::string>> readings(unsigned number) {
  const std::string video = "soak" + std::to_string(number) + ".mkv";
  return {
      {"store", "verify", "f.store"},
      {"store", "digest", "f.store"},
      {"store", "info", "f.store"},
      {"query", "candidates", "f.store", "still.png", "--whole", "-k", "5", "--frames", "12"},
      {"synth", "animate", "f.store", "still.png", "--whole", "--frames", "12", "-o", video, "--overwrite"}};
}

TEST(Soak, OfManyProcessesLosesNothingAndGrowsNowhere) {
  const Campaign& c = campaign();
  const char* const minutes = std::getenv("FRESHET_SOAK_MINUTES");
  const auto length =
      minutes != nullptr ? std::chrono::seconds(60 * std::stol(minutes)) : std::chrono::seconds(8);
  ASSERT_EQ(c.run({"synth", "simulate", "river", "--size", "96x96", "--frames", "1", "--seed", "9", "-o",
                   "s%02d.png"})
                .exit_code,
            0);
  for (const auto& entry : fs::directory_iterator(c.folder.path()))
    if (entry.path().extension() == ".png") fs::rename(entry.path(), c.folder / "still.png");
  c.begin_with("indexed.store", "f.store");
  Soak soak(c, Clock::now() + length);
  {
    std::vector<std::jthread> actors;
    for (unsigned i = 0; i < 2; ++i) actors.emplace_back([&soak, &c, i] { soak.act(changes(c), i); });
    for (unsigned i = 0; i < 3; ++i) actors.emplace_back([&soak, i] { soak.act(readings(i), 10 + i); });
  }
  for (const std::string& fault : soak.faults()) ADD_FAILURE() << fault;
  for (const auto& [name, tally] : soak.tallies()) {
    std::cout << name << ": " << tally.done << " done, " << tally.excused << " kept out by others, "
              << tally.stopped << " stopped";
    // Of the first and of the last quarter, where there are enough to compare.
    if (const std::size_t n = tally.peaks_kib.size(); n >= 40) {
      const long first = high_of(tally.peaks_kib, 0, n / 4), last = high_of(tally.peaks_kib, n - n / 4, n);
      std::cout << "; peak memory " << first / 1024 << " MiB, later " << last / 1024 << " MiB";
      EXPECT_LT(static_cast<double>(last), 1.15 * static_cast<double>(first)) << name;
    }
    std::cout << "\n";
  }

  // What is there is whole; with the clips that were taken out it is what it was, and no larger.
  ASSERT_EQ(c.run({"store", "verify", "f.store"}).exit_code, 0);
  const std::uintmax_t worn = fs::file_size(c.folder / "f.store");
  ASSERT_EQ(c.run(c.ingest("f.store", {"clip1.mkv", "clip2.mkv", "clip3.mkv"})).exit_code, 0);
  ASSERT_EQ(c.run({"index", "f.store", "--rebuild"}).exit_code, 0);
  EXPECT_EQ(c.judge("f.store", {c.indexed}), "");
  ASSERT_EQ(c.run({"store", "compact", "f.store"}).exit_code, 0);
  c.begin_with("indexed.store", "fresh.store");
  ASSERT_EQ(c.run({"store", "compact", "fresh.store"}).exit_code, 0);
  const std::uintmax_t compact = fs::file_size(c.folder / "f.store"),
                       fresh = fs::file_size(c.folder / "fresh.store");
  std::cout << "file: " << worn << " bytes when it ended, " << compact << " compacted; " << fresh
            << " of an undisturbed run\n";
  EXPECT_LE(compact, fresh + 4096);
  // Free pages are used again: beside what is in use there is at most what a change needs twice over.
  EXPECT_LT(worn, 4 * fresh);
}

TEST(Soak, AFaultThatIsPlantedIsSeen) {
  const Campaign& c = campaign();
  c.begin_with("all.store", "f.store");
  std::string bytes = text_of(c.folder / "f.store");
  bytes.replace(bytes.size() / 2, 8192, 8192, 'x');
  c.folder.file("f.store", bytes);
  Soak soak(c, Clock::now() + std::chrono::milliseconds(1500));
  soak.act({{"store", "verify", "f.store"}}, 1);
  EXPECT_FALSE(soak.faults().empty());
}

}  // namespace
}  // namespace freshet::tools
