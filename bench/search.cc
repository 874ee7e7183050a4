// How fast is exact candidate search, is it exact, and what would FLANN give?
//
//   bench_search STORE PICTURE[:MATTE].. [--check N] [--flann] [--json FILE]
//
// Every piece of every picture is first searched by brute force: vision::intersection with every patch, 4 us
// each (--check N: only N pieces of a picture, evenly spread). The exact index must give the same 100 rows in
// the same order, else the bench ends with 1. Then it is timed: CPU time of one thread piece by piece, and
// all threads on all pieces of a picture. With --flann, each of FLANN's indexes at several settings of
// checks: the one that the store holds, else one built here, which takes minutes. Its recall counts a patch
// as found when it scores at least as well as the 100th of the exact answer.

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "bench/machine.h"
#include "bench/picture_argument.h"
#include "freshet_error.h"
#include "query/exact_index.h"
#include "query/flann_index.h"
#include "query/patch_table.h"
#include "query/stored_codebook.h"
#include "query/target.h"
#include "store/store.h"
#include "vision/settings.h"

namespace {

using namespace freshet;
using bench::wall_seconds;
using query::Hit;

constexpr std::size_t kCandidates = 100;
constexpr int kRounds = 5;                // of all threads; the median counts
constexpr std::size_t kFlannPieces = 50;  // of a picture, evenly spread: FLANN is slow

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

std::vector<Hit> brute_force(std::span<const vision::WordMap> words, int word_count,
                             const query::PieceQuery& piece) {
  std::vector<Hit> hits(words.size());
  for (std::size_t row = 0; row < words.size(); ++row) {
    const int score = vision::intersection(piece.words, words[row], word_count, &piece.mask);
    hits[row] = {static_cast<query::Row>(row), static_cast<std::uint32_t>(score)};
  }
  const std::size_t k = std::min(kCandidates, hits.size());
  std::partial_sort(hits.begin(), hits.begin() + static_cast<std::ptrdiff_t>(k), hits.end(), query::better);
  hits.resize(k);
  return hits;
}

struct Pieces {
  std::string picture;
  std::vector<query::PieceQuery> queries;
  std::vector<std::vector<Hit>> exact;  // by the exact index
  std::size_t checked = 0, wrong = 0;   // pieces, against brute force
  double brute_ms = 0;                  // a piece, wall clock of all threads
};

Pieces cut(const std::string& argument, const vision::Settings& settings, const vision::Codebook& codebook) {
  const auto read = bench::read_picture_argument(argument);
  return {read.name, query::make_target(read.picture, read.matte, settings.grid, codebook).queries, {}};
}

/// Fills in `exact`, and compares it on `most` pieces at most.
void search_and_check(const query::ExactIndex& index, std::span<const vision::WordMap> words, int word_count,
                      std::size_t most, Pieces& pieces) {
  pieces.exact = index.search(pieces.queries, kCandidates);
  const std::size_t count = pieces.queries.size();
  pieces.checked = std::min(most, count);
  std::atomic<std::size_t> wrong = 0;
  const double start = wall_seconds();
  oneapi::tbb::parallel_for(std::size_t{0}, pieces.checked, [&](std::size_t i) {
    const std::size_t piece = i * count / pieces.checked;
    wrong += pieces.exact[piece] != brute_force(words, word_count, pieces.queries[piece]);
  });
  pieces.brute_ms = 1e3 * (wall_seconds() - start) / static_cast<double>(pieces.checked);
  pieces.wrong = wrong;
}

struct Times {
  double median_ms = 0, p99_ms = 0;  // a piece, CPU time of one thread
  double all_threads_ms = 0;         // a piece, wall clock over pieces
};

Times time_search(const query::CandidateIndex& index, std::span<const query::PieceQuery> queries,
                  int rounds) {
  Times times;
  {
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    std::vector<double> ms;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const double start = bench::thread_seconds();
      index.search(queries.subspan(i, 1), kCandidates);
      ms.push_back(1e3 * (bench::thread_seconds() - start));
    }
    times.median_ms = quantile(ms, 0.5);
    times.p99_ms = quantile(ms, 0.99);
  }
  std::vector<double> ms;
  for (int round = 0; round < rounds; ++round) {
    const double start = wall_seconds();
    index.search(queries, kCandidates);
    ms.push_back(1e3 * (wall_seconds() - start) / static_cast<double>(queries.size()));
  }
  times.all_threads_ms = quantile(ms, 0.5);
  return times;
}

nlohmann::json to_json(const Times& times) {
  return {{"median_ms", times.median_ms},
          {"p99_ms", times.p99_ms},
          {"all_threads_ms_a_piece", times.all_threads_ms}};
}

/// Share of the best 100 that an answer holds; any patch that scores as well as the last of them will do.
double recall(std::span<const Hit> found, std::span<const Hit> exact) {
  const auto good = std::count_if(found.begin(), found.end(),
                                  [&](const Hit& hit) { return hit.score >= exact.back().score; });
  return std::min(1.0, static_cast<double>(good) / static_cast<double>(exact.size()));
}

nlohmann::json measure_flann(const store::Snapshot& snapshot, std::span<const vision::WordMap> words,
                             int word_count, const std::vector<Pieces>& pictures, query::FlannKind kind) {
  std::vector<query::PieceQuery> queries;
  std::vector<std::vector<Hit>> exact;
  for (const Pieces& pieces : pictures) {
    const std::size_t count = std::min(kFlannPieces, pieces.queries.size());
    for (std::size_t i = 0; i < count; ++i) {
      queries.push_back(pieces.queries[i * pieces.queries.size() / count]);
      exact.push_back(pieces.exact[i * pieces.queries.size() / count]);
    }
  }
  query::FlannOptions options;
  options.kind = kind;
  nlohmann::json result{{"kind", query::name_of(kind)}};
  std::optional<std::vector<std::byte>> bytes = snapshot.blob(query::blob_name(kind));
  std::string built = "from the store";
  if (!bytes) {
    const double start = bench::process_seconds();
    bytes = query::FlannIndex(words, word_count, options).serialize();
    const double seconds = bench::process_seconds() - start;
    built = fmt::format("built in {:.1f} s of CPU", seconds);
    result["build_cpu_seconds"] = seconds;
  }
  for (const int checks : {512, 2048, 8192}) {
    options.checks = checks;
    const std::size_t before = bench::allocated_bytes();
    const query::FlannIndex index(words, word_count, *bytes, options);
    const std::size_t memory = bench::allocated_bytes() - before;
    const auto answers = index.search(queries, kCandidates);
    double sum = 0, worst = 1;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const double share = recall(answers[i], exact[i]);
      sum += share;
      worst = std::min(worst, share);
    }
    const double mean = sum / static_cast<double>(queries.size());
    const Times times = time_search(index, queries, 1);
    fmt::print("{:<13}{:>7}{:>10.2f}{:>9.2f}{:>13.2f}{:>9.3f}{:>8.2f}{:>9.1f}  {}\n", query::name_of(kind),
               checks, times.median_ms, times.p99_ms, times.all_threads_ms, mean, worst,
               static_cast<double>(memory) / 1e6, built);
    std::fflush(stdout);
    nlohmann::json setting = to_json(times);
    setting["checks"] = checks;
    setting["recall"] = mean;
    setting["worst_recall"] = worst;
    setting["memory_bytes"] = memory;
    result["settings"].push_back(setting);
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<std::string> arguments;
  bool flann = false;
  std::size_t most_checked = std::numeric_limits<std::size_t>::max();
  std::string json_file = "search.json";
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--flann")
      flann = true;
    else if (argument == "--check" && i + 1 < argc)
      most_checked = std::stoul(argv[++i]);
    else if (argument == "--json" && i + 1 < argc)
      json_file = argv[++i];
    else
      arguments.push_back(argument);
  }
  if (arguments.size() < 2) {
    fmt::print(stderr, "bench_search STORE PICTURE[:MATTE].. [--check N] [--flann] [--json FILE]\n");
    return 2;
  }
  const store::Snapshot snapshot = store::Store::open_read(arguments[0]).snapshot();
  const vision::Settings settings = vision::settings_from_json(snapshot.settings());
  const vision::Codebook codebook = query::read_codebook(snapshot);
  const query::PatchTable table = query::read_patch_table(snapshot);
  const bench::Machine machine = bench::this_machine();
  fmt::print("{}\n{} clips, {} patches, {} words\n", bench::to_string(machine), table.clips.size(),
             table.size(), codebook.words);

  std::vector<double> build_seconds;
  std::optional<query::ExactIndex> index;
  std::size_t index_bytes = 0;
  {
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    for (int round = 0; round < 3; ++round) {
      index.reset();
      const std::size_t before = bench::allocated_bytes();
      const double start = bench::thread_seconds();
      index.emplace(table.words, codebook.words);
      build_seconds.push_back(bench::thread_seconds() - start);
      index_bytes = bench::allocated_bytes() - before;
    }
  }
  const double build = quantile(build_seconds, 0.5);
  fmt::print("exact index: built in {:.2f} s of CPU, {:.1f} MB, {:.0f} bytes a patch\n\n", build,
             static_cast<double>(index_bytes) / 1e6,
             static_cast<double>(index_bytes) / static_cast<double>(table.size()));

  nlohmann::json report{{"bench", "search"},
                        {"machine", bench::to_json(machine)},
                        {"patches", table.size()},
                        {"words", codebook.words},
                        {"exact", {{"build_cpu_seconds", build}, {"bytes", index_bytes}}}};
  std::vector<Pieces> pictures;
  std::size_t wrong = 0;
  fmt::print("{:<32}{:>7}{:>9}{:>7}{:>11}{:>9}{:>13}{:>10}\n", "exact", "pieces", "checked", "wrong",
             "median ms", "p99 ms", "all threads", "brute ms");
  for (std::size_t p = 1; p < arguments.size(); ++p) {
    Pieces pieces = cut(arguments[p], settings, codebook);
    search_and_check(*index, table.words, codebook.words, most_checked, pieces);
    wrong += pieces.wrong;
    const Times times = time_search(*index, pieces.queries, kRounds);
    fmt::print("{:<32}{:>7}{:>9}{:>7}{:>11.2f}{:>9.2f}{:>13.2f}{:>10.1f}\n", pieces.picture,
               pieces.queries.size(), pieces.checked, pieces.wrong, times.median_ms, times.p99_ms,
               times.all_threads_ms, pieces.brute_ms);
    std::fflush(stdout);
    nlohmann::json row = to_json(times);
    row["picture"] = pieces.picture;
    row["pieces"] = pieces.queries.size();
    row["checked"] = pieces.checked;
    row["wrong"] = pieces.wrong;
    row["brute_force_all_threads_ms_a_piece"] = pieces.brute_ms;
    report["exact"]["pictures"].push_back(row);
    pictures.push_back(std::move(pieces));
  }
  if (flann) {
    fmt::print("\n{:<13}{:>7}{:>10}{:>9}{:>13}{:>9}{:>8}{:>9}\n", "FLANN", "checks", "median ms", "p99 ms",
               "all threads", "recall", "worst", "MB");
    for (const auto kind :
         {query::FlannKind::kKdTree, query::FlannKind::kHierarchical, query::FlannKind::kKMeans}) {
      report["flann"].push_back(measure_flann(snapshot, table.words, codebook.words, pictures, kind));
    }
  }
  std::ofstream(json_file) << report.dump(1) << '\n';
  if (wrong > 0) fmt::print(stderr, "{} pieces whose candidates are not those of brute force\n", wrong);
  return wrong > 0 ? 1 : 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
