#include "tests/tools/kept_loaded.h"

#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

namespace freshet::tools {

pid_t spawned(const std::vector<std::string>& command, char** environment,
              const posix_spawn_file_actions_t* actions) {
  // A shell starts what runs in the background with SIGINT ignored, and what we start would ignore it too.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t heeded;
  sigemptyset(&heeded);
  for (const int signal : {SIGINT, SIGTERM}) sigaddset(&heeded, signal);
  posix_spawnattr_setsigdefault(&attributes, &heeded);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t process = 0;
  if (posix_spawnp(&process, arguments[0], actions, &attributes, arguments.data(), environment) != 0)
    process = 0;
  posix_spawnattr_destroy(&attributes);
  return process;
}

KeptLoaded::KeptLoaded(const std::string& preloaded) {
  int ends[2];
  if (prctl(PR_SET_CHILD_SUBREAPER, 1) != 0 ||
      socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error("the executable cannot be kept loaded");
  socket_ = ends[0];
  const int theirs = dup(ends[1]);  // which the program that is started keeps
  close(ends[1]);
  const std::string preload = "LD_PRELOAD=" + (preloaded.empty() ? "" : preloaded + ":") +
                              FRESHET_KEPT_LOADED_LIBRARY,
                    socket = "FRESHET_KEPT_LOADED=" + std::to_string(theirs);
  std::vector<char*> environment{const_cast<char*>(preload.c_str()), const_cast<char*>(socket.c_str())};
  for (char** each = environ; *each != nullptr; ++each) environment.push_back(*each);
  environment.push_back(nullptr);
  process_ = spawned({FRESHET_EXECUTABLE}, environment.data());
  close(theirs);
  if (process_ == 0) throw std::runtime_error(FRESHET_EXECUTABLE " cannot be started");
}

KeptLoaded::~KeptLoaded() {
  close(socket_);  // which ends it
  waitpid(process_, nullptr, 0);
}

pid_t KeptLoaded::start(const Run& run, const std::vector<std::string>& arguments) const {
  std::string request;
  const auto add = [&](const std::string& word) { request.append(word).push_back('\0'); };
  for (const std::string& word : {run.folder.string(), run.out.string(), run.err.string(),
                                  std::to_string(run.limit_s), std::to_string(run.environment.size())})
    add(word);
  for (const std::string& variable : run.environment) add(variable);
  add(FRESHET_EXECUTABLE);
  for (const std::string& argument : arguments) add(argument);
  pid_t process = 0;
  const std::lock_guard lock(mutex_);
  if (send(socket_, request.data(), request.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(request.size()) ||
      recv(socket_, &process, sizeof process, 0) != sizeof process)
    throw std::runtime_error("the executable that was kept loaded has ended");
  return process;
}

}  // namespace freshet::tools
