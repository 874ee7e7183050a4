// How coarse may motion spectra and textureness be kept before labelling notices?
//
//   bench_cell_choice CLIP.. [--frames N] [--json FILE]
//   bench_cell_choice $FRESHET_FOOTAGE/clips/water/{fountain_jet_dyntex.avi,river_shallow_gravel.mp4,...}
//
// The reference is Okabe et al. 2011, Eq. 2, 3 and 6: flow, power of every frequency and textureness at every
// pixel (cell 1, flow step 1, no bands), but in windows of 1.28 s; the paper's one window over the whole clip
// is a row of its own. Against it, for both forms of the cost: rank correlation of the costs of 200 patches
// beside 200 others, all variants, from any clip; whether the best neighbours stay the best; and the energy,
// under the reference's tables, of pictures labelled with pooled ones. Beside it what a clip, a patch and a
// table take. Each clip is once the picture, without its own patches.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <opencv2/core/utility.hpp>
#include <random>

#include "bench/choices/measured_cells.h"
#include "bench/harness/features_of_patches.h"
#include "bench/harness/machine.h"
#include "bench/harness/median.h"
#include "freshet/error.h"
#include "ingest/ingest.h"
#include "media/frame/frame.h"
#include "query/index/index_builder.h"
#include "query/labelling/labelling.h"
#include "store/store.h"
#include "stored/clip_frames.h"
#include "vision/flow.h"

namespace {

using namespace freshet;
using bench::Footage;
using bench::measure;
using bench::Measured;
using bench::read_footage;
using bench::source_of;
namespace fs = std::filesystem;

struct Setting {
  int step, cell, bands;  // as in vision::Settings; 0 bands: every frequency
  double window_s = 1.28;
};
constexpr double kWholeClip_s = 4;
constexpr Setting kSettings[] = {{1, 1, 0},  // the reference
                                 {1, 1, 0, kWholeClip_s},
                                 {1, 1, 8},
                                 {1, 4, 0},
                                 {1, 2, 8},
                                 {1, 4, 8},
                                 {2, 2, 8},
                                 {2, 4, 0},
                                 {2, 4, 8},
                                 {2, 4, 4},
                                 {4, 4, 8},
                                 {2, 8, 0},
                                 {2, 8, 8},
                                 {2, 8, 4},
                                 {4, 8, 8}};
constexpr std::size_t kPatches = 200;  // on either side of the edge
constexpr query::CostForm kForms[] = {query::CostForm::kLog, query::CostForm::kPower};

vision::Settings with(const Setting& setting) {
  vision::Settings settings;
  settings.flow_step = setting.step;
  settings.texture_cell = settings.spectrum.cell = setting.cell;
  settings.spectrum.bands = setting.bands;
  settings.spectrum.window_s = setting.window_s;
  return settings;
}

/// The defaults; the log form's weight of a band is such that all bands together weigh as the default eight.
query::PairwiseOptions costs_of(query::CostForm form, const query::FeatureShape& shape) {
  query::PairwiseOptions options = query::default_costs(form);
  if (form == query::CostForm::kLog) options.sigma *= 8.0 / shape.bands;
  return options;
}

/// Two neighbouring pieces, each with as many candidates as there are rows for it.
query::Mrf edge_between(const std::vector<stored::Row>& rows, const Measured& measured, query::CostForm form,
                        const query::FeatureSource& source) {
  query::Target target;
  target.columns = 2, target.rows = 1;
  target.places = {{0, 0}, {1, 0}};
  target.corners = {{0, 0}, {target.stride, 0}};
  target.edges = {{0, 1}};
  query::Candidates candidates;
  candidates.k = rows.size() / 2;
  candidates.rows = rows;
  candidates.scores.assign(rows.size(), 0);
  candidates.counts.assign(2, static_cast<std::uint32_t>(candidates.k));
  const query::FeatureShape shape = query::feature_shape(measured.settings);
  return build_mrf(target, candidates, shape, costs_of(form, shape), source);
}

/// The reference is what the paper says: a pixel's power against a slow transform of its flow, and the raw
/// cost of some pairs against Eq. 2, 3 and 6 in plain loops.
void check_reference(const Measured& exact, const Footage& footage, const std::vector<stored::Row>& rows,
                     const query::FeatureSource& source) {
  const auto& spectrum = exact.settings.spectrum;
  const cv::Point pixel(footage.luma[0].cols / 2, footage.luma[0].rows / 2);
  std::vector<double> series;
  for (const cv::Mat& flow : footage.flow) {
    cv::Mat u, v;
    vision::quantize_flow(flow, 1, u, v);
    series.push_back(u.at<short>(pixel) * double{vision::kFlowUnit} * footage.fps);
  }
  const auto slow = vision::naive_power(series, footage.fps, spectrum);
  const auto fast = exact.motion[0].at(pixel.y, pixel.x);
  const double whole = std::accumulate(slow.begin(), slow.end(), 0.0);
  for (std::size_t n = 1; n < slow.size(); ++n) {
    if (std::abs(slow[n] - vision::band_power(fast.data(), static_cast<int>(n) - 1).u) > 1e-4 * whole) {
      throw Error(ErrorKind::kDamaged, "the reference", fmt::format("power of bin {} is not Eq. 2's", n));
    }
  }
  const query::FeatureShape shape = query::feature_shape(exact.settings);
  const auto mrf = edge_between(rows, exact, query::CostForm::kPower, source);
  for (std::size_t i = 0; i < kPatches; i += 23) {
    const std::vector<float> p = bench::features_of_patches(source, shape, {{rows[i]}});
    const std::vector<float> q = bench::features_of_patches(source, shape, {{rows[kPatches + i]}});
    double cost = 0;
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 24; ++x) {
        const int channels = shape.channels();
        for (int c = 0; c < channels; ++c) {
          const double weight = c < 2                     ? 1 / (25.0 * 25)
                                : c < 2 + 2 * shape.bands ? 100 / std::pow(25.0, 4)
                                                          : 100.0 * 100;
          const double difference = double{p[static_cast<std::size_t>((y * 48 + x + 24) * channels + c)]} -
                                    q[static_cast<std::size_t>((y * 48 + x) * channels + c)];
          cost += 0.01 * weight * difference * difference / (48 * 24);
        }
      }
    }
    if (std::abs(cost - mrf.pairwise[i * kPatches + i]) > 2e-3 * cost) {
      throw Error(ErrorKind::kDamaged, "the reference", "the cost of a pair is not Eq. 6's");
    }
  }
}

std::vector<double> ranks(std::span<const query::PairCost> costs) {
  std::vector<std::size_t> order(costs.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return costs[a] < costs[b]; });
  std::vector<double> rank(costs.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<double>(i);
  return rank;
}

struct Agreement {
  double spearman_median = 0, spearman_worst = 1, top10 = 0, best_is_best = 0, best_rank_median = 0;
};

Agreement compare(const query::Mrf& exact, const query::Mrf& pooled) {
  Agreement result;
  std::vector<double> spearman, best_rank;
  const double n = kPatches;
  for (std::size_t row = 0; row < kPatches; ++row) {
    const auto a = ranks(std::span(exact.pairwise).subspan(row * kPatches, kPatches));
    const auto b = ranks(std::span(pooled.pairwise).subspan(row * kPatches, kPatches));
    double squares = 0;
    for (std::size_t i = 0; i < kPatches; ++i) {
      squares += (a[i] - b[i]) * (a[i] - b[i]);
      if (a[i] < 10 && b[i] < 10) result.top10 += 0.1 / n;
      if (b[i] == 0) best_rank.push_back(a[i] + 1);
    }
    spearman.push_back(1 - 6 * squares / (n * (n * n - 1)));
    result.best_is_best += (best_rank.back() == 1) / n;
  }
  result.spearman_median = bench::median(spearman);
  result.spearman_worst = *std::min_element(spearman.begin(), spearman.end());
  result.best_rank_median = bench::median(best_rank);
  return result;
}

/// Energies under the reference of one picture's labelling by another setting.
struct Loss {
  double of_energy = 0;  // above the reference's own labelling, as a fraction of its energy
  double of_gain = 0;    // as a fraction of what that gains over each piece's best likeness alone
  double other_labels = 0;
};

Loss loss_of(const query::Mrf& exact, const query::Solution& best, const query::Labels& labels) {
  const double above = energy(exact, labels) - best.energy;
  Loss loss{above / best.energy, above / (energy(exact, unary_minimum(exact)) - best.energy), 0};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    loss.other_labels += (labels[i] != best.labels[i]) / static_cast<double>(labels.size());
  }
  return loss;
}

/// Pieces and candidates of each clip's middle frame, a part of it as large as the reference's tables allow.
std::vector<query::CandidateSearch> search_all(const store::Snapshot& snapshot,
                                               const query::SearchBase& base) {
  std::vector<query::CandidateSearch> searches;
  for (const store::ClipId id : base.table.clips) {
    const stored::ClipFrames frames(snapshot, id);
    const cv::Mat frame = media::to_bgr(frames.read(frames.size() / 2));
    const cv::Size part(std::min(264, frame.cols), std::min(168, frame.rows));
    const cv::Point corner((frame.cols - part.width) / 2, (frame.rows - part.height) / 2);
    query::LabelOptions options;
    options.candidates.k = 40;
    options.candidates.excluded_clips = {snapshot.clip(id).name};
    searches.push_back(query::search_candidates(snapshot, base, frame(cv::Rect(corner, part)).clone(),
                                                cv::Mat(part, CV_8U, cv::Scalar(255)), options));
  }
  return searches;
}

/// A figure, its heading and its decimals.
struct Column {
  const char* heading;
  int decimals;
  double value;
};

/// Prints a row, below headings where a new part of the table begins; the same as JSON.
nlohmann::json print_row(const char* form, bool headings, const std::vector<Column>& columns) {
  nlohmann::json row{{"form", form}};
  if (headings) {
    fmt::print("\n{:<6}", form);
    for (const Column& column : columns) fmt::print("{:>9}", column.heading);
    fmt::print("\n");
  }
  fmt::print("{:<6}", "");
  for (const Column& column : columns) {
    fmt::print("{:>9.{}f}", column.value, column.decimals);
    row[column.heading] = column.value;
  }
  fmt::print("\n");
  std::fflush(stdout);
  return row;
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<fs::path> clips;
  std::uint32_t max_frames = 100;
  std::string json_file;
  CLI::App app("How coarse may motion spectra and textureness be kept before labelling notices?");
  app.add_option("CLIP", clips, "At least two")->required()->expected(2, -1);
  app.add_option("--frames", max_frames, "The first frames of each clip")->capture_default_str();
  app.add_option("--json", json_file, "Write the figures here");
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  std::string name = (fs::temp_directory_path() / "cell_choice_XXXXXX").string();
  const fs::path folder = mkdtemp(name.data());
  store::Store store = store::Store::create(folder / "clips.freshet", vision::to_json({}));
  const auto report = ingest::ingest(store, {}, clips, {.force = true});
  if (report.count(ingest::Outcome::kAdded) != clips.size()) {
    throw Error(ErrorKind::kInput, "the clips", "not all of them can be kept");
  }
  query::build_index(store);
  const store::Snapshot snapshot = store.snapshot();
  const query::SearchBase base = query::open_search(snapshot);
  const stored::PatchTable& table = base.table;

  std::vector<Measured> measured;
  for (const Setting& setting : kSettings) measured.push_back({with(setting), {}, {}});
  Footage first;
  for (const store::ClipId id : table.clips) {
    const Footage footage = read_footage(snapshot, id, max_frames);
    for (Measured& each : measured) measure(footage, snapshot.clip(id), folder, each);
    if (first.luma.empty()) first = footage;
  }

  std::mt19937 random(7);
  std::vector<stored::Row> rows;
  while (rows.size() < 2 * kPatches) {  // as many of each clip
    const std::size_t clip = rows.size() % table.clips.size();
    const stored::Row from = table.first_row[clip], count = table.first_row[clip + 1] - from;
    if (count == 0) throw Error(ErrorKind::kInput, clips[clip].string(), "has no patch that moves");
    rows.push_back(from + static_cast<stored::Row>(random() % count));
  }
  std::shuffle(rows.begin(), rows.end(), random);
  std::vector<query::FeatureSource> sources;
  for (const Measured& each : measured) sources.push_back(source_of(each, snapshot, table));
  check_reference(measured[0], first, rows, sources[0]);

  const auto pictures = search_all(snapshot, base);

  fmt::print("{} clips of {} frames, {} patches; compiler {}\n", clips.size(), max_frames, table.size(),
             __VERSION__);
  nlohmann::json json{{"bench", "cell_choice"}, {"compiler", __VERSION__}, {"patches", 2 * kPatches}};
  for (const query::CostForm form : kForms) {
    std::vector<query::Mrf> exact;  // an edge, then the pictures
    std::vector<query::Solution> best;
    for (std::size_t s = 0; s < measured.size(); ++s) {
      const auto shape = query::feature_shape(measured[s].settings);
      const double start = bench::process_seconds();
      query::Mrf edge = edge_between(rows, measured[s], form, sources[s]);
      const double seconds = bench::process_seconds() - start;
      if (s == 0) exact.push_back(edge);
      const Agreement agreement = compare(exact[0], edge);
      Loss mean;
      double worst = 0;
      for (std::size_t i = 0; i < pictures.size(); ++i) {
        query::Mrf mrf =
            build_mrf(pictures[i].target, pictures[i].candidates, shape, costs_of(form, shape), sources[s]);
        const query::Solution solution = minimize(mrf, query::Minimizer::kTrwS);
        if (s == 0) {
          exact.push_back(std::move(mrf));
          best.push_back(solution);
        }
        const Loss loss = loss_of(exact[i + 1], best[i], solution.labels);
        const double fraction = 1.0 / static_cast<double>(pictures.size());
        mean.of_energy += fraction * loss.of_energy;
        mean.of_gain += fraction * loss.of_gain;
        mean.other_labels += fraction * loss.other_labels;
        worst = std::max(worst, loss.of_energy);
      }
      const double of_clips = 1.0 / static_cast<double>(clips.size());
      json["rows"].push_back(
          print_row(name_of(form), s == 0,
                    {{"step", 0, 1.0 * kSettings[s].step},
                     {"cell", 0, 1.0 * kSettings[s].cell},
                     {"bands", 0, 1.0 * shape.bands},
                     {"window s", 2, kSettings[s].window_s},
                     {"rho", 4, agreement.spearman_median},
                     {"worst", 3, agreement.spearman_worst},
                     {"top 10", 2, agreement.top10},
                     {"best", 2, agreement.best_is_best},
                     {"rank", 0, agreement.best_rank_median},
                     {"energy %", 2, 100 * mean.of_energy},
                     {"max %", 2, 100 * worst},
                     {"gain %", 1, 100 * mean.of_gain},
                     {"other", 2, mean.other_labels},
                     {"cells MB", 2, measured[s].cells_mb * of_clips},
                     {"flow MB", 2, measured[s].flow_mb * of_clips},
                     {"KB/patch", 1, static_cast<double>(shape.values() * sizeof(float)) / 1e3},
                     {"CPU s", 3, seconds}}));
    }
  }
  if (!json_file.empty()) std::ofstream(json_file) << json.dump(1) << '\n';
  store = {};
  fs::remove_all(folder);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
