// tools/console/run_context.h — what every command shares: threads, stopping, messages.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace freshet::tools {

/// Runs with SIGINT and SIGTERM turned into a stop request; a second one ends the process at once.
class StopOnSignal {
 public:
  StopOnSignal();
  std::stop_token token() const { return source_.get_token(); }
  /// The signal that came, or 0.
  int signal() const;

 private:
  std::stop_source source_;
};

/// What main() hands to every command.
struct RunContext {
  std::stop_token stop;
  std::string kept = {};  // what a command that is stopped leaves, for a person; empty: nothing
  int exit_code = 0;      // set by a command that ends well but has something to report (a damaged store)
};

/// The option -j of commands that compute. Applied when the option is parsed.
void add_threads(CLI::App& command);
/// Limits all work to n threads; 0 means all cores.
void use_threads(int n);

/// Leaves these options out of --help, and adds --help-all, which explains them too. Called when all options are
/// there.
void add_short_help(CLI::App& command, const std::vector<std::string>& hidden);

/// A message for a person, on stderr, prefixed with the program's name.
void say(const std::string& message);

/// While one lives, equal messages are said once: of steps that are gone through again. One at a time.
class SayOnce {
 public:
  SayOnce();
  SayOnce(const SayOnce&) = delete;
  SayOnce& operator=(const SayOnce&) = delete;
  ~SayOnce();
};

}  // namespace freshet::tools
