// bench/machine.h — what a measurement was made on, and clocks that stand a busy machine.
#pragma once

#include <sys/resource.h>

#include <cstddef>

#include "query/benchmark/machine.h"

namespace freshet::bench {

using query::allocated_bytes;
using query::Machine;
using query::process_seconds;
using query::this_machine;
using query::thread_seconds;
using query::to_json;
using query::to_string;
using query::wall_seconds;

/// The most memory that this process has held so far.
inline std::size_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

}  // namespace freshet::bench
