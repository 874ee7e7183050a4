#include "work/command_run.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string_view>

#include <nlohmann/json.hpp>

#include "freshet/error.h"

namespace freshet::work {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

constexpr std::size_t kMostOutput = 4u << 20, kMostMessages = 200, kMostLine = 64u << 10;
constexpr int kNice = 5;

/// A pipe's ends, closed at the end.
struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
      throw Error(ErrorKind::kIo, "pipe", std::string("none can be made (") + std::strerror(errno) + ")");
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  void close_end(std::size_t end) {
    if (ends[end] >= 0) ::close(ends[end]);
    ends[end] = -1;
  }
};

pid_t start(const Command& command, const Pipe& out, const Pipe& err) {
  std::vector<std::string> words{command.program.string(), "--progress", "json"};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::vector<std::string> added = command.environment;
  std::vector<char*> variables;
  for (std::string& variable : added) variables.push_back(variable.data());
  for (char** variable = environ; *variable != nullptr; ++variable) variables.push_back(*variable);
  variables.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out.ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.ends[1], STDERR_FILENO);
  posix_spawn_file_actions_addchdir_np(&actions, command.folder.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // Signals that a server blocks for itself would be blocked in the command too, and it could not be stopped.
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t process = 0;
  const int fault =
      ::posix_spawn(&process, arguments[0], &actions, &attributes, arguments.data(), variables.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (fault != 0)
    throw Error(ErrorKind::kIo, command.program.string(),
                std::string("cannot be started (") + std::strerror(fault) + ")");
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(process), kNice);
  return process;
}

/// Sorts what a command says into progress and messages.
class Listener {
 public:
  Listener(const Job& job, CommandAnswer& answer) : job_(job), answer_(answer) {}
  void hear(std::string_view bytes) {
    for (const char c : bytes) {
      if (c != '\n' && line_.size() < kMostLine) line_ += c;
      if (c == '\n') end_line();
    }
  }
  void end_line() {
    if (line_.starts_with('{')) {
      const Json json = Json::parse(line_, nullptr, false);
      if (json.is_object() && json.contains("stage") && job_.progress)
        job_.progress(
            {json.value("stage", ""), json.value("done", std::size_t{0}), json.value("of", std::size_t{0})});
    } else if (!line_.empty()) {
      constexpr std::string_view kName = "freshet: ";
      answer_.messages.push_back(line_.starts_with(kName) ? line_.substr(kName.size()) : line_);
      if (answer_.messages.size() > kMostMessages) answer_.messages.erase(answer_.messages.begin());
    }
    line_.clear();
  }

 private:
  const Job& job_;
  CommandAnswer& answer_;
  std::string line_;
};

/// One read of what is there. False at the end.
bool take(int fd, std::string& into) {
  std::array<char, 16384> buffer;
  const ssize_t got = ::read(fd, buffer.data(), buffer.size());
  if (got < 0) return errno == EINTR || errno == EAGAIN;
  into.assign(buffer.data(), static_cast<std::size_t>(got));
  return got > 0;
}

void listen_to(pid_t process, Pipe& out, Pipe& err, const Command& command, const Job& job,
               CommandAnswer& answer) {
  Listener listener(job, answer);
  std::optional<Clock::time_point> asked;
  bool out_open = true, err_open = true;
  while (out_open || err_open) {
    if (job.stop.stop_requested() && !asked) {
      ::kill(process, SIGINT);
      asked = Clock::now();
    }
    if (asked && Clock::now() - *asked > command.patience) ::kill(process, SIGKILL);
    std::array<pollfd, 2> ends{
        {{out_open ? out.ends[0] : -1, POLLIN, 0}, {err_open ? err.ends[0] : -1, POLLIN, 0}}};
    if (::poll(ends.data(), ends.size(), 50) <= 0) continue;
    std::string bytes;
    if (ends[0].revents != 0) {
      out_open = take(out.ends[0], bytes);
      if (answer.output.size() + bytes.size() <= kMostOutput) answer.output += bytes;
    }
    bytes.clear();
    if (ends[1].revents != 0) {
      err_open = take(err.ends[0], bytes);
      listener.hear(bytes);
    }
  }
  listener.end_line();
}

}  // namespace

void end_with_starter() {
  const char* const starter = std::getenv(kEndsWith);
  if (starter == nullptr) return;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (std::to_string(::getppid()) != starter) std::_Exit(1);  // it has ended meanwhile
  ::unsetenv(kEndsWith);                                      // it is not for those that this one starts
}

std::string to_text(const Command& command) {
  std::string text = "freshet";
  for (const std::string& word : command.arguments) {
    const bool plain = !word.empty() && word.find_first_not_of(
                                            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                            "_-./=,:%+@") == std::string::npos;
    std::string quoted;
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    text += plain ? " " + word : " '" + quoted + "'";
  }
  return text;
}

CommandAnswer run_to_end(const Command& command, const Job& job) {
  CommandAnswer answer;
  Pipe out, err;
  const pid_t process = start(command, out, err);
  out.close_end(1);
  err.close_end(1);
  try {
    listen_to(process, out, err, command, job, answer);
  } catch (...) {
    ::kill(process, SIGKILL);
    ::waitpid(process, nullptr, 0);
    throw;
  }
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) continue;
  if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "freshet", "stopped");
  if (WIFSIGNALED(status)) answer.messages.push_back("ended by signal " + std::to_string(WTERMSIG(status)));
  answer.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return answer;
}

void expect_done(const Command& command, const CommandAnswer& answer) {
  constexpr std::size_t kTold = 4;  // of its last messages
  if (answer.exit_code == 0) return;
  std::string told;
  const std::size_t first = answer.messages.size() - std::min(kTold, answer.messages.size());
  for (std::size_t i = first; i < answer.messages.size(); ++i)
    told += (told.empty() ? "" : " ") + answer.messages[i];
  throw Error(ErrorKind::kIo, "freshet " + command.arguments.front(),
              told.empty() ? "ended without a word" : told);
}

CommandAnswer run(const Command& command, const Job& job) {
  CommandAnswer answer = run_to_end(command, job);
  expect_done(command, answer);
  return answer;
}

}  // namespace freshet::work
