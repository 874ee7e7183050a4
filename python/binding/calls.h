// python/binding/calls.h — long calls as Python expects them: others run meanwhile, Ctrl-C ends them, callbacks may
// throw.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "freshet/job.h"
#include "python/binding/binding.h"

namespace freshet::python {

/// Does the work on a thread of its own. Meanwhile the calling thread lends out the interpreter's lock and looks for
/// signals 20 times a second; one that raises (KeyboardInterrupt) stops the work, and is raised when that has ended.
/// progress   None, or a callable of (stage, done, of).
void run(const py::object& progress, const std::function<void(const Job&)>& work);

/// The same with a result.
template <class Work>
auto run_for(const py::object& progress, const Work& work) {
  std::optional<decltype(work(Job{}))> result;
  run(progress, [&](const Job& job) { result.emplace(work(job)); });
  return *std::move(result);
}

/// Frames of a computation that hands them out, one by one: a Python iterator. The computation runs on a thread of its
/// own, two frames ahead, and ends when the iterator goes.
class Frames {
 public:
  using Sink = std::function<void(const cv::Mat&)>;
  using Work = std::function<void(const Sink&, const Job&)>;

  Frames(Work work, py::object progress);
  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;
  ~Frames();

  /// Raises StopIteration after the last, and what the computation threw.
  py::array next();
  /// Ends the computation; there are no frames after that.
  void close();

 private:
  void put(const cv::Mat& frame);

  py::object progress_;
  std::mutex guard_;
  std::condition_variable changed_;
  std::deque<cv::Mat> ready_;
  bool done_ = false;
  std::exception_ptr fault_;
  std::stop_source stop_;
  std::thread worker_;
};

}  // namespace freshet::python
