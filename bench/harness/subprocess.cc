#include "bench/harness/subprocess.h"

#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <utility>

#include "freshet/error.h"

namespace freshet::bench {

void run_subprocess(std::vector<std::string> arguments, const std::string& subject,
                    const std::string& fault) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    execv("/proc/self/exe", argv.data());
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || status != 0)
    throw Error(ErrorKind::kIo, subject, fault, "See what it printed above; memory may not suffice");
}

nlohmann::json memory_now() {
  nlohmann::json memory;
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    for (const auto& [key, name] :
         {std::pair{"RssAnon:", "anonymous"}, std::pair{"RssFile:", "file"}, std::pair{"VmHWM:", "peak"}}) {
      if (line.starts_with(key)) memory[name] = 1024 * std::stoull(line.substr(std::string(key).size()));
    }
  }
  return memory;
}

}  // namespace freshet::bench
