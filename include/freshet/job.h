// include/freshet/job.h — how a caller follows a long computation, and ends it.
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>
#include <string>

namespace freshet {

/// Where a computation stands.
struct Progress {
  std::string stage;             // for a person: "searching candidates"
  std::size_t done = 0, of = 0;  // of the stage; `of` is 0 where there is nothing to count
};
using ProgressFunction = std::function<void(const Progress&)>;

/// What every function that takes its time is given last.
struct Job {
  /// Called now and then, one call at a time; may be empty. What it throws ends the computation.
  ProgressFunction progress{};
  /// A request to stop ends the computation soon, with Error{kCancelled}; files are left as they were before.
  std::stop_token stop{};
};

}  // namespace freshet
