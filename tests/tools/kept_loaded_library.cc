// A library to be preloaded: the executable stops before its main, and runs that in a child for each request. Loading
// the executable takes longer than most runs of a test.
//
// FRESHET_KEPT_LOADED   The descriptor of a socket of packets. A request: words that end in 0 each: the folder, the
//                       files for stdout and stderr, seconds after which it is killed, the number of variables of the
//                       environment, these as NAME=VALUE, the arguments. The answer: a pid_t, 0 when there is none.
//                       Who asks must have made itself a subreaper: the child is its own then.
//
// FRESHET_LEAVE_AT_ONCE In a request's environment: when main has ended, destructors of libraries are not run. They
//                       take a third of a short run.
//
// Where another preloaded library takes main's place too, that one stands before this in LD_PRELOAD: it is then begun
// anew in each child.

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

int (*true_main)(int, char**, char**);

std::vector<char*> words_of(std::vector<char>& request) {
  std::vector<char*> words;
  for (std::size_t at = 0; at < request.size(); at += std::char_traits<char>::length(&request[at]) + 1)
    words.push_back(&request[at]);
  return words;
}

void stand_at(const char* file, int flags, int descriptor) {
  const int opened = open(file, flags, 0600);
  if (opened < 0 || dup2(opened, descriptor) < 0) std::abort();
  close(opened);
}

int run(std::vector<char>& request) {
  std::vector<char*> words = words_of(request);
  if (words.size() < 5 || chdir(words[0]) != 0) std::abort();
  stand_at("/dev/null", O_RDONLY, STDIN_FILENO);
  stand_at(words[1], O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
  stand_at(words[2], O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
  alarm(static_cast<unsigned>(std::atoi(words[3])));
  std::size_t at = 5;
  for (int variables = std::atoi(words[4]); variables > 0; --variables) {
    const std::string variable = words.at(at++);
    const std::size_t name = variable.find('=');
    setenv(variable.substr(0, name).c_str(), variable.substr(name + 1).c_str(), 1);
  }
  const int count = static_cast<int>(words.size() - at);
  words.push_back(nullptr);
  const int code = true_main(count, words.data() + at, environ);
  if (getenv("FRESHET_LEAVE_AT_ONCE") == nullptr) return code;
  std::fflush(nullptr);
  _exit(code);
}

int serve(int count, char** arguments, char** environment) {
  const char* const socket = std::getenv("FRESHET_KEPT_LOADED");
  if (socket == nullptr) return true_main(count, arguments, environment);
  const int asked = std::atoi(socket);
  unsetenv("FRESHET_KEPT_LOADED");
  unsetenv("LD_PRELOAD");
  void* const shared =
      mmap(nullptr, sizeof(pid_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return 1;
  auto* const child = static_cast<pid_t*>(shared);
  for (std::vector<char> request(1 << 16);; request.resize(1 << 16)) {
    const ssize_t size = recv(asked, request.data(), request.size(), 0);
    if (size <= 0) _exit(0);
    request.resize(static_cast<std::size_t>(size));
    *child = 0;
    // Forked twice: whose parent has ended becomes the subreaper's.
    const pid_t between = vfork();  // copies nothing
    if (between == 0) {
      const pid_t forked = fork();
      if (forked == 0) {
        close(asked);
        return run(request);
      }
      *child = forked > 0 ? forked : 0;
      _exit(0);
    }
    waitpid(between, nullptr, 0);
    if (send(asked, child, sizeof *child, 0) != sizeof *child) _exit(0);
  }
}

}  // namespace

extern "C" int __libc_start_main(int (*main)(int, char**, char**), int count, char** arguments,
                                 void (*init)(), void (*fini)(), void (*loader_fini)(), void* stack_end) {
  using Start = int(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*);
  true_main = main;
  auto* const start = reinterpret_cast<Start*>(dlsym(RTLD_NEXT, "__libc_start_main"));
  return start(serve, count, arguments, init, fini, loader_fini, stack_end);
}
