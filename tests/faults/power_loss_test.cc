// Power that fails: a log of a run's writes is replayed up to some point, with what was not synced by then kept, lost
// or torn, each write for itself. What lies on the disk then is opened.
//
// The disk of the model: a write may be durable from when it was made, and is from the next sync of its file on, or at
// once on a descriptor opened with O_DSYNC; until then each 512 bytes of it may be there or not. A new name, too, is
// there from its making or from the next sync of its folder on.

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <map>
#include <random>

#include "tests/faults/campaign.h"
#include "tests/faults/write_log.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

struct LogEntry {
  LogKind kind;
  bool durable;
  std::string path;
  std::uint64_t offset = 0;
  std::string bytes;
};

std::vector<LogEntry> read_log(const fs::path& file) {
  const std::string text = text_of(file);
  std::vector<LogEntry> log;
  const char* at = text.data();
  const auto number = [&](auto value) {
    std::memcpy(&value, at, sizeof value);
    at += sizeof value;
    return value;
  };
  while (at < text.data() + text.size()) {
    LogEntry entry{static_cast<LogKind>(at[0]), at[1] != 0, {}, 0, {}};
    at += 2;
    const auto length = number(std::uint32_t{});
    entry.path.assign(at, length);
    at += length;
    entry.offset = number(std::uint64_t{});
    const auto size = number(std::uint64_t{});
    entry.bytes.assign(at, size);
    at += size;
    log.push_back(std::move(entry));
  }
  return log;
}

/// The files of a run at some moment, by the names that they have then.
class Disk {
 public:
  explicit Disk(std::map<std::string, std::string> files) : files_(std::move(files)) {}

  /// All of an entry, or of a write only the sectors that `keep` says.
  template <class Keep>
  void apply(const LogEntry& entry, const Keep& keep) {
    constexpr std::size_t kSector = 512;
    if (entry.kind == LogKind::kTruncate) {
      files_[entry.path].resize(entry.offset);
    } else if (entry.kind == LogKind::kRename) {
      files_[entry.bytes] = std::move(files_[entry.path]);
      files_.erase(entry.path);
    } else if (entry.kind == LogKind::kWrite) {
      std::string& file = files_[entry.path];
      for (std::size_t from = 0; from < entry.bytes.size();) {
        const std::size_t count =
            std::min(kSector - (entry.offset + from) % kSector, entry.bytes.size() - from);
        if (keep()) {
          file.resize(std::max<std::size_t>(file.size(), entry.offset + from + count));
          file.replace(entry.offset + from, count, entry.bytes, from, count);
        }
        from += count;
      }
    }
  }
  const std::map<std::string, std::string>& files() const { return files_; }

 private:
  std::map<std::string, std::string> files_;
};

enum class Syncs { kKept, kIgnored };

/// What is on the disk when power fails after `end` entries.
/// syncs   kIgnored: as on a disk that says it has synced, and has not; for the fault that is planted.
Disk after_power_loss(const std::map<std::string, std::string>& before, const std::vector<LogEntry>& log,
                      std::size_t end, Syncs syncs, std::mt19937& random) {
  // Whether entry i was made durable by a sync before the end; names, by one of their folder.
  const auto is_durable = [&](std::size_t i) {
    if (log[i].kind == LogKind::kWrite && log[i].durable) return true;
    if (syncs == Syncs::kIgnored) return false;
    const std::string wanted =
        log[i].kind == LogKind::kRename ? fs::path(log[i].path).parent_path().string() : log[i].path;
    std::string name = wanted;  // the file may have got another one since
    for (std::size_t j = i + 1; j < end; ++j) {
      if (log[j].kind == LogKind::kRename && log[j].path == name) name = log[j].bytes;
      if (log[j].kind == LogKind::kSync && log[j].path == name) return true;
    }
    return false;
  };
  Disk disk(before);
  const unsigned mood = random() % 4;  // most is kept, most is lost, torn, or each as it comes
  for (std::size_t i = 0; i < end; ++i) {
    const bool durable = is_durable(i);
    const bool whole = random() % 100 < (mood == 0 ? 90u : mood == 1 ? 10u : 50u);
    // A new name that is lost takes nothing with it: later writes to that name do not occur before its sync.
    if (log[i].kind == LogKind::kRename && !durable && !whole) continue;
    disk.apply(log[i], [&] { return durable || (mood == 2 ? random() % 2 == 0 : whole); });
  }
  return disk;
}

/// Runs a job and writes down what it does.
std::vector<LogEntry> logged(const Campaign& c, const Job& job) {
  c.begin_with(job.begins_with, "f.store");
  fs::remove(c.folder / "log");
  std::vector<std::string> command{"env", "LD_PRELOAD=" FRESHET_WRITE_LOG_LIBRARY,
                                   "FRESHET_WRITE_LOG=" + (c.folder / "log").string(),
                                   "FRESHET_WRITE_LOG_FILES=f.store", executable()};
  command.insert(command.end(), job.arguments.begin(), job.arguments.end());
  const Outcome outcome = c.folder.run(command);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return read_log(c.folder / "log");
}

/// The store at a moment, under its name. LMDB's lock file is not there: the machine has been started anew.
void lay_out(const Campaign& c, const Disk& disk) {
  c.begin_with("", "f.store");
  for (const auto& [path, bytes] : disk.files())
    if (!path.ends_with("-lock")) c.folder.file(fs::path(path).filename().string(), bytes);
}

std::map<std::string, std::string> begun(const Campaign& c, const Job& job) {
  std::map<std::string, std::string> files;
  if (!job.begins_with.empty())
    files[fs::canonical(c.folder.path()) / "f.store"] = text_of(c.folder / job.begins_with);
  return files;
}

/// What is wrong with the store after power failed at that moment.
std::string judge_power_loss(const Campaign& c, const Job& job, bool ended) {
  if (ended) return c.judge("f.store", {job.after});
  if (!job.in_steps) return c.judge("f.store", {job.before, job.after});
  if (!fs::exists(c.folder / "f.store")) return job.before.empty() ? "" : "the store is gone";
  const Outcome verify = c.run({"store", "verify", "f.store"});
  return verify.exit_code == 0 ? "" : "verify: " + verify.out + verify.err;
}

TEST(PowerLoss, LeavesWhatWasCommitted) {
  const Campaign& c = campaign();
  std::mt19937 random(13);
  struct Kind {
    Job job;
    std::vector<LogEntry> log;
    std::map<std::string, std::string> before;
  };
  std::vector<Kind> kinds;
  std::vector<std::pair<std::size_t, int>> cases;
  for (const Job& job : jobs()) {
    kinds.push_back({job, logged(c, job), begun(c, job)});
    ASSERT_GT(kinds.back().log.size(), 5u) << job.name;
    for (int round = 0; round < (at_full_length() ? 400 : 4); ++round)
      cases.emplace_back(kinds.size() - 1, round);
  }
  walk("states", cases, [&](const auto& tried) {
    const auto& [job, log, before] = kinds[tried.first];
    const int round = tried.second;
    // Often at the very end, where all that was reported must be there.
    const std::size_t end = round % 4 == 0 ? log.size() : random() % (log.size() + 1);
    lay_out(c, after_power_loss(before, log, end, Syncs::kKept, random));
    ASSERT_EQ(judge_power_loss(c, job, end == log.size()), "")
        << job.name << ", after " << end << " of " << log.size() << " entries, round " << round;
    if (round % 4 == 1) {
      ASSERT_EQ(judge_again(c, job), "") << job.name << ", after " << end << " of " << log.size();
    }
  });
}

TEST(PowerLoss, ADiskThatOnlySaysThatItSyncsIsSeen) {
  const Campaign& c = campaign();
  std::mt19937 random(17);
  for (const std::size_t which :
       {std::size_t{1}, std::size_t{3}}) {  // LMDB's own commit, and a file made anew
    const Job job = jobs()[which];
    const std::vector<LogEntry> log = logged(c, job);
    const auto before = begun(c, job);
    int seen = 0;
    for (int round = 0; round < 10; ++round) {
      lay_out(c, after_power_loss(before, log, log.size(), Syncs::kIgnored, random));
      seen += judge_power_loss(c, job, true).empty() ? 0 : 1;
    }
    EXPECT_GE(seen, 1) << job.name;
  }
}

}  // namespace
}  // namespace freshet::tools
