// tools/work/worker.h — takes tasks out of a queue, one after another, each run by a command of its own.
#pragma once

#include <filesystem>

#include "tools/console/run_context.h"
#include "work/queue.h"

namespace freshet::tools {

struct WorkerOptions {
  std::filesystem::path folder;  // that paths of tasks are relative to
  std::uint64_t tries = 3;       // faults after which a task is given up
  int threads = 0;               // of a command; 0: all cores
  bool until_empty = false;      // end once no task is queued or running on any machine
};

/// Until the queue is empty, where that was asked for, or it is stopped: the task in hand is then handed back within a
/// second.
/// Throws Error{kCancelled}.
void run_worker(work::Queue& queue, const work::QueueOptions& queue_options, const WorkerOptions& options,
                const RunContext& context);

}  // namespace freshet::tools
