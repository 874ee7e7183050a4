// studio/jobs/job_queue.h — long work, one after another, of which a person can stop each.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "freshet/job.h"

namespace freshet::studio {

using JobId = std::uint64_t;  // as next_number() gives them

enum class JobState { kWaiting, kRunning, kDone, kFailed, kStopped };
const char* to_string(JobState state);

struct JobView {
  JobId id = 0;
  std::string key, title;  // title   for a person
  JobState state = JobState::kWaiting;
  Progress progress;
  std::string fault;  // of a job that failed, for a person
};

/// One thread, and jobs that wait for it. A job's key says what it makes: a new one of the same key makes the old one
/// useless, and stops it. Safe from many threads.
class JobQueue {
 public:
  using Work = std::function<void(const Job& job)>;
  using Watcher = std::function<void(const JobView& view)>;

  /// watcher   told of every change, from the thread where it happens; progress at most ten times a second.
  explicit JobQueue(Watcher watcher = {});
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;
  /// Stops what runs, and drops what waits.
  ~JobQueue();

  /// At most kMostWaiting wait: throws Error{kUsage} for one more.
  JobId submit(const std::string& key, const std::string& title, Work work);
  /// False when there is no such job, or it has ended.
  bool stop(JobId id);
  void stop_key(const std::string& key);
  /// Whether a job of this key waits or runs.
  bool is_busy_with(const std::string& key) const;
  /// Waiting, running, and the last ones that ended; oldest first.
  std::vector<JobView> jobs() const;
  /// Until nothing waits or runs.
  void wait();

  static constexpr std::size_t kMostWaiting = 64;

 private:
  struct Entry {
    JobView view;
    Work work;
    std::stop_source stop;
  };
  using EntryPointer = std::shared_ptr<Entry>;
  void run();
  void run_one(Entry& entry);
  void change(Entry& entry, const std::function<void(JobView&)>& edit);
  void forget_old();

  Watcher watcher_;
  mutable std::mutex guard_;
  std::condition_variable changed_;
  std::list<EntryPointer> entries_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace freshet::studio
