#include "tools/console/run_context.h"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/core/utility.hpp>

#include "tools/console/progress.h"

namespace freshet::tools {
namespace {

std::atomic<int> caught{0};

}  // namespace

StopOnSignal::StopOnSignal() {
  // All threads made later inherit the mask, so that only the one below ever takes a signal.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals, source = source_]() mutable {
    for (;;) {
      int number = 0;
      if (sigwait(&signals, &number) != 0) continue;
      if (caught.exchange(number) != 0) std::_Exit(128 + number);
      source.request_stop();
    }
  }).detach();
}

int StopOnSignal::signal() const { return caught.load(); }

void use_threads(int n) {
  static std::unique_ptr<oneapi::tbb::global_control> limit;
  limit.reset();
  if (n > 0)
    limit = std::make_unique<oneapi::tbb::global_control>(
        oneapi::tbb::global_control::max_allowed_parallelism, n);
}

void add_threads(CLI::App& command) {
  command
      .add_option_function<int>(
          "-j,--threads", [](int n) { use_threads(n); },
          "Threads to work with; results do not depend on it [all cores]")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
}

void add_short_help(CLI::App& command, const std::vector<std::string>& hidden) {
  std::vector<std::pair<CLI::Option*, std::string>> groups;
  for (const std::string& name : hidden)
    if (CLI::Option* const option = command.get_option_no_throw(name)) {
      groups.emplace_back(option, option->get_group());
      option->group("");
    }
  command
      .add_flag_callback(
          "--help-all",
          [groups] {
            for (const auto& [option, group] : groups) option->group(group);
            throw CLI::CallForHelp();
          },
          "Print all options: how patches are searched and chosen, and how frames are rendered, too")
      ->configurable(false);
}

void say(const std::string& message) {
  clear_progress_line();
  fmt::print(stderr, "freshet: {}\n", message);
}

}  // namespace freshet::tools
