// tests/tools/work_folder.h — a temporary folder that commands run in, and what they answered.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/kept_loaded.h"

namespace freshet::tools {

struct Outcome {
  int exit_code = -1;  // -1 when a signal ended it
  int signal = 0;
  std::string out, err;
  long peak_kib = 0;  // resident memory of the largest process of it
};

/// A command that has been started and not yet been waited for.
struct Started {
  pid_t process = 0;
  std::filesystem::path out, err;
};

class WorkFolder {
 public:
  WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  ~WorkFolder();

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path file(const std::string& name, const std::string& text) const;

  /// Runs a program (found along PATH) in this folder, with nothing on stdin.
  Outcome run(const std::vector<std::string>& command) const;
  /// Runs the executable under test, which is loaded once and forked for each run, and ends with its main; killed after
  /// ten minutes. Under sanitizers it is run as it is.
  Outcome freshet(const std::vector<std::string>& arguments) const;
  /// The same under a shell's preparation, such as a limit: PREPARATION; exec freshet ARGUMENTS.
  Outcome freshet_after(const std::string& preparation, const std::vector<std::string>& arguments) const;

  Started start(const std::vector<std::string>& command) const;
  /// The executable under test, kept loaded: it runs to the end of its process, or is killed by SIGALRM.
  Started start_freshet(const std::vector<std::string>& arguments, int limit_s = 120,
                        const std::vector<std::string>& environment = {}) const;
  Started start(const KeptLoaded& executable, const std::vector<std::string>& arguments, int limit_s,
                const std::vector<std::string>& environment = {}) const;
  static Outcome wait(const Started& started);

 private:
  /// Files for what a command will say; it is yet to be started. They lie beside the folder, which a test may list.
  Started named() const;

  std::filesystem::path path_;
};

/// The path of the executable under test.
std::string executable();

std::string text_of(const std::filesystem::path& file);
std::vector<std::string> lines_of(const std::string& text);
/// The pictures of a folder, by name. mode   as cv::imread has it.
std::vector<cv::Mat> read_frames(const std::filesystem::path& folder, int mode = cv::IMREAD_COLOR);

/// The digest of a store, which must be whole.
std::string digest(const std::filesystem::path& store);

}  // namespace freshet::tools
