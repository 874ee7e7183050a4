// bench/harness/machine.h — what a measurement was made on, and its clocks.
#pragma once

#include <sys/resource.h>

#include <cstddef>

#include "report/machine.h"

namespace freshet::bench {

using report::allocated_bytes;
using report::Machine;
using report::process_seconds;
using report::this_machine;
using report::thread_seconds;
using report::to_json;
using report::to_string;
using report::wall_seconds;

/// The maximum memory that this process has held so far.
inline std::size_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

}  // namespace freshet::bench
