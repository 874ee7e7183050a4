// What do the solvers reach on real pictures, are the tables right, and what does a labelling cost?
//
//   bench_labelling STORE PICTURE[:MATTE].. [--size WxH].. [--runs N] [--log-only] [--json FILE]
//
// With sizes, each picture is resized to each of them, and all of its pieces are searched and labelled.
// First each is labelled N times with the store dropped from the system's cache and N times as it then is, a
// new process each: medians from the start of the process to the assignment, by stage.
// Then, for each picture and each form of costs: all tables are built, and ten of them, over all pairs of
// labels, are compared with the plain loops over cells and channels in double precision. Errors must stay
// below 1.5e-3 of a cost, and below 4.5e-4 where a cost is less than .3 (a step of likeness is 3e-3); no
// solver's energy may differ from that of its labels or lie below TRW-S's bound, else the bench ends with 1.
// Each solver's energy, its gap to that bound and its seconds, with the labels of minimum unary cost as the
// floor. The plain loops' own time on those ten edges stands for all tables, by the number of pairs: the
// reference.
//
//   bench_labelling STORE PICTURE[:MATTE].. [--size WxH].. --exact EXACT [--exact-mb 2048] [--json FILE]
//
// The tables pixel by pixel, with every frequency, beside the pooled ones: EXACT holds some of STORE's clips
// and was made with `ingest --cell 1 --bands 0 --flow-step 1`. Ten exact tables are compared with the loops.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "bench/labelling/exact_tables.h"
#include "bench/labelling/labelling_run.h"
#include "bench/labelling/reference_cost.h"
#include "freshet/error.h"
#include "platform/allocation.h"
#include "query/costs/stored_features.h"
#include "query/labelling/labelling.h"
#include "query/mrf/minimizer.h"
#include "store/store.h"

namespace {

using namespace freshet;

struct Run {
  std::string solver;
  query::Solution solution;
  double seconds = 0, cpu_seconds = 0;  // of all threads
};

std::vector<Run> run_solvers(const query::Mrf& mrf) {
  std::vector<Run> runs;
  const auto run = [&](const std::string& solver, const auto& solve) {
    const double start = bench::wall_seconds(), cpu = bench::process_seconds();
    query::Solution solution = solve();
    runs.push_back(
        {solver, std::move(solution), bench::wall_seconds() - start, bench::process_seconds() - cpu});
  };
  query::Solution floor;
  floor.labels = query::unary_minimum(mrf);
  floor.energy = query::energy(mrf, floor.labels);
  for (const auto minimizer :
       {query::Minimizer::kTrwS, query::Minimizer::kAlphaExpansion, query::Minimizer::kIcm})
    run(query::name_of(minimizer), [&] { return query::minimize(mrf, minimizer); });
  runs.push_back({"unary minimum", std::move(floor)});
  return runs;
}

/// Of the labels, without their neighbours.
double unary_energy(const query::Mrf& mrf, const query::Labels& labels) {
  double sum = 0;
  for (std::size_t node = 0; node < mrf.nodes(); ++node) sum += mrf.unary_of(node)[labels[node]];
  return sum;
}

/// One picture's rows of the table; false when anything was wrong.
bool measure(const store::Snapshot& snapshot, const bench::PictureArgument& read,
             const std::vector<query::CostForm>& forms, nlohmann::json& report) {
  const double start = bench::wall_seconds(), start_cpu = bench::process_seconds();
  const query::SearchBase base = query::open_search(snapshot);
  const vision::Settings& settings = base.settings;
  const query::CandidateSearch search =
      query::search_candidates(snapshot, base, read.picture, read.matte, query::LabelOptions{});
  const query::FeatureShape shape = query::feature_shape(settings);
  const double searched = bench::wall_seconds() - start, searched_cpu = bench::process_seconds() - start_cpu;
  fmt::print(
      "\n{}, {} x {}: {} pieces, {} edges; open {:.2f} s, cut {:.2f} s, search {:.2f} s; {:.2f} s of CPU\n",
      read.name, read.picture.cols, read.picture.rows, search.target.size(), search.target.edges.size(),
      base.seconds, search.seconds.cut, search.seconds.search, searched_cpu);
  nlohmann::json picture{
      {"picture", read.name},
      {"width", read.picture.cols},
      {"height", read.picture.rows},
      {"cpu_seconds_to_candidates", searched_cpu},
      {"pieces", search.target.size()},
      {"edges", search.target.edges.size()},
      {"seconds", {{"open", base.seconds}, {"cut", search.seconds.cut}, {"search", search.seconds.search}}}};
  bool right = true;
  for (const query::CostForm form : forms) {
    const query::PairwiseOptions options = query::default_costs(form);
    query::StoredFeatures features(snapshot, settings, search.table());
    const double wall = bench::wall_seconds(), cpu = bench::process_seconds();
    const query::Mrf mrf =
        query::build_mrf(search.target, search.candidates, shape, options, features.source());
    const double tables_wall = bench::wall_seconds() - wall, tables_cpu = bench::process_seconds() - cpu;
    const double edges = static_cast<double>(std::max<std::size_t>(1, mrf.edges.size()));
    const bench::TableError error = bench::check_tables(mrf, search, shape, options, features.source());
    right = right && error.relative <= bench::kErrorAllowed;
    const double loops =
        error.loop_seconds * static_cast<double>(mrf.pairwise.size()) / static_cast<double>(error.pairs);
    fmt::print(
        "  {}: tables {:.3f} s, {:.3f} s of CPU, {:.2f} ms per edge (plain loops would take {:.0f}); error "
        "{:.1e} "
        "of {} pairs\n",
        query::name_of(form), tables_wall, tables_cpu, 1e3 * tables_cpu / edges, loops, error.relative,
        error.pairs);
    nlohmann::json row{{"costs", query::name_of(form)},
                       {"lambda", options.lambda},
                       {"tables_seconds", tables_wall},
                       {"tables_cpu_seconds", tables_cpu},
                       {"plain_loops_cpu_seconds_projected", loops},
                       {"checked_edges", error.edges},
                       {"checked_pairs", error.pairs},
                       {"greatest_relative_error", error.relative},
                       {"greatest_absolute_error", error.absolute}};
    fmt::print("    {:<20}{:>12}{:>12}{:>12}{:>9}{:>8}{:>9}{:>9}\n", "solver", "energy", "of it unary",
               "bound", "gap", "rounds", "s", "CPU s");
    const std::vector<Run> runs = run_solvers(mrf);
    const double bound = runs[0].solution.lower_bound;
    for (const Run& run : runs) {
      const query::Solution& solution = run.solution;
      const double scale = std::max(1.0, std::abs(bound)), again = query::energy(mrf, solution.labels);
      right = right && std::abs(again - solution.energy) <= 1e-6 * scale && again >= bound - 1e-4 * scale;
      const double gap = (solution.energy - bound) / std::abs(bound);
      const bool has_bound = std::isfinite(solution.lower_bound);
      fmt::print("    {:<20}{:>12.3f}{:>12.3f}{:>12}{:>8.2f}%{:>8}{:>9.3f}{:>9.3f}\n", run.solver,
                 solution.energy, unary_energy(mrf, solution.labels),
                 has_bound ? fmt::format("{:.3f}", solution.lower_bound) : "-", 100 * gap,
                 solution.iterations, run.seconds, run.cpu_seconds);
      row["solvers"].push_back({{"solver", run.solver},
                                {"energy", solution.energy},
                                {"unary_energy", unary_energy(mrf, solution.labels)},
                                {"gap", gap},
                                {"iterations", solution.iterations},
                                {"seconds", run.seconds},
                                {"cpu_seconds", run.cpu_seconds}});
      if (has_bound) row["lower_bound"] = solution.lower_bound;
    }
    row["peak_mb"] = static_cast<double>(bench::peak_bytes()) / 1e6;
    fmt::print("    picture to labels {:.2f} s; peak so far {:.0f} MB\n",
               searched + tables_wall + runs[0].seconds, static_cast<double>(bench::peak_bytes()) / 1e6);
    row["picture_to_labels_seconds"] = searched + tables_wall + runs[0].seconds;
    std::fflush(stdout);
    picture["forms"].push_back(row);
  }
  report["pictures"].push_back(picture);
  return right;
}

/// Every case labelled in processes of its own, cold and warm; prints medians.
nlohmann::json measure_runs(const std::vector<bench::LabellingCase>& cases, int runs) {
  constexpr const char* kStages[] = {"total",  "start",  "picture", "store", "cut",
                                     "search", "tables", "solver",  "cpu"};
  fmt::print("medians of {} runs, s\n{:<28}{:>6}", runs, "from process to assignment", "store");
  for (const char* stage : kStages) fmt::print("{:>9}", stage);
  fmt::print("{:>9}{:>9}\n", "peak MB", "gap");
  nlohmann::json report = nlohmann::json::array();
  for (const bench::LabellingCase& asked : cases) {
    for (const auto& [pages, name] :
         {std::pair{bench::Pages::kDropped, "cold"}, std::pair{bench::Pages::kAsTheyAre, "warm"}}) {
      nlohmann::json medians = bench::median_labelling(asked, runs, pages);
      const std::string picture = std::filesystem::path(asked.picture).stem().string();
      fmt::print("{:<28}{:>6}", fmt::format("{:.16} {}x{}", picture, asked.size.width, asked.size.height),
                 name);
      for (const char* stage : kStages) fmt::print("{:>9.3f}", medians[stage].get<double>());
      fmt::print("{:>9.0f}{:>8.2f}%\n", medians["peak_mb"].get<double>(), 100 * medians["gap"].get<double>());
      std::fflush(stdout);
      medians.update({{"picture", picture},
                      {"width", asked.size.width},
                      {"height", asked.size.height},
                      {"store", name}});
      report.push_back(medians);
    }
  }
  return report;
}

struct Command {
  std::string store, json_file;
  std::vector<std::string> pictures, sizes;
  std::string exact;
  std::size_t exact_mb = 2048;
  int runs = 1;
  bool log_only = false;
};

}  // namespace

int main(int argc, char** argv) try {
  keep_freed_memory();  // as the tool does
  if (bench::label_as_asked(argc, argv)) return 0;
  Command command;
  bench::Arguments app("What the solvers reach on real pictures, and what labelling costs.");
  app.option("store", command.store).required();
  app.option("pictures", command.pictures, "PICTURE[:MATTE]").required();
  app.option("--size", command.sizes, "WxH, px: that each picture is brought to");
  app.option("--runs", command.runs, "Labellings in processes of their own, cold and warm; 0: none")
      .at_least(0);
  app.option("--exact", command.exact, "Compare with the tables of this store, of cells of 1 px; only that");
  app.option("--exact-mb", command.exact_mb, "Memory for its log features");
  app.flag("--log-only", command.log_only, "Costs of the default form alone");
  app.option("--json", command.json_file);
  app.parse(argc, argv);
  std::vector<bench::LabellingCase> cases;
  for (const std::string& picture : command.pictures) {
    if (command.sizes.empty()) cases.push_back({command.store, picture, {}});
    for (const std::string& size : command.sizes)
      cases.push_back({command.store, picture, bench::parse_size(size)});
  }
  const bench::Machine machine = bench::this_machine();
  fmt::print("{}\n", bench::to_string(machine));
  nlohmann::json report{{"bench", "labelling"}, {"machine", bench::to_json(machine)}};
  if (!command.exact.empty()) {
    const store::Snapshot pooled = store::Store::open_read(command.store).snapshot(),
                          exact = store::Store::open_read(command.exact).snapshot();
    bool right = true;
    for (const bench::LabellingCase& asked : cases) {
      report["exact"].push_back(
          bench::measure_exact(pooled, exact, bench::picture_of(asked), command.exact_mb << 20));
      right = right && report["exact"].back()["right"].get<bool>();
    }
    if (!command.json_file.empty()) std::ofstream(command.json_file) << report.dump(1) << '\n';
    if (!right) fmt::print(stderr, "wrong: a table (see above)\n");
    return right ? 0 : 1;
  }
  // Before this process opens the store: pages that it maps could not be dropped.
  if (command.runs > 0) report["runs"] = measure_runs(cases, command.runs);
  const store::Snapshot snapshot = store::Store::open_read(command.store).snapshot();
  std::size_t patches = 0;
  for (const store::ClipId clip : snapshot.clips()) patches += snapshot.clip(clip).rows;
  report["patches"] = patches;
  fmt::print("{} clips, {} patches, {} candidates per piece\n", snapshot.clips().size(), patches,
             query::CandidateOptions{}.k);
  std::vector<query::CostForm> forms{query::CostForm::kLog};
  if (!command.log_only) forms.push_back(query::CostForm::kPower);
  bool right = true;
  for (const bench::LabellingCase& asked : cases)
    right = measure(snapshot, bench::picture_of(asked), forms, report) && right;
  report["right"] = right;
  if (!command.json_file.empty()) std::ofstream(command.json_file) << report.dump(1) << '\n';
  if (!right) fmt::print(stderr, "wrong: a table, an energy or a bound (see above)\n");
  return right ? 0 : 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
