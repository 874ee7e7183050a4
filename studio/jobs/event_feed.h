// studio/jobs/event_feed.h — what happens, told to every page that is open, as server-sent events.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

namespace freshet::studio {

struct Event {
  std::uint64_t number = 0;
  std::string type, data;  // data   JSON, one line
};
/// "id: 4\nevent: job\ndata: {...}\n\n"
std::string to_text(const Event& event);

/// A number that nothing else has, of this run or an earlier one: a page outlives servers. It grows, and stays below
/// 2^53, as far as a page counts.
std::uint64_t next_number();

/// The last kKept events. A page that was away longer finds a gap, and asks for all again. Safe from many threads.
class EventFeed {
 public:
  void publish(const std::string& type, const std::string& data);
  std::uint64_t last() const;
  /// Those after a number, oldest first; waits for one. Empty when the time is over, or the feed closed.
  std::vector<Event> after(std::uint64_t number, std::chrono::milliseconds patience) const;
  /// Nobody waits any more.
  void close();
  bool closed() const;

  static constexpr std::size_t kKept = 1024;

 private:
  mutable std::mutex guard_;
  mutable std::condition_variable changed_;
  std::deque<Event> events_;
  std::uint64_t last_ = 0;
  bool closed_ = false;
};

}  // namespace freshet::studio
