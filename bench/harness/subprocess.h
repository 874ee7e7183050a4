// bench/harness/subprocess.h — a part of a measurement in a subprocess, a new process of the same program.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace freshet::bench {

/// Runs this program again and waits for its end. arguments   its argv, the name first. Throws Error{kIo}
/// with `subject` and `fault` when it cannot be run or does not exit with 0.
void run_subprocess(std::vector<std::string> arguments, const std::string& subject, const std::string& fault);

/// Bytes of this process, by /proc: "anonymous", "file" (pages of mapped files, the store's above all),
/// "peak" of both. Of this process alone: getrusage's peak would be its parent's, if that had more.
nlohmann::json memory_now();

}  // namespace freshet::bench
