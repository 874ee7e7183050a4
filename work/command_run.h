// work/command_run.h — a command of freshet, run beside this process: what takes minutes, or reads what a stranger
// made, takes nothing with it when it fails.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "freshet/job.h"

namespace freshet::work {

struct Command {
  std::filesystem::path program;
  std::vector<std::string> arguments;        // without the program's name and --progress
  std::filesystem::path folder;              // in which it runs
  std::vector<std::string> environment{};    // NAME=VALUE, beside ours
  std::chrono::milliseconds patience{5000};  // between asking it to stop and making it
};

/// A variable that names a process, with which freshet ends whatever ends that: KILL too.
inline constexpr const char* kEndsWith = "FRESHET_ENDS_WITH";
/// Heeds it. Called first of all.
void end_with_starter();

/// As one would type it in that folder: "freshet synth animate --config project.toml -o 'a film.mp4'".
std::string to_text(const Command& command);

struct CommandAnswer {
  std::string output;                 // of its stdout, at most 4 MB
  std::vector<std::string> messages;  // of its stderr, without its name; the last 200
  int exit_code = 0;                  // -1: a signal ended it
};

/// Waits for it, at a lower priority than ours. A stop request interrupts it, so that it removes what it has begun.
/// Throws Error{kCancelled}.
CommandAnswer run_to_end(const Command& command, const Job& job);
/// Throws Error{kIo} with its last messages when it has failed.
void expect_done(const Command& command, const CommandAnswer& answer);
/// Both.
CommandAnswer run(const Command& command, const Job& job);

}  // namespace freshet::work
