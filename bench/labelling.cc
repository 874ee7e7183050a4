// What do the solvers reach on real pictures, and are the tables right?
//
//   bench_labelling STORE PICTURE[:MATTE].. [--size WxH].. [--log-only] [--json FILE]
//
// With sizes, each picture is resized to each of them, and all of its pieces are searched and labelled.
// For each picture and each form of costs: all tables are built, and ten of them, over all pairs of labels,
// are compared with the obvious loops over cells and channels in double precision. Errors must stay below a
// thousandth of a cost, and below 3e-4 where a cost is less than .3 (a step of likeness is 3e-3); no solver's
// energy may differ from that of its labels or lie below TRW-S's bound, else the bench ends with 1. Then each
// solver's energy, its gap to that bound and its seconds, with the labels of least unary cost as the floor.
// The plain loops' own time on those ten edges stands for all tables, by the number of pairs: the reference.
// A store made with `ingest --cell 1 --bands 0 --flow-step 1` gives the exact form, pixel by pixel.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/machine.h"
#include "bench/picture_argument.h"
#include "freshet_error.h"
#include "query/labelling.h"
#include "query/minimizer.h"
#include "query/stored_features.h"
#include "store/store.h"
#include "vision/settings.h"

namespace {

using namespace freshet;

constexpr std::size_t kCheckedEdges = 10;
constexpr double kErrorAllowed = 1e-3, kCostThatMatters = 0.3;

double square(double value) { return value * value; }

/// What a cell's value counts as, channel by channel, before weights.
std::vector<double> looks(const query::FeatureShape& shape, query::CostForm form, const float* cell) {
  std::vector<double> values(cell, cell + shape.channels());
  const int first_level = 2 + 2 * shape.bands;
  if (form == query::CostForm::kPower) {
    for (int c = 0; c < 2; ++c) values[c] /= 25;
    for (int c = 2; c < first_level; ++c) values[c] /= 25 * 25;
    return values;
  }
  const double speed = std::hypot(values[0], values[1]);
  for (int c = 0; c < 2; ++c) values[c] *= speed > 0 ? std::log1p(speed / 2.5) / speed : 0;
  for (int c = 2; c < first_level; ++c) values[c] = 0.5 * std::log1p(std::max(0.0, values[c]));
  for (int c = first_level; c < shape.channels(); ++c) values[c] = std::log1p(512 * std::max(0.0, values[c]));
  return values;
}

/// Eq. 2, 3 and 6 for two patches: b beside a, or below it.
class ObviousCost {
 public:
  ObviousCost(const query::FeatureShape& shape, const query::PairwiseOptions& options)
      : shape_(shape), options_(options) {}
  using Patch = std::vector<std::vector<double>>;  // looks of its cells, row-major
  std::vector<Patch> patches(const query::FeatureSource& source, std::span<const query::Row> rows) const {
    const std::vector<float> features = query::features_of_patches(source, shape_, rows);
    const float* from = features.data();
    std::vector<Patch> patches(rows.size());
    for (Patch& patch : patches) {
      for (int cell = 0; cell < shape_.cells * shape_.cells; ++cell, from += shape_.channels())
        patch.push_back(looks(shape_, options_.form, from));
    }
    return patches;
  }
  double operator()(const Patch& a, const Patch& b, bool beside) const {
    const int rest = shape_.cells - shape_.overlap;
    const int rows = beside ? shape_.cells : shape_.overlap, columns = beside ? shape_.overlap : shape_.cells;
    double motion = 0, power = 0, texture = 0;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const auto& of_a = a[(row + (beside ? 0 : rest)) * shape_.cells + column + (beside ? rest : 0)];
        const auto& of_b = b[row * shape_.cells + column];
        const int first_level = 2 + 2 * shape_.bands;
        for (int c = 0; c < 2; ++c) motion += square(of_a[c] - of_b[c]);
        for (int c = 2; c < first_level; ++c) power += square(of_a[c] - of_b[c]);
        for (int c = first_level; c < shape_.channels(); ++c) texture += square(of_a[c] - of_b[c]);
      }
    }
    return options_.lambda * (motion + options_.sigma * power + options_.rho * texture) / (rows * columns);
  }

 private:
  query::FeatureShape shape_;
  query::PairwiseOptions options_;
};

struct TableError {
  std::size_t edges = 0, pairs = 0;
  double relative = 0, absolute = 0;  // greatest
  double loop_seconds = 0;            // CPU, of the plain loops alone
};

TableError check_tables(const query::Mrf& mrf, const query::CandidateSearch& search,
                        const query::FeatureShape& shape, const query::PairwiseOptions& options,
                        query::StoredFeatures& features) {
  const ObviousCost cost(shape, options);
  const query::FeatureSource source = features.source();
  TableError error;
  error.edges = std::min(kCheckedEdges, mrf.edges.size());
  for (std::size_t e = 0; e < error.edges; ++e) {
    const query::Mrf::Edge& edge = mrf.edges[e * mrf.edges.size() / error.edges];
    const auto rows_p = search.candidates.rows_of(edge.p), rows_q = search.candidates.rows_of(edge.q);
    const auto patches_p = cost.patches(source, rows_p), patches_q = cost.patches(source, rows_q);
    const bool beside = search.target.corners[edge.p].y == search.target.corners[edge.q].y;
    const double start = bench::thread_seconds();
    std::vector<double> expected;
    for (const auto& p : patches_p)
      for (const auto& q : patches_q) expected.push_back(cost(p, q, beside));
    error.loop_seconds += bench::thread_seconds() - start;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double difference = std::abs(mrf.table(edge)[i] - expected[i]);
      error.absolute = std::max(error.absolute, difference);
      error.relative = std::max(error.relative, difference / std::max(expected[i], kCostThatMatters));
    }
    error.pairs += expected.size();
  }
  return error;
}

struct Run {
  std::string solver;
  query::Solution solution;
  double seconds = 0, cpu_seconds = 0;  // of all threads
};

std::vector<Run> run_solvers(const query::Mrf& mrf) {
  std::vector<Run> runs;
  for (const auto minimizer :
       {query::Minimizer::kTrwS, query::Minimizer::kAlphaExpansion, query::Minimizer::kIcm}) {
    const double start = bench::wall_seconds(), cpu = bench::process_seconds();
    query::Solution solution = query::minimize(mrf, minimizer);
    runs.push_back({query::name_of(minimizer), std::move(solution), bench::wall_seconds() - start,
                    bench::process_seconds() - cpu});
  }
  query::Solution floor;
  floor.labels = query::unary_minimum(mrf);
  floor.energy = query::energy(mrf, floor.labels);
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
    const TableError error = check_tables(mrf, search, shape, options, features);
    right = right && error.relative <= kErrorAllowed;
    const double loops =
        error.loop_seconds * static_cast<double>(mrf.pairwise.size()) / static_cast<double>(error.pairs);
    fmt::print(
        "  {}: tables {:.3f} s, {:.3f} s of CPU, {:.2f} ms an edge (plain loops would take {:.0f}); error "
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
    fmt::print("    {:<16}{:>12}{:>12}{:>12}{:>9}{:>8}{:>9}{:>9}\n", "solver", "energy", "of it unary",
               "bound", "gap", "rounds", "s", "CPU s");
    const std::vector<Run> runs = run_solvers(mrf);
    const double bound = runs[0].solution.lower_bound;
    for (const Run& run : runs) {
      const query::Solution& solution = run.solution;
      const double scale = std::max(1.0, std::abs(bound)), again = query::energy(mrf, solution.labels);
      right = right && std::abs(again - solution.energy) <= 1e-6 * scale && again >= bound - 1e-4 * scale;
      const double gap = (solution.energy - bound) / std::abs(bound);
      const bool has_bound = std::isfinite(solution.lower_bound);
      fmt::print("    {:<16}{:>12.3f}{:>12.3f}{:>12}{:>8.2f}%{:>8}{:>9.3f}{:>9.3f}\n", run.solver,
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

}  // namespace

int main(int argc, char** argv) try {
  std::vector<std::string> arguments;
  std::vector<cv::Size> sizes;
  std::vector<query::CostForm> forms{query::CostForm::kLog, query::CostForm::kPower};
  std::string json_file = "labelling.json";
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--json" && i + 1 < argc) {
      json_file = argv[++i];
    } else if (argument == "--size" && i + 1 < argc) {
      const std::string size = argv[++i];
      sizes.emplace_back(std::stoi(size), std::stoi(size.substr(size.find('x') + 1)));
    } else if (argument == "--log-only") {
      forms = {query::CostForm::kLog};
    } else {
      arguments.push_back(argument);
    }
  }
  if (arguments.size() < 2) {
    fmt::print(stderr, "bench_labelling STORE PICTURE[:MATTE].. [--size WxH].. [--log-only] [--json FILE]\n");
    return 2;
  }
  const store::Snapshot snapshot = store::Store::open_read(arguments[0]).snapshot();
  const bench::Machine machine = bench::this_machine();
  std::size_t patches = 0;
  for (const store::ClipId clip : snapshot.clips()) patches += snapshot.clip(clip).rows;
  fmt::print("{}\n{} clips, {} patches, {} candidates a piece\n", bench::to_string(machine),
             snapshot.clips().size(), patches, query::CandidateOptions{}.k);
  nlohmann::json report{{"bench", "labelling"}, {"machine", bench::to_json(machine)}, {"patches", patches}};
  bool right = true;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const bench::PictureArgument whole = bench::read_picture_argument(arguments[i]);
    if (sizes.empty()) right = measure(snapshot, whole, forms, report) && right;
    for (const cv::Size size : sizes) {
      bench::PictureArgument resized{whole.name, {}, {}};
      cv::resize(whole.picture, resized.picture, size, 0, 0, cv::INTER_AREA);
      cv::resize(whole.matte, resized.matte, size, 0, 0, cv::INTER_AREA);
      right = measure(snapshot, resized, forms, report) && right;
    }
  }
  report["right"] = right;
  std::ofstream(json_file) << report.dump(1) << '\n';
  if (!right) fmt::print(stderr, "wrong: a table, an energy or a bound (see above)\n");
  return right ? 0 : 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
