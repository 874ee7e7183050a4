#include "tools/console/progress.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "platform/printable.h"

namespace freshet::tools {
namespace {

bool on_terminal() {
  static const bool answer = isatty(STDERR_FILENO) != 0;
  return answer;
}
std::atomic<bool> line_is_drawn{false};
bool as_json = false;
std::vector<PlannedStage> planned;

std::string numbered(const std::string& stage) {
  for (std::size_t i = 0; i < planned.size(); ++i)
    if (planned[i].name == stage)
      return fmt::format("[{}/{}] {}", i + 1, planned.size(),
                         planned[i].words.empty() ? stage : planned[i].words);
  return stage;
}

std::string time_left(double seconds) {
  const int s = static_cast<int>(seconds + 0.5);
  return s >= 3600 ? fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
                   : fmt::format("{}:{:02}", s / 60, s % 60);
}

void print_json(const std::string& stage, std::size_t done, std::size_t total) {
  nlohmann::json json{{"stage", stage}, {"done", done}, {"of", total}};
  for (std::size_t i = 0; i < planned.size(); ++i) {
    if (planned[i].name != stage) continue;
    if (!planned[i].words.empty()) json["stage"] = planned[i].words;
    json["step"] = i + 1;
    json["steps"] = planned.size();
  }
  tell(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace

void add_progress(CLI::App& app) {
  app.add_option_function<std::string>(
         "--progress", [](const std::string& form) { as_json = form == "json"; },
         "How progress is told on stderr: text, or json, a line for each step: {\"stage\", \"done\", \"of\"} "
         "[text]")
      ->check(CLI::IsMember({"text", "json"}));
}

void plan_stages(std::vector<PlannedStage> stages) { planned = std::move(stages); }

void tell(std::string_view text) {
  sigset_t pipe, before;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipe, &before);
  if (std::fwrite(text.data(), 1, text.size(), stderr) != text.size() || std::fflush(stderr) != 0) {
    std::clearerr(stderr);
    const timespec at_once{};
    if (sigismember(&before, SIGPIPE) == 0) sigtimedwait(&pipe, nullptr, &at_once);
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

void clear_progress_line() {
  if (!line_is_drawn) return;
  tell("\r\033[K");
  line_is_drawn = false;
}

Progress::~Progress() { finish(); }

void Progress::finish() { clear_progress_line(); }

void Progress::show(const std::string& stage, std::size_t done, std::size_t total, const std::string& unit) {
  const Clock::time_point now = Clock::now();
  const bool new_stage = stage != stage_;
  if (new_stage) {
    stage_ = stage;
    stage_start_ = now;
    first_done_ = done;
  }
  const auto since = now - last_shown_;
  const bool due = on_terminal() || as_json ? since > std::chrono::milliseconds(100) || done == total
                                            : since > std::chrono::seconds(30);
  if (!new_stage && !due) return;
  last_shown_ = now;
  if (as_json) return print_json(stage, done, total);

  const double elapsed = std::chrono::duration<double>(now - stage_start_).count();
  const double rate = elapsed > 0.2 ? static_cast<double>(done - std::min(done, first_done_)) / elapsed : 0;
  std::string text = printable(numbered(stage));
  if (total > 0)
    text += fmt::format(" {}/{}", done, total);
  else if (done > 0)
    text += fmt::format(" {}", done);
  if (!unit.empty() && (total > 0 || done > 0)) text += " " + unit;
  if (rate > 0) text += fmt::format(", {:.{}f}/s", rate, rate < 10 ? 1 : 0);
  if (rate > 0 && total > done)
    text += fmt::format(", {} left", time_left(static_cast<double>(total - done) / rate));
  if (on_terminal()) {
    constexpr std::size_t kWidth = 24;
    const std::size_t full = total > 0 ? std::min(kWidth, kWidth * done / total) : 0;
    tell(fmt::format("\r\033[K[{}{}] {}", std::string(full, '='), std::string(kWidth - full, ' '), text));
    line_is_drawn = true;
  } else {
    tell(text + "\n");
  }
}

}  // namespace freshet::tools
