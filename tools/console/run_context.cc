#include "tools/console/run_context.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/core/utility.hpp>

#include "platform/printable.h"
#include "platform/unfinished_files.h"
#include "tools/console/progress.h"

namespace freshet::tools {
namespace {

std::atomic<int> caught{0};
std::atomic<std::chrono::milliseconds> time_to_stop{std::chrono::milliseconds(700)};
std::mutex guard;
std::string kept;                           // by guard
std::optional<std::set<std::string>> said;  // while a SayOnce lives

constexpr const char* kInDetail = ", in detail";

/// Some options are left out of the help, not of the command: CLI11's own way, a group without a name, takes their
/// names too, from messages and from whoever looks for outputs among the options.
class ShortHelp : public CLI::Formatter {
 public:
  void show_all() { all_ = true; }
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    if (!all_ && group.ends_with(kInDetail)) return "";
    return CLI::Formatter::make_group(std::move(group), is_positional, options);
  }
  /// Without the empty lines between groups that are left out.
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
    for (std::size_t at = text.find("\n\n\n"); at != std::string::npos; at = text.find("\n\n\n", at))
      text.erase(at, 1);
    return text;
  }

 private:
  bool all_ = false;
};

/// A message that quotes a name of a megabyte keeps what it begins with, where and what, and its end, the remedy.
std::string shortened(const std::string& message) {
  constexpr std::size_t kMax = 4000, kBegin = 2500, kEnd = 1000;
  if (message.size() <= kMax) return message;
  return fmt::format("{} ... ({} bytes more) ... {}", message.substr(0, kBegin),
                     message.size() - kBegin - kEnd, message.substr(message.size() - kEnd));
}

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
      caught = number;
      // Whoever is asked may take its time as well.
      std::thread([source]() mutable { source.request_stop(); }).detach();
      const std::chrono::milliseconds patience = time_to_stop.load();
      const timespec wait{.tv_sec = patience.count() / 1000, .tv_nsec = patience.count() % 1000 * 1'000'000};
      if (sigtimedwait(&signals, nullptr, &wait) > 0) std::_Exit(128 + number);
      end();
    }
  }).detach();
}

int StopOnSignal::signal() const { return caught.load(); }

void StopOnSignal::end() {
  remove_unfinished_files();
  std::string text = "freshet: stopped; ";
  {
    const std::lock_guard lock(guard);
    text += kept.empty() ? "nothing unfinished was kept" : printable_lines(kept);
  }
  text += "\n";
  // Not through a stream, which another thread may hold; nor into a pipe that is full and that nobody reads.
  pollfd stderr_now{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
  std::signal(SIGPIPE, SIG_IGN);
  if (poll(&stderr_now, 1, 0) > 0) {
    clear_progress_line();
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
  }
  const int number = caught.load();
  std::signal(number, SIG_DFL);
  std::raise(number);  // to this thread: another waits for those that come to the process
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, number);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  std::_Exit(128 + number);
}

void keeps_when_stopped(const std::string& what) {
  const std::lock_guard lock(guard);
  kept = what;
}

void let_stop_take(std::chrono::milliseconds time) { time_to_stop = time; }

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

std::string in_detail(const std::string& group) { return group + kInDetail; }

void add_short_help(CLI::App& command) {
  const auto formatter = std::make_shared<ShortHelp>();
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
  tell(fmt::format("freshet: {}\n", printable_lines(shortened(message))));
}

}  // namespace freshet::tools
