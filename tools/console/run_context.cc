#include "tools/console/run_context.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/core/utility.hpp>

#include "platform/printable.h"
#include "tools/console/progress.h"

namespace freshet::tools {
namespace {

std::atomic<int> caught{0};
std::optional<std::set<std::string>> said;  // while a SayOnce lives

/// Some options are left out of the help, not of the command: CLI11's own way, a group without a name, takes their
/// names too, from messages and from whoever looks for outputs among the options.
class ShortHelp : public CLI::Formatter {
 public:
  explicit ShortHelp(std::vector<std::string> hidden) : hidden_(std::move(hidden)) {}
  void show_all() { hidden_.clear(); }
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    std::erase_if(options, [&](const CLI::Option* option) {
      return std::ranges::any_of(hidden_, [&](const std::string& name) { return option->check_name(name); });
    });
    return options.empty() ? "" : CLI::Formatter::make_group(std::move(group), is_positional, options);
  }

 private:
  std::vector<std::string> hidden_;
};

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
          "Number of threads; results do not depend on it [all cores]")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
}

void add_short_help(CLI::App& command, const std::vector<std::string>& hidden) {
  const auto formatter = std::make_shared<ShortHelp>(hidden);
  command.formatter(formatter);
  command
      .add_flag_callback(
          "--help-all",
          [formatter] {
            formatter->show_all();
            throw CLI::CallForHelp();
          },
          "Print all options: how patches are searched and chosen, and how frames are rendered, too")
      ->configurable(false);
}

SayOnce::SayOnce() { said.emplace(); }
SayOnce::~SayOnce() { said.reset(); }

void say(const std::string& message) {
  if (said && !said->insert(message).second) return;
  clear_progress_line();
  fmt::print(stderr, "freshet: {}\n", printable_lines(message));
}

}  // namespace freshet::tools
