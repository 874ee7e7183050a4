// tools/console/progress.h — how far long work has come: a bar on a terminal, plain lines elsewhere.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "freshet/job.h"

namespace freshet::tools {

/// What a command will go through, by the names that the libraries give their stages. From then on Progress shows
/// their numbers, and these words instead of a name where there are some: "[3/7] searching candidates". Stages that
/// are passed over keep their numbers.
struct PlannedStage {
  std::string name, words;
};
void plan_stages(std::vector<PlannedStage> stages);

/// The option --progress of all commands: for programs that run them. Applied when the option is parsed.
void add_progress(CLI::App& app);

/// Shows `done of total` with rate and time left, on stderr. On a terminal one line is redrawn at most ten
/// times a second; elsewhere a line is printed when a stage begins and then every 30 s: logs
/// stay short. With --progress json a line of JSON is printed at most ten times a second.
class Progress {
 public:
  ~Progress();
  /// unit   what is counted: "frames", "pieces", ...
  void show(const std::string& stage, std::size_t done, std::size_t total, const std::string& unit = "");
  /// As the libraries take it; must not outlive this.
  ProgressFunction callback() & {
    return [this](const freshet::Progress& at) { show(at.stage, at.done, at.of); };
  }
  /// Ends the line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  std::string stage_;
  Clock::time_point stage_start_{}, last_shown_{};
  std::size_t first_done_ = 0;
};

/// Writes to stderr. Where that cannot be written (a full disk, a pipe that nobody reads) nothing happens: no command
/// fails for what it would have said.
void tell(std::string_view text);

/// Removes a half-drawn bar, before something else is written to stderr.
void clear_progress_line();

}  // namespace freshet::tools
