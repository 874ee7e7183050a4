#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include "freshet/error.h"
#include "studio/http/server.h"
#include "studio/studio.h"
#include "tools/commands.h"
#include "tools/options/starter_option.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

struct StudioCommand {
  std::vector<std::string> given;  // stores and a picture, in any order
  std::string folder, address = "127.0.0.1", page;
  int port = 0;
  bool no_browser = false, no_starter = false;
};

fs::path own_path() {
  std::error_code fault;
  const fs::path path = fs::read_symlink("/proc/self/exe", fault);
  if (fault) throw Error(ErrorKind::kIo, "/proc/self/exe", "cannot be read");
  return path;
}

fs::path default_folder() {
  const char* const home = std::getenv("HOME");
  if (home == nullptr || *home == '\0')
    throw Error(ErrorKind::kUsage, "--folder", "there is no home to keep projects in", "Give a folder");
  return fs::path(home) / "freshet-studio";
}

/// Beside the executable as it was built, or as it was installed.
fs::path default_page(const fs::path& program) {
  const fs::path built = program.parent_path().parent_path() / "studio" / "page";
  if (fs::exists(built / "index.html")) return built;
  return program.parent_path().parent_path() / "share" / "freshet" / "studio";
}

/// Whether the page has made or taken some before.
bool has_stores(const fs::path& folder) {
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "stores", none))
    if (entry.path().extension() == ".freshet") return true;
  return false;
}

/// Opens the address in the desktop's browser, where there is a desktop.
void show(const std::string& url) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  const pid_t child = ::fork();
  if (child == 0) {
    if (::fork() == 0) ::execlp("xdg-open", "xdg-open", url.c_str(), static_cast<char*>(nullptr));
    std::_Exit(0);
  }
  if (child > 0) ::waitpid(child, nullptr, 0);
}

void run_studio(const StudioCommand& command, const RunContext& context) {
  const fs::path program = own_path();
  studio::StudioOptions options{
      .folder = command.folder.empty() ? default_folder() : fs::path(command.folder),
      .stores = {},
      .program = program};
  std::vector<fs::path> pictures;
  for (const std::string& path : command.given) {
    if (!fs::exists(path)) throw Error(ErrorKind::kInput, path, "there is no such file", "Check the name");
    (is_store(path) ? options.stores : pictures).push_back(fs::canonical(path));
  }
  if (pictures.size() > 1)
    throw Error(ErrorKind::kUsage, pictures[1].string(),
                "two pictures were given, and one is opened at first", "Open the other in the page");
  if (options.stores.empty() && !command.no_starter && !has_stores(options.folder))
    options.stores.push_back(starter_store(context));
  studio::Studio studio(options);
  const char* const token = std::getenv("FRESHET_STUDIO_TOKEN");
  studio::Server server(studio,
                        {.address = command.address,
                         .port = command.port,
                         .token = token == nullptr ? "" : token,
                         .page = command.page.empty() ? default_page(program) : fs::path(command.page)});
  std::string url = server.url();
  if (!pictures.empty()) {
    const studio::IncomingFile copy = studio.folder().incoming_file();
    fs::copy_file(pictures[0], copy.path());
    url += "#/" + studio.projects().open_picture(copy.path(), pictures[0].filename(),
                                                 options.stores.empty() ? "" : options.stores[0].string());
  }
  if (command.address != "127.0.0.1")
    say(fmt::format(
        "--listen {}: whoever reaches that address and knows the one below sees and changes the projects in "
        "{} and reads the stores that are open",
        command.address, options.folder.string()));
  fmt::print("{}\n", url);
  std::fflush(stdout);
  if (!command.no_browser) show(url);
  const std::stop_callback stop(context.stop, [&server] { server.stop(); });
  server.serve();
  throw Error(ErrorKind::kCancelled, "studio", "stopped");
}

}  // namespace

void add_studio(CLI::App& app, RunContext& context) {
  auto command = std::make_shared<StudioCommand>();
  CLI::App* sub = app.add_subcommand("studio",
                                     "Draw on a picture in the browser and see it move. Prints the address "
                                     "of its page, serves until Ctrl-C, and keeps "
                                     "what is drawn as it is drawn.");
  sub->add_option(
      "STORE_OR_PICTURE", command->given,
      "Stores to use [the starter store, which Freshet makes itself, once], and a picture to open");
  sub->add_option("--folder", command->folder, "Where projects are kept [~/freshet-studio]");
  sub->add_option("--port", command->port, "Port to listen on; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  sub->add_option(
         "--listen", command->address,
         "Address to listen on. Another than this machine's own opens projects and stores to whoever knows "
         "the token in the page's address; nothing is encrypted")
      ->capture_default_str();
  sub->add_option("--page", command->page, "Folder of the built page [beside the program]");
  sub->add_flag("--no-browser", command->no_browser, "Only print the address [off: the browser is opened]");
  sub->add_flag("--no-starter", command->no_starter,
                "Begin without a store where there is none [off: the starter store is opened]");
  add_threads(*sub);
  sub->callback([command, &context] {
    keeps_when_stopped("projects are kept");
    let_stop_take(std::chrono::seconds(5));  // it ends the commands that it runs
    run_studio(*command, context);
  });
}

}  // namespace freshet::tools
