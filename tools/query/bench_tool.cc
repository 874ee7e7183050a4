#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "platform/whole_file.h"
#include "query/benchmark/measured_indexes.h"
#include "query/benchmark/search_benchmark.h"
#include "query/benchmark/search_page.h"
#include "stored/store_settings.h"
#include "stored/stored_codebook.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/console/table.h"

namespace freshet::tools {
namespace {

struct BenchCommand {
  std::string store;
  std::vector<std::string> pictures, indexes;
  query::SearchBenchmarkOptions options;
  bool no_label = false, no_filters = false;
  std::string json, page;
  CLI::Option* json_option = nullptr;
};

query::BenchmarkPicture read_picture(const std::string& argument) {
  // PICTURE:MATTE, unless a file has that very name.
  const std::size_t colon = std::filesystem::exists(argument) ? std::string::npos : argument.rfind(':');
  const std::filesystem::path path = argument.substr(0, colon);
  media::Picture read = media::read_picture(path);
  for (const std::string& notice : read.notices) say(path.string() + ": " + notice);
  query::BenchmarkPicture picture{path.stem().string(), read.bgr, {}};
  picture.matte = colon == std::string::npos
                      ? cv::Mat(read.bgr.size(), CV_8U, cv::Scalar(255))
                      : media::read_matte(argument.substr(colon + 1), read.bgr.size()).alpha;
  return picture;
}

std::vector<query::MeasuredIndex> chosen(const std::vector<std::string>& names) {
  std::vector<query::MeasuredIndex> all = query::measured_indexes(), some;
  if (names.empty()) return all;
  for (const std::string& name : names) {
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& index) { return index.name == name; });
    if (found == all.end()) {
      std::vector<std::string> known;
      for (const query::MeasuredIndex& index : all) known.push_back(index.name);
      throw Error(ErrorKind::kUsage, "index \"" + name + "\"", "no such index",
                  fmt::format("There are {}", fmt::join(known, ", ")));
    }
    some.push_back(*found);
  }
  return some;
}

std::string figure(double value) {
  return value >= 100 ? fmt::format("{:.0f}", value) : fmt::format("{:.2f}", value);
}

void print(const query::SearchReport& report) {
  fmt::print("{}\n{} patches of {} clips, {} words; {} pieces of {}{}\n\n", to_string(report.machine),
             report.patches, report.clips, report.words, report.pieces,
             report.held_out.empty() ? "" : "the average image, its own patches left out, of ",
             fmt::join(report.pictures, ", "));
  Table table({"index", "setting", "patches", "build s", "MB", "median ms", "p99 ms", "all threads",
               "recall@1", "@10", "@100", "energy", "pieces"});
  Table filters({"index", "setting", "condition", "admitted", "median ms", "p99 ms", "recall@100", "short"});
  bool any_filters = false;
  for (const query::IndexResult& index : report.indexes) {
    for (const query::SettingResult& setting : index.settings)
      table.row({index.name, setting.name, fmt::format("{}", index.rows), figure(index.build_seconds),
                 fmt::format("{:.1f}", static_cast<double>(index.bytes) / 1e6),
                 figure(setting.times.median_ms), figure(setting.times.p99_ms),
                 figure(setting.times.all_threads_ms), fmt::format("{:.3f}", setting.recall.at_1),
                 fmt::format("{:.3f}", setting.recall.at_10), fmt::format("{:.3f}", setting.recall.at_100),
                 setting.energy_loss ? fmt::format("{:+.2f}%", 100 * *setting.energy_loss) : "-",
                 fmt::format("{}", setting.pieces)});
    for (const query::FilterResult& filter : index.filters) {
      any_filters = true;
      filters.row({index.name, filter.setting, filter.condition,
                   fmt::format("{:.1f}%", 100 * filter.admitted), figure(filter.times.median_ms),
                   figure(filter.times.p99_ms), fmt::format("{:.3f}", filter.recall),
                   fmt::format("{}", filter.short_of)});
    }
  }
  fmt::print("{}", table.text());
  if (any_filters) fmt::print("\n{}", filters.text());
  bool first = true;
  for (const query::IndexResult& index : report.indexes) {
    std::string note;
    if (!index.skipped.empty()) note = index.skipped;
    if (!index.package.empty())
      note += fmt::format("; install the package {} and build again", index.package);
    if (index.projected_build_seconds > 0)
      note = fmt::format("built of {} patches: all {} would take some {:.0f} s, or too much memory",
                         index.rows, report.rows, index.projected_build_seconds);
    if (note.empty()) continue;
    fmt::print("{}{}: {}\n", first ? "\n" : "", index.name, note);
    first = false;
  }
  if (const std::string text = query::verdict(report); !text.empty()) fmt::print("\n{}\n", text);
}

void run(const BenchCommand& command, const RunContext& context) {
  check_output_folder(command.page);
  check_output_folder(command.json);
  const std::vector<query::MeasuredIndex> indexes = chosen(command.indexes);
  const store::Snapshot snapshot = store::Store::open_read(command.store).snapshot();
  std::vector<query::BenchmarkPicture> pictures;
  for (const std::string& argument : command.pictures) pictures.push_back(read_picture(argument));
  query::SearchBase base;
  base.settings = stored::settings_of(snapshot);
  base.codebook = stored::read_codebook(snapshot);
  base.table = stored::read_patch_table(snapshot);
  query::SearchBenchmarkOptions options = command.options;
  options.label = !command.no_label;
  options.filters = !command.no_filters;
  Progress progress;
  const query::SearchReport report = query::benchmark_search(
      snapshot, base, std::move(pictures), indexes, options,
      [&](const std::string& what) { progress.show(what, 0, 0); }, context.stop);
  progress.finish();
  const bool to_stdout = command.json_option->count() > 0 && command.json.empty();
  if (!command.page.empty()) write_whole_file(command.page, query::search_page(report));
  if (to_stdout) {
    fmt::print("{}\n", query::to_json(report).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    if (!command.json.empty())
      write_whole_file(
          command.json,
          query::to_json(report).dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    print(report);
    for (const std::string& path : {command.json, command.page})
      if (!path.empty()) fmt::print("{}\n", path);
  }
  if (report.wrong > 0)
    throw Error(
        ErrorKind::kDamaged, command.store,
        fmt::format("{} of {} exact answers are not those of brute force", report.wrong, report.checked));
}

}  // namespace

void add_bench(CLI::App& query_command, RunContext& context) {
  auto command = std::make_shared<BenchCommand>();
  CLI::App* sub = query_command.add_subcommand(
      "bench", "Measure every index for candidate search on your store and pictures, beside other libraries");
  sub->add_option("STORE", command->store, "The store file")->required();
  sub->add_option("--pictures", command->pictures,
                  "Pictures whose pieces are searched for, PICTURE or PICTURE:MATTE [one clip's average "
                  "image, without that clip's patches]");
  sub->add_option(
         "--index", command->indexes,
         "Only these: exact, scan, flann-kdtree, flann-kmeans, flann-hierarchical, hnswlib, faiss-flat, "
         "faiss-hnsw, faiss-ivf [all]")
      ->delimiter(',');
  query::SearchBenchmarkOptions& options = command->options;
  sub->add_option("--rows", options.rows, "Number of query patches, evenly spread over the store [all]")
      ->check(CLI::Range(1, 1 << 30));
  sub->add_option("--pieces", options.pieces, "Number of pieces, evenly spread over the pictures")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  sub->add_option(
         "--limit", options.build_limit_s,
         "Limit for building an index, s of one core; a slower one is built of as many patches as fit")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str();
  sub->add_option("--seconds", options.setting_limit_s, "Limit for searching with one setting, s of one core")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str();
  sub->add_option("--check", options.checked, "Number of pieces that are compared with brute force")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  sub->add_flag(
      "--no-label", command->no_label,
      "Skip labelling the first picture with each setting's candidates, which shows the energy lost");
  sub->add_flag("--no-filters", command->no_filters, "Skip search under conditions");
  command->json_option =
      sub->add_option("--json", command->json, "Write the results as JSON to FILE, or print them")
          ->expected(0, 1)
          ->type_name("[FILE]");
  sub->add_option("--page", command->page, "Write an HTML page with the curves");
  add_overwrite(*sub);
  add_threads(*sub);
  sub->callback([command, &context] { run(*command, context); });
}

}  // namespace freshet::tools
