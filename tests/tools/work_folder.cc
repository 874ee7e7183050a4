#include "tests/tools/work_folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>
#include <iterator>
#include <sstream>

namespace freshet::tools {

namespace fs = std::filesystem;

namespace {

const KeptLoaded& kept() {
  static const KeptLoaded made("");
  return made;
}

}  // namespace

WorkFolder::WorkFolder() {
  static std::atomic<int> count{0};
  path_ = fs::temp_directory_path() /
          ("freshet_tools_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
  fs::create_directories(path_);
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path WorkFolder::file(const std::string& name, const std::string& text) const {
  std::ofstream(path_ / name, std::ios::binary) << text;
  return path_ / name;
}

Started WorkFolder::named() const {
  static std::atomic<int> count{0};
  const std::string number = std::to_string(count++);
  // Files, not pipes: nothing then waits for a reader.
  return {.out = path_.string() + ".out" + number, .err = path_.string() + ".err" + number};
}

Started WorkFolder::start(const std::vector<std::string>& command) const {
  Started started = named();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, started.out.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, started.err.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addchdir_np(&actions, path_.c_str());
  started.process = spawned(command, environ, &actions);
  posix_spawn_file_actions_destroy(&actions);
  return started;
}

Started WorkFolder::start(const KeptLoaded& executable, const std::vector<std::string>& arguments,
                          int limit_s, const std::vector<std::string>& environment) const {
  Started started = named();
  started.process = executable.start({.folder = path_,
                                      .out = started.out,
                                      .err = started.err,
                                      .limit_s = limit_s,
                                      .environment = environment},
                                     arguments);
  return started;
}

Started WorkFolder::start_freshet(const std::vector<std::string>& arguments, int limit_s,
                                  const std::vector<std::string>& environment) const {
  return start(kept(), arguments, limit_s, environment);
}

Outcome WorkFolder::wait(const Started& started) {
  Outcome outcome;
  int status = 0;
  rusage usage{};
  if (started.process > 0 && ::wait4(started.process, &status, 0, &usage) == started.process) {
    outcome.peak_kib = usage.ru_maxrss;
    if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
    outcome.out = text_of(started.out);
    outcome.err = text_of(started.err);
  }
  fs::remove(started.out);
  fs::remove(started.err);
  return outcome;
}

Outcome WorkFolder::run(const std::vector<std::string>& command) const { return wait(start(command)); }

Outcome WorkFolder::freshet(const std::vector<std::string>& arguments) const {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // which want to be loaded first
  std::vector<std::string> command{executable()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return run(command);
#else
  return wait(start(kept(), arguments, 600, {"FRESHET_LEAVE_AT_ONCE=1"}));
#endif
}

Outcome WorkFolder::freshet_after(const std::string& preparation,
                                  const std::vector<std::string>& arguments) const {
  std::vector<std::string> command{"sh", "-c", preparation + "; exec \"$@\"", "sh", executable()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return run(command);
}

std::string executable() { return FRESHET_EXECUTABLE; }

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string digest(const fs::path& store) {
  const Outcome outcome = WorkFolder().freshet({"store", "digest", store});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.out;
}

std::vector<cv::Mat> read_frames(const fs::path& folder, int mode) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<cv::Mat> frames;
  for (const fs::path& file : files) frames.push_back(cv::imread(file, mode));
  return frames;
}

}  // namespace freshet::tools
