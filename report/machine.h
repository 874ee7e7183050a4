// report/machine.h — what a measurement was made on, and clocks for it.
#pragma once

#include <fmt/format.h>
#include <malloc.h>
#include <oneapi/tbb/info.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "platform/vectors.h"

namespace freshet::report {

struct Machine {
  std::string processor, compiler, build;
  std::string vectors;  // the widest that hot loops use here (platform/vectors.h)
  int threads = 0;
};

inline std::string vectors_in_use() {
  const int bytes = vector_bytes();
  return bytes == 64 ? "AVX-512" : bytes == 32 ? "AVX2" : "plain";
}

inline Machine this_machine() {
  Machine machine{"unknown processor", __VERSION__, "release", vectors_in_use(),
                  oneapi::tbb::info::default_concurrency()};
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) {
      machine.processor = line.substr(line.find(':') + 2);
      break;
    }
  }
#ifndef NDEBUG
  machine.build = "with assertions: its times mean nothing";
#endif
  return machine;
}

inline std::string to_string(const Machine& machine) {
  return fmt::format("{}, {} threads, {} vectors, g++ {}, {}", machine.processor, machine.threads,
                     machine.vectors, machine.compiler, machine.build);
}

inline nlohmann::json to_json(const Machine& machine) {
  return {{"processor", machine.processor},
          {"compiler", machine.compiler},
          {"build", machine.build},
          {"vectors", machine.vectors},
          {"threads", machine.threads}};
}

/// CPU time of the calling thread, s: the figure of a core, whatever else the machine does. For work that
/// stays on one thread.
inline double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// CPU time of all threads together, s.
inline double process_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

inline double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Bytes that malloc has given out: differences are the size of what was built in between.
inline std::size_t allocated_bytes() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

}  // namespace freshet::report
