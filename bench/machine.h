// bench/machine.h — what a measurement was made on, and clocks that stand a busy machine.
#pragma once

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

}  // namespace freshet::bench
