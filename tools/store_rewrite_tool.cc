#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "platform/printable.h"
#include "query/index/index_builder.h"
#include "store/rewrite/rewrite.h"
#include "store/store_list.h"
#include "tools/commands.h"
#include "tools/console/progress.h"
#include "tools/console/table.h"

namespace freshet::tools {
namespace {

constexpr const char* kIndexAgain = "The index is not in it: run freshet index";

struct RewriteCommand {
  std::string store, out;
  std::vector<std::string> names;  // of clips
  std::vector<std::filesystem::path> stores;
  bool json = false;
};

std::string size_text(std::uint64_t bytes) { return bytes_text(static_cast<double>(bytes)); }

/// What a rewrite in place has come to.
void print_sizes(const RewriteCommand& command, const store::FileSizes& sizes) {
  if (sizes.old_names > 0)
    say(fmt::format("{}: the file has {} other name{} (hard links), with the store as it was", command.store,
                    sizes.old_names, sizes.old_names == 1 ? "" : "s"));
  if (command.json)
    fmt::print(
        "{}\n",
        nlohmann::json{{"store", command.store}, {"bytes_before", sizes.before}, {"bytes_after", sizes.after}}
            .dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  else
    fmt::print("{}: {} before, {} now\n", printable(command.store), size_text(sizes.before),
               size_text(sizes.after));
}

/// Runs what takes a job, with progress.
template <class Act>
auto with_progress(const RunContext& context, const Act& act) {
  Progress progress;
  auto result = act(Job{.progress = progress.callback(), .stop = context.stop});
  progress.finish();
  return result;
}

void compact(const RewriteCommand& command, const RunContext& context) {
  print_sizes(command,
              with_progress(context, [&](const Job& job) { return store::compact(command.store, job); }));
}

void remove(const RewriteCommand& command, const RunContext& context) {
  const store::FileSizes sizes = with_progress(context, [&](const Job& job) {
    return store::remove_clips(command.store, command.names, query::rebuildable(), job);
  });
  print_sizes(command, sizes);
  if (!command.json) fmt::print("{} removed. {}\n", command.names.size(), kIndexAgain);
}

void merge(const RewriteCommand& command, const RunContext& context) {
  if (command.stores.size() == 1 && !store::is_store_list(command.stores.front()))
    throw CLI::ArgumentMismatch::AtLeast("STORE", 2, 1);
  const store::MergeReport report = with_progress(context, [&](const Job& job) {
    return store::merge(command.stores, command.out, query::rebuildable(), job);
  });
  if (command.json) {
    nlohmann::json doubles = nlohmann::json::array();
    for (const auto& one : report.doubles)
      doubles.push_back({{"name", one.name}, {"store", one.store}, {"kept_as", one.kept_as}});
    fmt::print("{}\n", nlohmann::json{{"store", command.out},
                                      {"clips", report.clips},
                                      {"doubles", doubles},
                                      {"bytes", report.bytes},
                                      {"index_left_out", report.index_left_out}}
                           .dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return;
  }
  for (const auto& one : report.doubles)
    say(fmt::format("{}: its clip \"{}\" comes from the same source as \"{}\", and is left out", one.store,
                    one.name, one.kept_as));
  fmt::print("{}: {} clips, {}. {}\n", printable(command.out), report.clips, size_text(report.bytes),
             kIndexAgain);
}

void print_lost(const RewriteCommand& command, const store::RepairReport& report) {
  for (const auto& clip : report.lost) {
    const std::string fault = clip.fault.substr(0, clip.fault.find(". Restore "));
    if (clip.name.empty())
      fmt::print("lost: clip {}: {}\n", static_cast<std::uint32_t>(clip.id), printable(fault));
    else
      fmt::print("lost: {}: {}. Ingest it again from the source with hash {}\n", printable(clip.name),
                 printable(fault), printable(clip.source_hash));
  }
  if (report.unknown > 0)
    fmt::print("lost: {} more clips, of which not even the names are left\n", report.unknown);
  for (const std::string& blob : report.lost_blobs)
    fmt::print("lost: what was stored as \"{}\"\n", printable(blob));
  for (const std::string& doubt : report.doubts) fmt::print("not certain: {}\n", doubt);
  fmt::print("{}: {} clips, {}{}\n", printable(command.out), report.clips, size_text(report.bytes),
             report.index_left_out ? fmt::format(". {}", kIndexAgain) : "");
}

void repair(const RewriteCommand& command, RunContext& context) {
  const store::RepairReport report = with_progress(context, [&](const Job& job) {
    return store::repair(command.store, command.out, query::rebuildable(), job);
  });
  if (command.json) {
    nlohmann::json lost = nlohmann::json::array();
    for (const auto& clip : report.lost)
      lost.push_back({{"clip", static_cast<std::uint32_t>(clip.id)},
                      {"name", clip.name},
                      {"source", clip.source_hash},
                      {"fault", clip.fault}});
    fmt::print("{}\n", nlohmann::json{{"store", command.out},
                                      {"clips", report.clips},
                                      {"lost", lost},
                                      {"lost_without_name", report.unknown},
                                      {"lost_blobs", report.lost_blobs},
                                      {"doubts", report.doubts},
                                      {"bytes", report.bytes},
                                      {"index_left_out", report.index_left_out}}
                           .dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    print_lost(command, report);
  }
  const std::size_t lost = report.lost.size() + report.unknown + report.lost_blobs.size();
  if (report.saved_all()) return;
  say(lost > 0
          ? fmt::format("{}: {} of its clips could not be saved; the file is as it was", command.store, lost)
          : fmt::format("{}: all that was found is saved, but more may be lost; the file is as it was",
                        command.store));
  context.exit_code = 3;
}

}  // namespace

void add_store_rewrites(CLI::App& store, RunContext& context) {
  const auto add = [&](const char* name, const char* text, auto&& act) {
    auto command = std::make_shared<RewriteCommand>();
    CLI::App* sub = store.add_subcommand(name, text);
    sub->add_flag("--json", command->json, "Print the result as JSON");
    add_threads(*sub);
    sub->callback([command, act, &context] { act(*command, context); });
    return std::pair(sub, command);
  };
  const auto add_out = [](CLI::App* sub, RewriteCommand& command) {
    sub->add_option("-o,--output", command.out, "The new store; nothing of that name may be there")
        ->required();
  };
  const char* const kStore = "The store file";
  {
    auto [sub, command] =
        add("repair",
            "Save every clip that is whole out of a damaged store into a new one, and say what is lost; exit "
            "code 3 when something is, or may be. The damaged file is left as it is",
            repair);
    sub->add_option("STORE", command->store, kStore)->required();
    add_out(sub, *command);
  }
  {
    auto [sub, command] =
        add("compact",
            "Write a store anew in its place, in order and without the room that changes have "
            "left. The old file stands until the new one is on the disk",
            compact);
    sub->add_option("STORE", command->store, kStore)->required();
  }
  {
    auto [sub, command] =
        add("remove", "Take clips out of a store, and its index with them; the room they had is given back",
            remove);
    sub->add_option("STORE", command->store, kStore)->required();
    sub->add_option("CLIP", command->names, "Names of clips, as freshet store info lists them")->required();
  }
  {
    auto [sub, command] =
        add("merge",
            "One store of the clips of several that have the same settings. Clips from the same "
            "source are taken once",
            merge);
    sub->add_option("STORE", command->stores, "The stores, two or more, or a list of them (NAME.stores)")
        ->required()
        ->expected(1, 1 << 16);
    add_out(sub, *command);
  }
}

}  // namespace freshet::tools
