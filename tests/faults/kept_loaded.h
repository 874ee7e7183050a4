// tests/faults/kept_loaded.h — the executable, loaded once and forked for each run.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "tests/tools/work_folder.h"

namespace freshet::tools {

/// Loading the executable takes longer than what most runs of a campaign do. From many threads.
class KeptLoaded {
 public:
  /// preloaded   A library that is begun anew in each run; none when empty.
  explicit KeptLoaded(const std::string& preloaded);
  KeptLoaded(const KeptLoaded&) = delete;
  KeptLoaded& operator=(const KeptLoaded&) = delete;
  ~KeptLoaded();

  /// As WorkFolder::start runs it; killed by SIGALRM after two minutes.
  /// environment   NAME=VALUE, beside what was there when it was loaded.
  Started start(const WorkFolder& folder, const std::vector<std::string>& arguments,
                const std::vector<std::string>& environment = {}) const;

 private:
  mutable std::mutex mutex_;
  int socket_ = -1;
  pid_t process_ = 0;
};

}  // namespace freshet::tools
