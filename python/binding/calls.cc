#include "python/binding/calls.h"

#include <chrono>
#include <utility>

#include "freshet/error.h"

namespace freshet::python {
namespace {

constexpr std::chrono::milliseconds kSignals{50};

Job job_of(const py::object& progress, const std::stop_source& stop) {
  Job job{.progress = {}, .stop = stop.get_token()};
  if (!progress.is_none())
    job.progress = [&progress](const Progress& at) {
      const py::gil_scoped_acquire locked;
      progress(at.stage, at.done, at.of);
    };
  return job;
}

/// Waits without the interpreter's lock until `over` says so; false when a signal has raised.
template <class Over>
bool wait_for(std::mutex& guard, std::condition_variable& changed, const Over& over) {
  for (;;) {
    {
      const py::gil_scoped_release unlocked;
      std::unique_lock lock(guard);
      if (changed.wait_for(lock, kSignals, over)) return true;
    }
    if (PyErr_CheckSignals() != 0) return false;
  }
}

}  // namespace

void run(const py::object& progress, const std::function<void(const Job&)>& work) {
  std::stop_source stop;
  const Job job = job_of(progress, stop);
  std::mutex guard;
  std::condition_variable changed;
  bool done = false;
  std::exception_ptr fault;
  std::thread worker([&] {
    try {
      work(job);
    } catch (...) {
      fault = std::current_exception();
    }
    const std::lock_guard lock(guard);
    done = true;
    changed.notify_all();
  });
  std::optional<py::error_already_set> raised;
  if (!wait_for(guard, changed, [&] { return done; })) {
    raised.emplace();
    stop.request_stop();
  }
  {
    const py::gil_scoped_release unlocked;
    worker.join();
  }
  if (raised) throw py::error_already_set(*raised);
  if (fault) std::rethrow_exception(fault);
}

Frames::Frames(Work work, py::object progress) : progress_(std::move(progress)) {
  worker_ = std::thread([this, work = std::move(work)] {
    try {
      work([this](const cv::Mat& frame) { put(frame); }, job_of(progress_, stop_));
    } catch (...) {
      const std::lock_guard lock(guard_);
      fault_ = std::current_exception();
    }
    const std::lock_guard lock(guard_);
    done_ = true;
    changed_.notify_all();
  });
}

Frames::~Frames() { close(); }

void Frames::put(const cv::Mat& frame) {
  constexpr std::size_t kAhead = 2;
  std::unique_lock lock(guard_);
  changed_.wait(lock, [&] { return ready_.size() < kAhead || stop_.stop_requested(); });
  if (stop_.stop_requested()) throw Error(ErrorKind::kCancelled, "frames", "stopped");
  ready_.push_back(frame.clone());
  changed_.notify_all();
}

py::array Frames::next() {
  if (!wait_for(guard_, changed_, [&] { return !ready_.empty() || done_; })) {
    const py::error_already_set raised;
    close();
    throw py::error_already_set(raised);
  }
  std::unique_lock lock(guard_);
  if (!ready_.empty()) {
    const cv::Mat frame = ready_.front();
    ready_.pop_front();
    changed_.notify_all();
    lock.unlock();
    return array_of(frame);
  }
  const std::exception_ptr fault = std::exchange(fault_, nullptr);
  lock.unlock();
  if (fault) std::rethrow_exception(fault);
  throw py::stop_iteration();
}

void Frames::close() {
  const py::gil_scoped_release unlocked;
  stop_.request_stop();
  {
    const std::lock_guard lock(guard_);
    ready_.clear();
    changed_.notify_all();
  }
  if (worker_.joinable()) worker_.join();
  const std::lock_guard lock(guard_);
  ready_.clear();
  fault_ = nullptr;
}

void bind_frames(py::module_& module) {
  py::class_<Frames>(module, "Frames", R"(Frames in the making: an iterator of read-only arrays, H x W x C.

The computation runs beside the caller, two frames ahead. It ends with the last frame, by close(), at the end of
a `with`, or when the iterator is dropped.)")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &Frames::next)
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](Frames& self, const py::args&) { self.close(); })
      .def("close", &Frames::close, "Ends the computation.");
}

}  // namespace freshet::python
