// freshet: one executable, a subcommand for each tool. Results go to stdout, everything else to stderr.

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>

#include "freshet/error.h"
#include "platform/allocation.h"
#include "platform/standard_descriptors.h"
#include "platform/text_file.h"
#include "tools/commands.h"
#include "tools/console/numbers.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/console/toml_options.h"
#include "work/command_run.h"

namespace {

constexpr const char* kFooter = R"(
A first animation, from a picture alone (the starter store is made once, and kept):
  freshet synth animate PICTURE.png --matte MATTE.png --direction down -o OUT.mp4

With clips of your own:
  freshet ingest water.store CLIPS/               clips into a store (folders in CLIPS name the classes)
  freshet query candidates water.store PICTURE.png --sheet candidates.png
  freshet synth animate water.store PICTURE.png --matte MATTE.png --direction down -o OUT.mp4

Any option can stand in a TOML file, under a table named after the command, and be read with --config FILE:
  [synth.animate]
  frames = 120

Exit codes: 0 done, 1 failed, 2 wrong usage, 3 the store is damaged.)";

constexpr const char* kNoMemory =
    "not enough memory; close other programs, or use a smaller picture or fewer frames";

/// What is wrong with a command line, and where to read how it should be.
std::string usage_fault(const CLI::App& app, const CLI::ParseError& fault) {
  const CLI::App* command = &app;
  std::string name = app.get_name();
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    name += " " + command->get_name();
  }
  std::string text = fault.what();
  const auto below = command->get_subcommands([](const CLI::App*) { return true; });
  if (fault.get_name() == "ConfigError") {
    const std::string item = text.substr(text.rfind(' ') + 1);
    text = fmt::format("{}: \"{}\" names no option. It is a TOML file with a table for each command",
                       app.get_config_ptr()->as<std::string>(), item);
  } else if (!below.empty() && fault.get_name() == "RequiredError") {
    const std::vector<std::string> extras = app.remaining(true);
    std::string names;
    for (const CLI::App* each : below) names += (names.empty() ? "" : ", ") + each->get_name();
    text = extras.empty() ? fmt::format("a command is missing; there are {}", names)
                          : fmt::format("there is no command \"{}\"; there are {}", extras.front(), names);
  }
  return fmt::format("{}. See {} --help", text, name);
}

/// A result that did not reach its reader is no success: 0 would say that it had.
void finish_output() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  const int code = errno;
  if (code == EBADF)
    throw freshet::Error(freshet::ErrorKind::kIo, "standard output", "cannot be written: it is closed",
                         "Send it somewhere, and run again");
  throw freshet::Error(freshet::ErrorKind::kIo, "standard output",
                       fmt::format("cannot be written ({})", std::strerror(code)),
                       "Free space on the disk, or send it elsewhere, and run again");
}

/// Throws Error{kUsage} for a file of options that is none. One that is not there, CLI11 names itself.
void check_options_file(const std::string& file) {
  constexpr std::size_t kMaxBytes = 1 << 20, kDeepest = 16;
  if (!std::filesystem::exists(file)) return;
  try {
    const std::string remedy = "Give a TOML file with a table for each command";
    const std::string text = freshet::read_text_file(file, kMaxBytes, remedy);
    freshet::expect_nesting(freshet::toml_nesting(text), kDeepest, file, remedy);
  } catch (const freshet::Error& fault) {
    std::string text = fault.what();
    text.pop_back();  // its full stop
    throw freshet::Error(freshet::ErrorKind::kUsage, "--config", text);
  }
}

int exit_code(freshet::ErrorKind kind) {
  switch (kind) {
    case freshet::ErrorKind::kUsage:
      return 2;
    case freshet::ErrorKind::kDamaged:
      return 3;
    default:
      return 1;
  }
}

/// Where nothing can be allocated, nor a destructor run.
void write_plainly(std::string_view text) {
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
}

/// Of the mapped files, as the system lists them, that in which the address lies; empty when there is none. Calls
/// nothing that a signal's handler may not.
std::string_view mapped_file(std::uintptr_t address, std::span<char> line) {
  const int maps = ::open("/proc/self/maps", O_RDONLY | O_CLOEXEC);
  std::size_t length = 0;
  for (char c = 0; ::read(maps, &c, 1) == 1;) {
    if (c != '\n') {
      if (length < line.size()) line[length++] = c == '\t' || (c >= ' ' && c <= '~') ? c : '?';
      continue;
    }
    // "from-to mode offset device inode   /name"
    const char* const end = line.data() + length;
    std::uintptr_t first = 0, last = 0;
    const auto from = std::from_chars(line.data(), end, first, 16);
    std::from_chars(std::min(from.ptr + 1, end), end, last, 16);
    const std::string_view text(line.data(), length);
    if (const auto name = text.find('/'); first <= address && address < last && name != text.npos)
      return text.substr(name);
    length = 0;
  }
  return {};
}

/// A page of a mapped file that cannot be read: the disk failed, or another program has cut the file.
void end_at_unreadable_page(int, siginfo_t* info, void*) {
  char line[512];
  const std::string_view file = mapped_file(reinterpret_cast<std::uintptr_t>(info->si_addr), line);
  write_plainly("freshet: ");
  write_plainly(file.empty() ? "a mapped file, most likely the store" : file);
  write_plainly(
      ": a part of it could not be read: the disk has failed, or another program has cut\n"
      "the file. Run freshet store verify\n");
  ::_exit(1);
}

void handle_unreadable_pages() {
  struct sigaction action {};
  action.sa_sigaction = end_at_unreadable_page;
  action.sa_flags = SA_SIGINFO;
  ::sigaction(SIGBUS, &action, nullptr);
}

/// Whether memory was wanting: OpenCV's buffers throw an error of their own where one of several was not allocated.
bool lacks_memory(const std::exception& fault) {
  const auto* const opencv = dynamic_cast<const cv::Exception*>(&fault);
  return dynamic_cast<const std::bad_alloc*>(&fault) != nullptr ||
         (opencv != nullptr && (opencv->code == cv::Error::StsNoMem || opencv->func == "cleanup"));
}

/// An error that nothing can catch, thrown while another goes through or a destructor runs.
[[noreturn]] void end_uncaught() {
  try {
    if (std::current_exception()) throw;
    write_plainly("freshet: unexpected end. Please report it with the command line\n");
  } catch (const std::exception& fault) {
    if (lacks_memory(fault)) {
      write_plainly("freshet: not enough memory\n");
    } else {
      write_plainly("freshet: unexpected failure, which nothing could catch: ");
      write_plainly(fault.what());
      write_plainly(". Please report it with the command line\n");
    }
  } catch (...) {
    write_plainly("freshet: unexpected failure of no known kind. Please report it with the command line\n");
  }
  ::_exit(1);
}

int run(int argc, char** argv) {
  using namespace freshet;
  std::optional<StandardDescriptors> standing_in;
  try {
    standing_in.emplace();
  } catch (const Error&) {
    return 1;  // there is nowhere to say why
  }
  work::end_with_starter();
  keep_freed_memory();
  handle_unreadable_pages();
  std::set_terminate(end_uncaught);
  // OpenCV's own threads would compete with ours, which share out whole frames.
  cv::setNumThreads(1);
  const tools::StopOnSignal stop;
  tools::RunContext context{.stop = stop.token()};

  CLI::App app("Freshet: a patch database of fluid video, and still pictures animated with it.", "freshet");
  app.footer(kFooter);
  app.set_version_flag("--version", "freshet " FRESHET_VERSION);
  app.set_config("--config", "", "Read options from a TOML file")
      ->type_name("FILE")
      ->check(CLI::Validator(
          [](const std::string& file) {
            check_options_file(file);
            return std::string();
          },
          ""));
  app.config_formatter(std::make_shared<tools::TomlOptions>(app));
  tools::add_progress(app);
  app.parse_complete_callback([&app] {
    tools::refuse_non_numbers(app);
    tools::refuse_overwriting(app);
  });
  app.require_subcommand(1);
  app.allow_config_extras(CLI::config_extras_mode::error);  // a misspelt name must not be passed over
  app.fallthrough();                                        // --config may also stand behind a command
  tools::add_ingest(app, context);
  tools::add_index(app, context);
  tools::add_store(app, context);
  tools::add_query(app, context);
  tools::add_synth(app, context);
  tools::add_work(app, context);
  tools::add_studio(app, context);

  try {
    app.parse(argc, argv);
    finish_output();
    return context.exit_code;
  } catch (const CLI::ParseError& fault) {
    if (fault.get_exit_code() == 0) {  // --help, --version
      app.exit(fault);
      try {
        finish_output();
        return 0;
      } catch (const Error& lost) {
        tools::say(lost.what());
        return 1;
      }
    }
    tools::say(usage_fault(app, fault));
    return 2;
  } catch (const Error& fault) {
    if (fault.kind() == ErrorKind::kCancelled && stop.signal() != 0) tools::StopOnSignal::end();
    tools::say(fault.what());
    return exit_code(fault.kind());
  } catch (const std::exception& fault) {
    if (lacks_memory(fault)) {
      tools::say(kNoMemory);
      return 1;
    }
    if (std::ferror(stdout) != 0) {
      tools::say(fmt::format("standard output: cannot be written ({})", fault.what()));
      return 1;
    }
    tools::say(fmt::format("unexpected failure: {}. Please report it with the command line", fault.what()));
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {  // while the options were laid out, or in a message
    write_plainly("freshet: not enough memory\n");
    return 1;
  }
}
