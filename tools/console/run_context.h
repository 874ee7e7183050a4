// tools/console/run_context.h — what every command shares: threads, stopping, messages.
#pragma once

#include <chrono>
#include <stop_token>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace freshet::tools {

/// Runs with SIGINT and SIGTERM turned into a stop request. Work that does not heed it in time (a library is decoding,
/// a system of equations is being solved) is ended with the process, as it is at once by a second signal: a store holds
/// what was committed, and files under temporary names are removed.
class StopOnSignal {
 public:
  StopOnSignal();
  std::stop_token token() const { return source_.get_token(); }
  /// The signal that came, or 0.
  int signal() const;
  /// Says that the command was stopped, and what it leaves, and dies of the signal that came, so that a calling shell
  /// script stops too.
  [[noreturn]] static void end();

 private:
  std::stop_source source_;
};

/// What main() hands to every command.
struct RunContext {
  std::stop_token stop;
  int exit_code = 0;  // set by a command that ends well but has something to report (a damaged store)
};

/// What a command leaves when it is stopped, for a person; empty: nothing. From any thread.
void keeps_when_stopped(const std::string& what);
/// For how long a command may go on after a request to stop. [.7 s]
void let_stop_take(std::chrono::milliseconds time);

/// The option -j of commands that compute. Applied when the option is parsed.
void add_threads(CLI::App& command);
/// Limits all work to n threads; 0 means all cores.
void use_threads(int n);

/// The group of options that a short help leaves out, beside `group`.
std::string in_detail(const std::string& group);
/// Leaves options of such groups out of --help, and adds --help-all, which explains them too.
void add_short_help(CLI::App& command);

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
