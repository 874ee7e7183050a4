#include <limits>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/console/index_progress.h"

namespace freshet::tools {
namespace {

struct IndexCommand {
  std::string store;
  std::vector<std::string> flann;
  query::IndexOptions options;
  bool no_flann = false, json = false;
};

void run(const IndexCommand& command, const RunContext& context) {
  query::IndexOptions options = command.options;
  if (command.no_flann) options.flann.clear();
  if (!command.flann.empty()) {
    // What is asked for by name is built whatever it takes, or refused.
    options.flann.clear();
    options.flann_max_bytes = std::numeric_limits<std::size_t>::max();
  }
  for (const std::string& name : command.flann) options.flann.push_back(query::parse_flann_kind(name));
  store::Store store = store::Store::open_write(command.store);
  const query::IndexReport report = update_index(store, options, context);
  nlohmann::json flann = nlohmann::json::array();
  for (const query::IndexReport::Flann& built : report.flann_built)
    flann.push_back({{"kind", query::name_of(built.kind)},
                     {"build_seconds", built.tuning.build_seconds},
                     {"bytes", built.bytes},
                     {"checks", built.tuning.checks},
                     {"recall", built.tuning.recall}});
  if (command.json)
    fmt::print("{}\n", nlohmann::json{{"store", command.store},
                                      {"words_built", report.words_built},
                                      {"words", report.words},
                                      {"clips", report.clips},
                                      {"patches", report.patches},
                                      {"samples", report.samples},
                                      {"flann", flann},
                                      {"flann_too_large", report.flann_too_large},
                                      {"seconds",
                                       {{"sample", report.sample_s},
                                        {"train", report.train_s},
                                        {"assign", report.assign_s},
                                        {"flann", report.flann_s},
                                        {"write", report.write_s}}}}
                           .dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace

void add_index(CLI::App& app, RunContext& context) {
  auto command = std::make_shared<IndexCommand>();
  CLI::App* sub = app.add_subcommand(
      "index", "Rebuild a store's codebook, visual words and FLANN index when clips are new");
  sub->add_option("STORE", command->store, "The store file")->required();
  CLI::Option* flann =
      sub->add_option(
             "--flann", command->flann,
             "FLANN indexes to build and keep, for searches with --index: kdtree, kmeans, "
             "hierarchical. The exact index, by which a store is searched otherwise, is faster and is "
             "built from the words [hierarchical]")
          ->delimiter(',');
  sub->add_flag("--no-flann", command->no_flann, "Build no FLANN index, and drop those that the store holds")
      ->excludes(flann);
  sub->add_flag("--rebuild", command->options.rebuild, "Build everything anew, even when no clip is new");
  sub->add_option("--samples", command->options.samples, "Descriptors that the codebook is trained on")
      ->check(CLI::Range(1000, 10'000'000))
      ->capture_default_str();
  sub->add_flag("--json", command->json, "Print the result as JSON");
  add_threads(*sub);
  sub->callback([command, &context] { run(*command, context); });
}

}  // namespace freshet::tools
