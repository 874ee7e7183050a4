#include "studio/jobs/job_queue.h"

#include <atomic>
#include <chrono>
#include <future>
#include <map>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "freshet/error.h"

namespace freshet::studio {
namespace {

using namespace std::chrono_literals;

JobState state_of(const JobQueue& queue, JobId id) {
  for (const JobView& view : queue.jobs())
    if (view.id == id) return view.state;
  ADD_FAILURE() << "there is no job " << id;
  return {};
}

/// Runs until it is stopped.
void until_stopped(const Job& job) {
  while (!job.stop.stop_requested()) std::this_thread::sleep_for(1ms);
  throw Error(ErrorKind::kCancelled, "job", "stopped");
}

TEST(JobQueue, RunsOneAfterAnotherInOrder) {
  JobQueue queue;
  std::vector<int> order;
  for (int i = 0; i < 5; ++i)
    queue.submit("job " + std::to_string(i), "", [&order, i](const Job&) { order.push_back(i); });
  queue.wait();
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(JobQueue, ANewJobOfAKeyStopsTheOld) {
  JobQueue queue;
  std::promise<void> begun;
  const JobId old = queue.submit("preview", "", [&](const Job& job) {
    begun.set_value();
    until_stopped(job);
  });
  begun.get_future().wait();
  EXPECT_TRUE(queue.is_busy_with("preview"));
  const JobId waiting = queue.submit("preview", "", [](const Job&) { FAIL() << "it was made useless"; });
  std::atomic<bool> ran = false;
  const JobId last = queue.submit("preview", "", [&](const Job&) { ran = true; });
  queue.wait();
  EXPECT_EQ(state_of(queue, old), JobState::kStopped);
  EXPECT_EQ(state_of(queue, waiting), JobState::kStopped);
  EXPECT_EQ(state_of(queue, last), JobState::kDone);
  EXPECT_TRUE(ran);
}

TEST(JobQueue, StopsWhatRunsAndWhatWaits) {
  JobQueue queue;
  const JobId running = queue.submit("a", "", until_stopped);
  const JobId waiting = queue.submit("b", "", [](const Job&) { FAIL() << "it was stopped"; });
  EXPECT_TRUE(queue.stop(waiting));
  EXPECT_TRUE(queue.stop(running));
  queue.wait();
  EXPECT_EQ(state_of(queue, running), JobState::kStopped);
  EXPECT_EQ(state_of(queue, waiting), JobState::kStopped);
  EXPECT_FALSE(queue.stop(running));
  EXPECT_FALSE(queue.stop(12345));
}

TEST(JobQueue, TellsWhatWentWrong) {
  JobQueue queue;
  const JobId id =
      queue.submit("a", "", [](const Job&) { throw Error(ErrorKind::kInput, "matte", "it is black"); });
  const JobId other = queue.submit("b", "", [](const Job&) { throw std::runtime_error("odd"); });
  queue.wait();
  EXPECT_EQ(state_of(queue, id), JobState::kFailed);
  EXPECT_EQ(queue.jobs().front().fault, "matte: it is black.");
  EXPECT_EQ(state_of(queue, other), JobState::kFailed);
}

TEST(JobQueue, ForgetsWhatEndedLongAgo) {
  JobQueue queue;
  for (int i = 0; i < 100; ++i) {
    queue.submit("job", "", [](const Job&) {});
    queue.wait();
  }
  EXPECT_LE(queue.jobs().size(), 20u);
}

TEST(JobQueue, RefusesMoreThanCanWait) {
  JobQueue queue;
  queue.submit("first", "", until_stopped);
  const auto fill = [&] {
    for (std::size_t i = 0; i < 2 * JobQueue::kMostWaiting; ++i)
      queue.submit("job " + std::to_string(i), "", [](const Job&) {});
  };
  EXPECT_THROW(fill(), Error);
}

TEST(JobQueue, TellsTheEndLast) {
  std::mutex guard;
  std::map<JobId, JobState> told;
  JobQueue queue([&](const JobView& view) {
    const std::lock_guard lock(guard);
    told[view.id] = view.state;
  });
  JobId last = 0;
  for (int i = 0; i < 300; ++i) last = queue.submit("job " + std::to_string(i % 40), "", [](const Job&) {});
  queue.wait();
  // wait() is over when the last one's state is set, and that is told a moment later.
  for (int patience = 0; patience < 1000; ++patience) {
    {
      const std::lock_guard lock(guard);
      if (told[last] == JobState::kDone) break;
    }
    std::this_thread::sleep_for(1ms);
  }
  const std::lock_guard lock(guard);
  EXPECT_EQ(told.size(), 300u);
  for (const auto& [id, state] : told)
    EXPECT_TRUE(state == JobState::kDone || state == JobState::kStopped) << id;
}

TEST(JobQueue, EndsInTheMiddleOfAJob) {
  std::promise<void> begun;
  const auto start = std::chrono::steady_clock::now();
  {
    JobQueue queue;
    queue.submit("a", "", [&](const Job& job) {
      begun.set_value();
      until_stopped(job);
    });
    begun.get_future().wait();
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, 5s);
}

}  // namespace
}  // namespace freshet::studio
