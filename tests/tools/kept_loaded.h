// tests/tools/kept_loaded.h — the executable, loaded once and forked for each run.
#pragma once

#include <spawn.h>
#include <sys/types.h>

#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

namespace freshet::tools {

/// Starts a program, found along PATH. actions   on its descriptors; null: none. The process; 0: it cannot be started.
pid_t spawned(const std::vector<std::string>& command, char** environment,
              const posix_spawn_file_actions_t* actions = nullptr);

/// Loading the executable takes longer than what most runs of a test do. From many threads.
class KeptLoaded {
 public:
  /// preloaded   A library that is begun anew in each run; none when empty.
  explicit KeptLoaded(const std::string& preloaded);
  KeptLoaded(const KeptLoaded&) = delete;
  KeptLoaded& operator=(const KeptLoaded&) = delete;
  ~KeptLoaded();

  struct Run {
    std::filesystem::path folder, out, err;     // out, err   files for what it says
    int limit_s = 120;                          // killed by SIGALRM after it
    std::vector<std::string> environment = {};  // NAME=VALUE, beside what was there when it was loaded
  };
  /// A child of this process.
  pid_t start(const Run& run, const std::vector<std::string>& arguments) const;

 private:
  mutable std::mutex mutex_;
  int socket_ = -1;
  pid_t process_ = 0;
};

}  // namespace freshet::tools
