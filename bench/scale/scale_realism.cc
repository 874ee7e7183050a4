// Do stores that bench_scaled_store makes look like real ones to a search?
//
//   bench_scale_realism SOURCE PICTURE[:MATTE].. [--splits 2] [--patches N] [--json FILE]
//
// The clips of SOURCE are split in two halves (class by class, by patches). A generator that sees one half
// makes as many patches as the whole has, and they are held against the real ones, all with SOURCE's
// codebook:
//   words       total variation and divergence of the words' frequencies; the two real halves are the
//   yardstick bins        distinct bins of a patch's pyramid
//   neighbours  scores of ranks 1, 10 and 100 of pieces of the pictures, and of patches of the other half,
//               against the number of patches: real subsets of whole clips, and generated ones
//   copies      best score of a patch among its own source clip and among the others: a generated patch must
//               be no nearer to its source than a real one to the rest of its own clip
// Jitter can be set, to see what each part of it does.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>

#include "bench/harness/machine.h"
#include "bench/harness/picture_argument.h"
#include "bench/harness/seeded_random.h"
#include "bench/scale/scaled_store.h"
#include "bench/scale/store_realism.h"
#include "freshet/error.h"
#include "query/index/exact_index.h"
#include "query/search/target.h"
#include "stored/clip_schema.h"
#include "stored/patch_table.h"
#include "stored/store_settings.h"
#include "stored/stored_codebook.h"

namespace {

using namespace freshet;
using nlohmann::json;
using Words = std::vector<vision::WordMap>;

constexpr std::size_t kQueries = 400;  // of the pictures, and of the other half
constexpr int kOrders = 3;             // of clips, for subsets of a size

struct Real {
  std::vector<std::string> names;  // clips with patches
  std::vector<std::string> classes;
  std::vector<Words> words;  // of each clip
  std::size_t rows = 0;
};

Real read_real(const store::Snapshot& snapshot) {
  Real real;
  for (const store::ClipId clip : snapshot.clips()) {
    const store::ClipRecord& record = snapshot.clip(clip);
    if (record.rows == 0) continue;
    real.names.push_back(record.name);
    real.classes.push_back(record.class_name);
    real.words.push_back(stored::kPatchWords.read(snapshot, clip));
    real.rows += real.words.back().size();
  }
  return real;
}

/// Of each class, clips in drawn order go to the half that has fewer patches.
std::vector<bool> split(const Real& real, std::uint64_t seed) {
  std::vector<std::pair<std::string, std::uint64_t>> key;
  bench::SeededRandom random(seed);
  for (const std::string& name : real.classes) key.emplace_back(name, random.next());
  std::vector<std::size_t> order(real.names.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key[a] < key[b]; });
  std::vector<bool> first(order.size());
  std::size_t in_first = 0, in_second = 0;
  for (const std::size_t clip : order) {
    first[clip] = in_first <= in_second;
    (first[clip] ? in_first : in_second) += real.words[clip].size();
  }
  return first;
}

template <class Keep>
Words gather(const Real& real, Keep keep) {
  Words all;
  for (std::size_t clip = 0; clip < real.words.size(); ++clip) {
    if (keep(clip)) all.insert(all.end(), real.words[clip].begin(), real.words[clip].end());
  }
  return all;
}

/// Whole clips in a drawn order, the last one cut, until there are `rows`.
Words real_subset(const Real& real, std::size_t rows, std::uint64_t seed) {
  std::vector<std::size_t> order(real.words.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  bench::SeededRandom random(seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  Words all;
  for (const std::size_t clip : order) {
    for (const vision::WordMap& words : real.words[clip]) {
      if (all.size() < rows) all.push_back(words);
    }
  }
  return all;
}

struct Generated {
  Words words;
  std::vector<std::size_t> source;  // of each patch: index into Real::names
  std::vector<std::uint64_t> copy;  // of each patch: which clip of the generated ones
};

Generated generate(const store::Snapshot& snapshot, const Real& real, const bench::ScaleOptions& options) {
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < real.names.size(); ++i) index[real.names[i]] = i;
  Generated generated;
  std::uint64_t copy = 0;
  bench::generate(snapshot, options, [&](bench::JitteredClip&& clip, std::uint64_t) {
    generated.words.insert(generated.words.end(), clip.columns.patches.words.begin(),
                           clip.columns.patches.words.end());
    const std::string& name = clip.record.name;
    generated.source.resize(generated.words.size(), index.at(name.substr(0, name.rfind('#'))));
    generated.copy.resize(generated.words.size(), copy++);
  });
  return generated;
}

template <class T>
std::vector<T> thinned(const std::vector<T>& values, std::size_t max_count) {
  std::vector<T> some;
  const std::size_t count = std::min(max_count, values.size());
  for (std::size_t i = 0; i < count; ++i) some.push_back(values[i * values.size() / count]);
  return some;
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

struct Realism {
  const store::Snapshot& snapshot;
  const Real& real;
  int word_count;
  std::vector<query::PieceQuery> pieces;
  json result;

  void print_scores(const std::string& what, std::size_t rows, const std::string& queries,
                    const std::vector<bench::NeighbourScores>& all) {
    bench::NeighbourScores mean;
    for (const bench::NeighbourScores& one : all) {
      mean.first += one.first / static_cast<double>(all.size());
      mean.tenth += one.tenth / static_cast<double>(all.size());
      mean.hundredth += one.hundredth / static_cast<double>(all.size());
    }
    fmt::print("{:<24}{:<10}{:>9}{:>8.4f}{:>8.4f}{:>8.4f}\n", what, queries, rows, mean.first, mean.tenth,
               mean.hundredth);
    result["neighbours"].push_back({{"patches", what},
                                    {"queries", queries},
                                    {"rows", rows},
                                    {"rank_1", mean.first},
                                    {"rank_10", mean.tenth},
                                    {"rank_100", mean.hundredth}});
  }

  bench::NeighbourScores scores(const Words& words, std::span<const query::PieceQuery> queries) const {
    return bench::neighbour_scores(query::ExactIndex(words, word_count), queries);
  }

  void compare_words(const std::string& what, const Words& a, const Words& b) {
    const auto p = bench::word_fractions(a, word_count), q = bench::word_fractions(b, word_count);
    const double variation = bench::total_variation(p, q), bits = bench::divergence_bits(p, q);
    const double bins_a = bench::mean_bins(a, word_count), bins_b = bench::mean_bins(b, word_count);
    fmt::print("{:<40}{:>8.4f}{:>8.4f}{:>8.1f}{:>8.1f}\n", what, variation, bits, bins_a, bins_b);
    result["words"].push_back({{"pair", what},
                               {"total_variation", variation},
                               {"divergence_bits", bits},
                               {"bins", {bins_a, bins_b}}});
  }

  /// Best score of some patches of `from` within their own clip (their own copy or self aside) and outside.
  void copies(const std::string& what, const Words& queries_from, const std::vector<std::size_t>& source_of,
              const std::vector<std::uint64_t>& group_of, const Words& among,
              const std::vector<std::size_t>& source_among, const std::vector<std::uint64_t>& group_among) {
    std::vector<double> within, outside;
    const query::ExactIndex index(among, word_count);
    const std::size_t count = std::min(kQueries, queries_from.size());
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t row = i * queries_from.size() / count;
      query::RowFilter own(among.size(), false), others(among.size(), false);
      for (std::size_t r = 0; r < among.size(); ++r) {
        if (source_among[r] != source_of[row])
          others.allow(r);
        else if (group_among.empty() || group_among[r] != group_of[row])
          own.allow(r);
      }
      const query::PieceQuery query = bench::query_of(queries_from[row]);
      within.push_back(bench::best_scores(index, {&query, 1}, own)[0]);
      outside.push_back(bench::best_scores(index, {&query, 1}, others)[0]);
    }
    fmt::print("{:<44}", what);
    json line{{"what", what}};
    for (const auto& [name, values] : {std::pair{"within", &within}, std::pair{"outside", &outside}}) {
      const double median = quantile(*values, 0.5), high = quantile(*values, 0.95);
      const auto near = static_cast<double>(std::count_if(values->begin(), values->end(),
                                                          [](double score) { return score > 0.5; })) /
                        static_cast<double>(values->size());
      fmt::print("{:>9.3f}{:>8.3f}{:>8.3f}", median, high, near);
      line[name] = {{"median", median}, {"p95", high}, {"share_above_half", near}};
    }
    fmt::print("\n");
    result["copies"].push_back(line);
  }
};

/// Numbers of groups within which neighbours do not count: patches of one clip that share half their place.
/// A real patch's own: its place in steps of its own size, in any variant, is not stored as such; its clip's
/// rows are told apart by blocks of 1 / 16 of the clip's rows instead.
std::vector<std::uint64_t> blocks_of(const Real& real) {
  std::vector<std::uint64_t> blocks;
  for (std::size_t clip = 0; clip < real.words.size(); ++clip) {
    for (std::size_t row = 0; row < real.words[clip].size(); ++row)
      blocks.push_back(clip * 1000 + row * 16 / real.words[clip].size());
  }
  return blocks;
}

int run(int argc, char** argv) {
  CLI::App app("Holds generated patches against real ones");
  bench::ScaleOptions options;
  std::string source, json_file;
  std::vector<std::string> pictures;
  int splits = 2;
  std::uint64_t patches = 0;
  app.add_option("SOURCE", source, "A store of real clips, with its index")->required();
  app.add_option("PICTURE", pictures, "PICTURE[:MATTE]")->required();
  app.add_option("--splits", splits, "Ways to split the clips")->capture_default_str();
  app.add_option("--patches", patches, "Patches of a generated set [as many as SOURCE has]");
  app.add_option("--seed", options.seed, "Of everything that is drawn")->capture_default_str();
  app.add_option("--json", json_file, "Write the figures to this file");
  app.add_option("--bend", options.jitter.bend_px, "px")->capture_default_str();
  app.add_option("--bend-length", options.jitter.bend_length_px, "px")->capture_default_str();
  app.add_option("--detail", options.jitter.detail, "Fraction of foreign detail")->capture_default_str();
  app.add_option("--detail-px", options.jitter.detail_px, "px")->capture_default_str();
  app.add_option("--noise", options.jitter.noise, "grey levels")->capture_default_str();
  app.add_option("--rotation", options.jitter.rotation_deg, "degrees")->capture_default_str();
  app.add_option("--zoom", options.jitter.zoom, "fraction")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  const store::Store store = store::Store::open_read(source);
  const store::Snapshot snapshot = store.snapshot();
  const vision::Settings settings = stored::settings_of(snapshot);
  const vision::Codebook codebook = stored::read_codebook(snapshot);
  const Real real = read_real(snapshot);
  Realism realism{snapshot, real, codebook.words, {}, {}};
  realism.result["machine"] = bench::to_json(bench::this_machine());
  std::vector<query::PieceQuery> pieces;
  for (const std::string& picture : pictures) {
    const auto read = bench::read_picture_argument(picture);
    const auto queries = query::make_target(read.picture, read.matte, settings.grid, codebook).queries;
    pieces.insert(pieces.end(), queries.begin(), queries.end());
  }
  realism.pieces = thinned(pieces, kQueries);
  fmt::print("{}\n{} patches in {} clips, {} pieces of {} pictures\n",
             bench::to_string(bench::this_machine()), real.rows, real.names.size(), realism.pieces.size(),
             pictures.size());

  const auto everything = [](std::size_t) { return true; };
  const Words all = gather(real, everything);
  options.patches = patches > 0 ? patches : real.rows;
  const double start = bench::wall_seconds();
  const Generated from_all = generate(snapshot, real, options);
  fmt::print("{} patches in {} copies generated in {:.1f} s\n", from_all.words.size(),
             from_all.copy.back() + 1, bench::wall_seconds() - start);

  fmt::print("\n{:<40}{:>8}{:>8}{:>8}{:>8}\n", "words of", "var.", "bits", "bins", "bins");
  realism.compare_words("all, generated from all", all, from_all.words);
  std::vector<Generated> from_half;
  std::vector<std::vector<query::PieceQuery>> other_half;
  std::vector<Words> firsts;
  for (int s = 0; s < splits; ++s) {
    const std::vector<bool> first = split(real, options.seed + static_cast<std::uint64_t>(s));
    const Words a = gather(real, [&](std::size_t clip) { return first[clip]; });
    const Words b = gather(real, [&](std::size_t clip) { return !first[clip]; });
    realism.compare_words(fmt::format("split {}: half, other half", s + 1), a, b);
    bench::ScaleOptions half = options;
    for (std::size_t clip = 0; clip < real.names.size(); ++clip) {
      if (first[clip]) half.clips.push_back(real.names[clip]);
    }
    from_half.push_back(generate(snapshot, real, half));
    realism.compare_words(fmt::format("split {}: half, generated from it", s + 1), a, from_half.back().words);
    realism.compare_words(fmt::format("split {}: other half, generated", s + 1), b, from_half.back().words);
    std::vector<query::PieceQuery> queries;
    for (const vision::WordMap& words : thinned(b, kQueries)) queries.push_back(bench::query_of(words));
    other_half.push_back(std::move(queries));
    firsts.push_back(a);
  }

  fmt::print("\n{:<24}{:<10}{:>9}{:>8}{:>8}{:>8}\n", "neighbours among", "of", "patches", "rank 1", "10",
             "100");
  for (const std::size_t rows : {50'000ul, 100'000ul, 200'000ul, 400'000ul}) {
    const std::size_t n = std::min({rows, real.rows, from_all.words.size()});
    if (n < rows / 2) break;
    std::vector<bench::NeighbourScores> scores;
    for (std::uint64_t order = 0; order < (n < real.rows ? kOrders : 1); ++order)
      scores.push_back(realism.scores(real_subset(real, n, options.seed + order), realism.pieces));
    realism.print_scores("real clips", n, "pieces", scores);
    const auto head = [&](const Words& words) {
      return Words(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(std::min(n, words.size())));
    };
    scores.clear();
    for (const Generated& generated : from_half)
      scores.push_back(realism.scores(head(generated.words), realism.pieces));
    if (!scores.empty()) realism.print_scores("generated from a half", n, "pieces", scores);
    realism.print_scores("generated from all", n, "pieces",
                         {realism.scores(head(from_all.words), realism.pieces)});
  }
  for (std::size_t rows = 2 * real.rows; rows <= from_all.words.size(); rows *= 2) {
    const Words some(from_all.words.begin(), from_all.words.begin() + static_cast<std::ptrdiff_t>(rows));
    realism.print_scores("generated from all", rows, "pieces", {realism.scores(some, realism.pieces)});
  }
  for (int s = 0; s < splits; ++s) {
    const auto of = fmt::format("half {}", s + 1);
    realism.print_scores("its real other half", firsts[s].size(), of,
                         {realism.scores(firsts[s], other_half[s])});
    const Words some(from_half[s].words.begin(),
                     from_half[s].words.begin() +
                         static_cast<std::ptrdiff_t>(std::min(firsts[s].size(), from_half[s].words.size())));
    realism.print_scores("generated from that", some.size(), of, {realism.scores(some, other_half[s])});
    realism.print_scores("generated from that", from_half[s].words.size(), of,
                         {realism.scores(from_half[s].words, other_half[s])});
  }

  fmt::print("\n{:<44}{:>9}{:>8}{:>8}{:>9}{:>8}{:>8}\n", "best score: same source clip | others", "median",
             "p95", "> .5", "median", "p95", "> .5");
  std::vector<std::size_t> clip_of;
  for (std::size_t clip = 0; clip < real.words.size(); ++clip)
    clip_of.resize(clip_of.size() + real.words[clip].size(), clip);
  const auto blocks = blocks_of(real);
  realism.copies("real patch, real (its block aside)", all, clip_of, blocks, all, clip_of, blocks);
  realism.copies("generated patch, real", from_all.words, from_all.source, from_all.copy, all, clip_of, {});
  realism.copies("generated patch, generated (its copy aside)", from_all.words, from_all.source,
                 from_all.copy, from_all.words, from_all.source, from_all.copy);
  if (!json_file.empty()) std::ofstream(json_file) << realism.result.dump(2) << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);  // as the program does
  try {
    return run(argc, argv);
  } catch (const Error& error) {
    fmt::print(stderr, "bench_scale_realism: {}\n", error.what());
    return 1;
  }
}
