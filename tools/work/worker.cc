#include "tools/work/worker.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "tools/console/progress.h"
#include "tools/console/unfinished_folder.h"
#include "work/command_run.h"
#include "work/task.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr milliseconds kLook{300};           // for a task, before it is seen whether to stop
constexpr milliseconds kChildPatience{400};  // between asking a command to stop and making it
constexpr int kWrongUsage = 2;               // exit code: another try would end the same

/// Says that a task is worked on, again and again, for as long as this lives.
class Heartbeat {
 public:
  Heartbeat(const work::Delivery& delivery, milliseconds every)
      : thread_([this, &delivery, every](const std::stop_token& stop) {
          std::unique_lock lock(guard_);
          while (!waiting_.wait_for(lock, stop, every, [&] { return stop.stop_requested(); }))
            delivery.still_working();
        }) {}

 private:
  std::mutex guard_;
  std::condition_variable_any waiting_;
  std::jthread thread_;
};

/// A worker's folder for what its commands leave unfinished, on this machine's own disk. It goes with the worker; that
/// of one which was killed goes when the next begins: nobody holds its lock.
class Scratch {
 public:
  Scratch() : folder_(fs::temp_directory_path(), kPrefix) {
    const fs::path unnamed = folder_.path() / "new";
    lock_ = ::open(unnamed.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (lock_ >= 0 && ::flock(lock_, LOCK_EX | LOCK_NB) == 0) fs::rename(unnamed, folder_.path() / kLock);
    remove_those_left();
  }
  ~Scratch() { ::close(lock_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& path() const { return folder_.path(); }

 private:
  static constexpr const char *kPrefix = "freshet-work-", *kLock = "lock";

  static void remove_those_left() {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(fs::temp_directory_path(), ignored)) {
      if (!entry.path().filename().string().starts_with(kPrefix)) continue;
      const int lock = ::open((entry.path() / kLock).c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
      if (lock < 0) continue;
      if (::flock(lock, LOCK_EX | LOCK_NB) == 0) fs::remove_all(entry.path(), ignored);
      ::close(lock);
    }
  }

  UnfinishedFolder folder_;
  int lock_ = -1;
};

class Worker {
 public:
  Worker(work::Queue& queue, milliseconds ack_wait, const WorkerOptions& options, const RunContext& context)
      : queue_(queue), ack_wait_(ack_wait), options_(options), context_(context) {}

  void run() {
    while (!context_.stop.stop_requested()) {
      std::optional<work::Delivery> delivery = queue_.next(kLook);
      if (delivery)
        take(*delivery);
      else if (options_.until_empty && is_empty())
        return;
    }
    throw Error(ErrorKind::kCancelled, "work", "stopped");
  }

 private:
  /// Not while the server is away.
  bool is_empty() const {
    try {
      return queue_.left() == 0;
    } catch (const Error&) {
      return false;
    }
  }

  void take(work::Delivery& delivery) {
    std::optional<work::Task> task;
    std::string name = "a task", key = "none";
    try {
      task = work::read_task(delivery.text());
      key = task->key();
      name = fmt::format("{}/{} of {}", task->shard.index, task->shard.count,
                         work::to_text({.program = {}, .arguments = task->command.words(), .folder = {}}));
    } catch (const Error& fault) {
      return keep_fault(name, key, delivery, fault.what(), true);
    }
    // Machines that went while they had it, and said nothing, were perhaps ended by it.
    if (delivery.times() > kMaxDeliveries * options_.tries)
      return keep_fault(name, key, delivery,
                        fmt::format("was begun {} times and never ended", delivery.times() - 1), true);
    say(fmt::format("begun: {}", name));
    const Stopwatch watch;
    std::optional<work::CommandAnswer> answer;
    try {
      answer = answer_of(*task, delivery);
    } catch (const Error&) {  // this machine's fault, not the task's: another one may do it
      delivery.hand_back();
      throw;
    }
    if (!answer) {
      delivery.hand_back();
      say(fmt::format("handed back: {}", name));
      return;
    }
    if (answer->exit_code != 0)
      return keep_fault(name, key, delivery, fault_in(*answer), answer->exit_code == kWrongUsage);
    for (int tries = 0; !delivery.done(); ++tries) {
      if (tries < 20 && !context_.stop.stop_requested()) continue;
      say(fmt::format("done, but the queue was not reached; it will find that out again: {}", name));
      return;
    }
    say(fmt::format("done in {:.1f} s: {}", watch.seconds(), name));
  }

  /// Nothing where it was stopped.
  std::optional<work::CommandAnswer> answer_of(const work::Task& task, const work::Delivery& delivery) const {
    const Heartbeat heartbeat(delivery, ack_wait_ / 3);
    const UnfinishedFolder scratch(scratch_.path(), "task-");
    std::vector<std::string> words = task.command.shard_words(task.shard);
    if (options_.threads > 0) words.insert(words.end(), {"--threads", std::to_string(options_.threads)});
    Progress progress;
    try {
      return work::run_to_end({.program = fs::read_symlink("/proc/self/exe"),
                               .arguments = words,
                               .folder = options_.folder,
                               .environment = {"TMPDIR=" + scratch.path().string(),
                                               fmt::format("{}={}", work::kEndsWith, ::getpid())},
                               .patience = kChildPatience},
                              {.progress = progress.callback(), .stop = context_.stop});
    } catch (const Error& fault) {
      if (fault.kind() == ErrorKind::kCancelled) return std::nullopt;
      throw;
    }
  }

  static std::string fault_in(const work::CommandAnswer& answer) {
    constexpr std::size_t kTold = 4;
    const std::size_t first = answer.messages.size() - std::min(kTold, answer.messages.size());
    std::string told;
    for (std::size_t i = first; i < answer.messages.size(); ++i)
      told += (told.empty() ? "" : "; ") + answer.messages[i];
    return told.empty() ? fmt::format("ended with {} and without a word", answer.exit_code) : told;
  }

  /// At last, or when there is no hope, the task is given up.
  void keep_fault(const std::string& name, const std::string& key, work::Delivery& delivery,
                  const std::string& message, bool hopeless) {
    try {
      const work::Fault fault = queue_.add_fault(key, delivery, message);
      if (hopeless || fault.times >= options_.tries) {
        queue_.bury(key, delivery, fault);
        say(fmt::format("given up: {}: {}", name, message));
        return;
      }
      say(fmt::format("failed, {} of {} times: {}: {}", fault.times, options_.tries, name, message));
      delivery.hand_back(milliseconds(std::min<std::uint64_t>(1000 * fault.times, 30'000)));
    } catch (const Error& lost) {  // the queue's: the task comes again
      say(lost.what());
      delivery.hand_back(milliseconds(1000));
    }
  }

  static constexpr std::uint64_t kMaxDeliveries = 10;  // for each fault that is allowed

  work::Queue& queue_;
  const milliseconds ack_wait_;
  const WorkerOptions& options_;
  const RunContext& context_;
  const Scratch scratch_;
};

}  // namespace

void run_worker(work::Queue& queue, const work::QueueOptions& queue_options, const WorkerOptions& options,
                const RunContext& context) {
  Worker(queue, queue_options.ack_wait, options, context).run();
}

}  // namespace freshet::tools
