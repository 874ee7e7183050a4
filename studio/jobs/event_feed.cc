#include "studio/jobs/event_feed.h"

#include <atomic>

#include <fmt/format.h>

namespace freshet::studio {

std::string to_text(const Event& event) {
  return fmt::format("id: {}\nevent: {}\ndata: {}\n\n", event.number, event.type, event.data);
}

std::uint64_t next_number() {
  using std::chrono::milliseconds;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  static std::atomic<std::uint64_t> last{
      static_cast<std::uint64_t>(std::chrono::duration_cast<milliseconds>(now).count())};
  return ++last;
}

void EventFeed::publish(const std::string& type, const std::string& data) {
  {
    const std::lock_guard lock(guard_);
    events_.push_back({++last_, type, data});
    if (events_.size() > kKept) events_.pop_front();
  }
  changed_.notify_all();
}

std::uint64_t EventFeed::last() const {
  const std::lock_guard lock(guard_);
  return last_;
}

std::vector<Event> EventFeed::after(std::uint64_t number, std::chrono::milliseconds patience) const {
  std::unique_lock lock(guard_);
  changed_.wait_for(lock, patience, [&] { return closed_ || last_ > number; });
  std::vector<Event> news;
  for (const Event& event : events_)
    if (event.number > number) news.push_back(event);
  return news;
}

void EventFeed::close() {
  {
    const std::lock_guard lock(guard_);
    closed_ = true;
  }
  changed_.notify_all();
}

bool EventFeed::closed() const {
  const std::lock_guard lock(guard_);
  return closed_;
}

}  // namespace freshet::studio
