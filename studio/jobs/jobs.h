// studio/jobs/jobs.h — the work that runs for a studio, in three lanes, and the news of it.
#pragma once

#include <array>
#include <memory>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "studio/jobs/event_feed.h"
#include "studio/jobs/job_queue.h"

namespace freshet::studio {

/// Previews, of which a newer one takes an older one's place, what is live, which waits for no preview, and commands
/// beside them. Safe from many threads.
class Jobs {
 public:
  Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  EventFeed& feed() { return feed_; }
  JobQueue& previews() { return *lanes_[0]; }
  JobQueue& live() { return *lanes_[1]; }
  JobQueue& commands() { return *lanes_[2]; }
  std::string to_json() const;
  bool stop(const std::string& lane, JobId id);
  /// Until no job waits or runs.
  void wait();
  /// Stops all, and waits: what jobs use may go then. Nothing is submitted any more.
  void end();

 private:
  EventFeed feed_;
  std::array<std::unique_ptr<JobQueue>, 3> lanes_;  // the last is ended first
};

/// One line; what is no UTF-8 is replaced.
std::string json_text(const nlohmann::json& json);

}  // namespace freshet::studio
