// freshet work: shares of commands that wait in a queue, for machines that come and go.

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "platform/printable.h"
#include "synth/toml/section.h"
#include "tools/commands.h"
#include "tools/work/worker.h"
#include "work/command_run.h"
#include "work/queue.h"
#include "work/task.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

struct WorkCommand {
  work::QueueOptions queue;
  WorkerOptions worker;
  fs::path tasks;
  double ack_wait_s = 30;
  bool status = false, json = false;
};

/// A command of the file, and into how many tasks it is cut.
struct SharedWork {
  work::SharedCommand command;
  int shards = 1;
};

std::vector<SharedWork> read_tasks(const fs::path& file) {
  constexpr std::size_t kMaxTasks = 1000;
  const char* const remedy =
      "Give a TOML file of tables [[task]], each with run = [\"ingest\", ...] and shards";
  const synth::TomlText text(synth::toml_file_text(file, remedy), file, remedy);
  synth::Section root = text.root();
  std::vector<SharedWork> all;
  for (synth::Section& section : root.tables("task", kMaxTasks)) {
    std::vector<std::string> words = section.texts("run");
    int shards = 1;
    section.read("shards", shards, {1, work::kMaxShards});
    try {
      all.push_back({work::SharedCommand(std::move(words)), shards});
    } catch (const Error& fault) {
      std::string what = fault.what();
      what.pop_back();  // its full stop
      section.refuse("run", what);
    }
    section.done();
  }
  root.done();
  if (all.empty()) root.refuse_whole("names no task", remedy);
  return all;
}

std::string as_typed(const std::vector<std::string>& words) {
  return printable(work::to_text({.program = {}, .arguments = words, .folder = {}}));
}

void submit(const WorkCommand& command, work::Queue& queue, const RunContext& context) {
  for (const SharedWork& work : read_tasks(command.tasks)) {
    int put = 0;
    for (int i = 1; i <= work.shards; ++i) {
      if (context.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "work", "stopped");
      const work::Task task{work.command, {i, work.shards}};
      put += queue.put(task.key(), task.text()) ? 1 : 0;
    }
    fmt::print("{}: {} tasks put in, {} there already. When all are done: {}\n",
               as_typed(work.command.words()), put, work.shards - put, as_typed(work.command.gather_words()));
  }
}

void show_status(const WorkCommand& command, const work::Queue& queue) {
  const work::QueueStatus status = queue.status();
  nlohmann::json dead = nlohmann::json::array();
  std::string lines;
  for (const work::DeadTask& each : status.dead_tasks) {
    std::string name = each.text;
    try {
      const work::Task task = work::read_task(each.text);
      name = fmt::format("{}/{} of {}", task.shard.index, task.shard.count, as_typed(task.command.words()));
    } catch (const Error&) {  // it is dead because it is none
    }
    dead.push_back({{"task", name}, {"faults", each.fault.times}, {"fault", each.fault.message}});
    lines += printable(fmt::format("given up: {}: {}", name, each.fault.message)) + "\n";
  }
  if (command.json) {
    fmt::print("{}\n", nlohmann::json{{"waiting", status.waiting},
                                      {"in_hand", status.in_hand},
                                      {"given_up", status.dead},
                                      {"faults", dead}}
                           .dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return;
  }
  fmt::print("{} waiting, {} in hand, {} given up\n{}", status.waiting, status.in_hand, status.dead, lines);
}

void run(WorkCommand& command, const RunContext& context) {
  command.queue.ack_wait = std::chrono::milliseconds(static_cast<std::int64_t>(1000 * command.ack_wait_s));
  if (!fs::is_directory(command.worker.folder))
    throw Error(ErrorKind::kInput, command.worker.folder.string(), "is no folder",
                "Name the folder that the tasks' paths are relative to");
  if (!command.tasks.empty()) read_tasks(command.tasks);        // what is wrong with it is said first
  const bool waits = command.tasks.empty() && !command.status;  // else a person does
  if (!waits) command.queue.patience = {};
  work::Queue queue = work::Queue::open(command.queue);
  if (!command.tasks.empty()) return submit(command, queue, context);
  if (command.status) return show_status(command, queue);
  keeps_when_stopped("tasks that are done are kept, the one in hand waits for another worker");
  let_stop_take(std::chrono::milliseconds(950));
  say("waiting for tasks");
  run_worker(queue, command.queue, command.worker, context);
}

}  // namespace

void add_work(CLI::App& app, RunContext& context) {
  auto command = std::make_shared<WorkCommand>();
  CLI::App* sub = app.add_subcommand("work",
                                     "Work on shards of freshet ingest and freshet synth sweep that wait on "
                                     "a NATS server, one after another, "
                                     "until it is stopped. Machines may come and go: a task that one of them "
                                     "leaves is given to another. All "
                                     "share a folder of clips, stores and films.");
  sub->add_option("--queue", command->queue.url,
                  "Address of the NATS server (with JetStream) and name of the queue: "
                  "nats://[USER:PASSWORD@]HOST[:PORT][/NAME], or tls:// [/freshet]")
      ->required()
      ->type_name("URL");
  CLI::Option* tasks =
      sub->add_option("--submit", command->tasks,
                      "Put tasks in, and end: a TOML file of tables [[task]], each with run = [\"ingest\", "
                      "\"all.store\", \"clips\"] and shards = 8. Those that wait already are left [off]")
          ->type_name("FILE");
  CLI::Option* status = sub->add_flag("--status", command->status,
                                      "Print how many tasks wait, are in hand, and were given up, with their "
                                      "faults, and end [off]")
                            ->excludes(tasks);
  CLI::Option* json = sub->add_flag("--json", command->json, "Print the status as JSON")->needs(status);
  json->excludes(tasks);
  command->worker.folder = ".";
  CLI::Option* folder = sub->add_option("--folder", command->worker.folder,
                                        "Folder that the tasks' paths are relative to [the current one]");
  CLI::Option* until_empty = sub->add_flag("--until-empty", command->worker.until_empty,
                                           "Exit once no task is queued or running on any machine [off]");
  CLI::Option* tries =
      sub->add_option("--tries", command->worker.tries, "Faults after which a task is given up, 1 to 100")
          ->check(CLI::Range(1, 100))
          ->capture_default_str();
  sub->add_option(
         "--ack-wait", command->ack_wait_s,
         "After how long a machine that is silent loses its task, s, 1 to 3600; the same for all of a "
         "queue. A longer one outlasts longer breaks of the network")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  sub->add_option("-j,--threads", command->worker.threads, "Number of threads of a task [all cores]")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  for (CLI::Option* own : {folder, until_empty, tries}) own->excludes(tasks)->excludes(status);
  sub->callback([command, &context] { run(*command, context); });
}

}  // namespace freshet::tools
