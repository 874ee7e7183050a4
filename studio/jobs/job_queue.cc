#include "studio/jobs/job_queue.h"

#include <algorithm>
#include <chrono>
#include <exception>

#include "freshet/error.h"
#include "studio/jobs/event_feed.h"

namespace freshet::studio {
namespace {

constexpr std::size_t kEndedKept = 16;
constexpr auto kBetweenNews = std::chrono::milliseconds(100);

bool has_ended(const JobView& view) {
  return view.state != JobState::kWaiting && view.state != JobState::kRunning;
}

}  // namespace

const char* to_string(JobState state) {
  switch (state) {
    case JobState::kWaiting:
      return "waiting";
    case JobState::kRunning:
      return "running";
    case JobState::kDone:
      return "done";
    case JobState::kFailed:
      return "failed";
    case JobState::kStopped:
      break;
  }
  return "stopped";
}

JobQueue::JobQueue(Watcher watcher) : watcher_(std::move(watcher)), thread_([this] { run(); }) {}

JobQueue::~JobQueue() {
  {
    const std::lock_guard lock(guard_);
    ending_ = true;
    for (const EntryPointer& entry : entries_) entry->stop.request_stop();
  }
  changed_.notify_all();
  thread_.join();
}

JobId JobQueue::submit(const std::string& key, const std::string& title, Work work) {
  stop_key(key);
  auto entry = std::make_shared<Entry>();
  {
    const std::lock_guard lock(guard_);
    const auto waiting = std::count_if(entries_.begin(), entries_.end(), [](const EntryPointer& each) {
      return each->view.state == JobState::kWaiting;
    });
    if (static_cast<std::size_t>(waiting) >= kMostWaiting)
      throw Error(ErrorKind::kUsage, title, "too much waits already", "Stop some of it");
    entry->view = {.id = next_number(), .key = key, .title = title, .state = {}, .progress = {}, .fault = {}};
    entry->work = std::move(work);
  }
  const JobView view = entry->view;
  // Before it can begin: "waiting" that is told after "done" would wait for ever.
  if (watcher_) watcher_(view);
  {
    const std::lock_guard lock(guard_);
    entries_.push_back(std::move(entry));
  }
  changed_.notify_all();
  return view.id;
}

bool JobQueue::stop(JobId id) {
  EntryPointer found;
  bool waited = false;
  {
    const std::lock_guard lock(guard_);
    for (const EntryPointer& entry : entries_)
      if (entry->view.id == id && !has_ended(entry->view)) found = entry;
    if (!found) return false;
    found->stop.request_stop();
    waited = found->view.state == JobState::kWaiting;
    if (waited) found->view.state = JobState::kStopped;
  }
  if (waited) {
    found->work = {};
    if (watcher_) watcher_(found->view);
  }
  changed_.notify_all();
  return true;
}

void JobQueue::stop_key(const std::string& key) {
  std::vector<JobId> found;
  {
    const std::lock_guard lock(guard_);
    for (const EntryPointer& entry : entries_)
      if (entry->view.key == key && !has_ended(entry->view)) found.push_back(entry->view.id);
  }
  for (const JobId id : found) stop(id);
}

bool JobQueue::is_busy_with(const std::string& key) const {
  const std::lock_guard lock(guard_);
  return std::any_of(entries_.begin(), entries_.end(), [&](const EntryPointer& entry) {
    return entry->view.key == key && !has_ended(entry->view) && !entry->stop.stop_requested();
  });
}

std::vector<JobView> JobQueue::jobs() const {
  const std::lock_guard lock(guard_);
  std::vector<JobView> views;
  for (const EntryPointer& entry : entries_) views.push_back(entry->view);
  return views;
}

void JobQueue::wait() {
  std::unique_lock lock(guard_);
  changed_.wait(lock, [this] {
    return std::all_of(entries_.begin(), entries_.end(),
                       [](const EntryPointer& entry) { return has_ended(entry->view); });
  });
}

void JobQueue::run() {
  for (;;) {
    EntryPointer next;
    {
      std::unique_lock lock(guard_);
      changed_.wait(lock, [&] {
        const auto waiting = std::find_if(entries_.begin(), entries_.end(), [](const EntryPointer& entry) {
          return entry->view.state == JobState::kWaiting;
        });
        if (waiting != entries_.end()) next = *waiting;
        return ending_ || next;
      });
      if (ending_) return;
      next->view.state = JobState::kRunning;
    }
    run_one(*next);
    next.reset();
    forget_old();
    changed_.notify_all();
  }
}

void JobQueue::run_one(Entry& entry) {
  if (watcher_) watcher_(entry.view);
  auto last_news = std::chrono::steady_clock::now() - kBetweenNews;
  const Job job{.progress =
                    [&](const Progress& at) {
                      const auto now = std::chrono::steady_clock::now();
                      const bool new_stage = at.stage != entry.view.progress.stage;
                      if (!new_stage && now - last_news < kBetweenNews && at.done != at.of) return;
                      last_news = now;
                      change(entry, [&](JobView& view) { view.progress = at; });
                    },
                .stop = entry.stop.get_token()};
  JobState state = JobState::kDone;
  std::string fault;
  try {
    entry.work(job);
  } catch (const Error& error) {
    state = error.kind() == ErrorKind::kCancelled ? JobState::kStopped : JobState::kFailed;
    fault = error.what();
  } catch (const std::bad_alloc&) {
    state = JobState::kFailed;
    fault = "There is not enough memory for it. Use a smaller picture, or fewer frames.";
  } catch (const std::exception& error) {
    state = JobState::kFailed;
    fault = std::string("It failed unexpectedly: ") + error.what();
  }
  entry.work = {};
  change(entry, [&](JobView& view) {
    view.state = state;
    if (state == JobState::kFailed) view.fault = fault;
  });
}

void JobQueue::change(Entry& entry, const std::function<void(JobView&)>& edit) {
  JobView view;
  {
    const std::lock_guard lock(guard_);
    edit(entry.view);
    view = entry.view;
  }
  if (watcher_) watcher_(view);
}

void JobQueue::forget_old() {
  const std::lock_guard lock(guard_);
  auto ended = std::count_if(entries_.begin(), entries_.end(),
                             [](const EntryPointer& entry) { return has_ended(entry->view); });
  for (auto entry = entries_.begin(); entry != entries_.end() && ended > static_cast<long>(kEndedKept);) {
    if (!has_ended((*entry)->view)) {
      ++entry;
      continue;
    }
    entry = entries_.erase(entry);
    --ended;
  }
}

}  // namespace freshet::studio
