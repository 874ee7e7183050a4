// studio/jobs/jobs.h — the work that runs for a studio, in two lanes, and the news of it.
#pragma once

#include <memory>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "studio/jobs/event_feed.h"
#include "studio/jobs/job_queue.h"

namespace freshet::studio {

/// Previews, of which a newer one takes an older one's place, and commands beside them. Safe from many threads.
class Jobs {
 public:
  Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  EventFeed& feed() { return feed_; }
  JobQueue& previews() { return *previews_; }
  JobQueue& commands() { return *commands_; }
  std::string to_json() const;
  bool stop(const std::string& lane, JobId id);
  /// Until no job waits or runs.
  void wait();
  /// Stops all, and waits: what jobs use may go then. Nothing is submitted any more.
  void end();

 private:
  JobQueue::Watcher watcher(const char* lane);

  EventFeed feed_;
  std::unique_ptr<JobQueue> previews_, commands_;
};

/// One line; what is no UTF-8 is replaced.
std::string json_text(const nlohmann::json& json);

}  // namespace freshet::studio
