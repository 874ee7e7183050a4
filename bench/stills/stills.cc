// How many stills suffice for freshet synth stills?
//
//   bench_stills [FILM...] [--stills 4,8,15] [--seconds 4] [--draws 3] [--width 320] [--json FILE]
//   bench_stills smoke fire sea rain $FRESHET_FOOTAGE/clips/fire/candle_yellow.mp4
//
// A FILM is a video, or what `freshet synth simulate` makes by that name. Of its first half so many stills are taken,
// evenly spread and shuffled; a film of that length is made of them, at the pace at which they were taken, and compared
// with that half where it moves (variation above a fifth of the greatest). Then once more with --speed set so that it
// goes as fast as the half. Means over draws of the sequence. Columns:
//   apart      s between stills
//   spectrum   dB: bench/quality's distance of the spectra over time, block by block; less is better
//   speed      log2 of the ratio of mean speeds; below 0 the film is slower
//   paced      the spectrum with --speed set, and of that film:
//   half-life  s after which half of the detail carried along the flow is new
//   again      correlation of each frame's forms with the most alike one half a second or more away
//   a path     stills of a path, in the mean: two say nothing of an order
// The row "other half" is the film's second half against its first: what is as good as footage.
// Checked first: of all frames of an even motion, shuffled, their order and their pace come out.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "bench/harness/seeded_random.h"
#include "bench/quality/quality_footage.h"
#include "bench/quality/quality_measures.h"
#include "freshet/error.h"
#include "synth/simulate/simulate.h"
#include "synth/stills/partial_order.h"
#include "synth/stills/plan.h"
#include "synth/stills/region_proposal.h"
#include "synth/stills/rendering.h"
#include "synth/stills/stills_page.h"

namespace {

using namespace freshet;
namespace fs = std::filesystem;
namespace stills = synth::stills;
namespace simulate = synth::simulate;

struct Asked {
  std::vector<std::string> films{"smoke", "fire", "sea", "rain"};
  std::vector<int> counts{3, 4, 6, 8, 11, 15, 20, 30};
  double seconds = 4;  // of each half
  int draws = 3, width = 320;
};

struct Shot {
  std::string name;
  std::vector<cv::Mat> first, second;
  double fps = 25;
};

Shot shot_of(const std::string& film, const Asked& asked) {
  Shot shot{.name = fs::path(film).stem().string(), .first = {}, .second = {}};
  std::vector<cv::Mat> frames;
  if (fs::exists(film)) {
    frames = bench::read_video(film, asked.width, &shot.fps);
  } else {
    const int height = asked.width * 9 / 16 / bench::kSpectrumBlock * bench::kSpectrumBlock;
    simulate::Simulation simulation({.kind = simulate::parse_scene_kind(film),
                                     .size = {asked.width, height},
                                     .frames = 2 * static_cast<int>(std::lround(asked.seconds * shot.fps)),
                                     .fps = shot.fps,
                                     .seed = 3});
    for (simulate::SimulatedFrame frame; simulation.next(frame);) frames.push_back(frame.picture.clone());
  }
  const auto half = std::min(static_cast<std::ptrdiff_t>(frames.size() / 2),
                             static_cast<std::ptrdiff_t>(std::lround(asked.seconds * shot.fps)));
  constexpr int kFewest = 26;  // frames, for a lifetime
  if (half < kFewest)
    throw Error(ErrorKind::kInput, film, fmt::format("{} frames, {} expected", frames.size(), 2 * kFewest));
  shot.first.assign(frames.begin(), frames.begin() + half);
  shot.second.assign(frames.begin() + half, frames.begin() + 2 * half);
  return shot;
}

cv::Mat moving(const std::vector<cv::Mat>& frames) {
  std::vector<cv::Mat> some;
  for (std::size_t i = 0; i < frames.size(); i += std::max<std::size_t>(1, frames.size() / 24))
    some.push_back(frames[i]);
  const cv::Mat variation = stills::variation_of(some);
  double most = 0;
  cv::minMaxLoc(variation, nullptr, &most);
  return variation > .2 * most;
}

bench::Film measured(const std::vector<cv::Mat>& frames, double fps, const bench::Region& region) {
  const std::vector<cv::Mat> luma = bench::luma_of(frames);
  return bench::measure(luma, bench::pair_motions(luma), fps, region);
}

struct Made {
  std::vector<cv::Mat> frames;
  double path = 0;  // stills, mean
};

/// As long as the shot's first half. draw   of the sequence and of the stills' shuffling. speed   factor.
Made made_of(const Shot& shot, int count, int draw, double speed) {
  const auto frames = static_cast<int>(shot.first.size());
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  bench::SeededRandom random(17, static_cast<std::uint64_t>(draw));
  for (std::size_t i = order.size(); i-- > 1;) std::swap(order[i], order[random.below(i + 1)]);
  std::vector<cv::Mat> taken;
  std::vector<std::string> names;
  for (const int at : order) {
    taken.push_back(shot.first[static_cast<std::size_t>(at) * (frames - 1) / (count - 1)]);
    names.push_back(std::to_string(names.size()));
  }
  stills::PlanOptions options{.seconds = frames / shot.fps};
  options.timing.step_s = options.seconds / (count - 1);
  options.timing.speed = speed;
  options.sampling.seed = static_cast<std::uint64_t>(draw) + 1;
  const stills::Plan plan = stills::make_plan(taken, names, stills::propose_regions(taken).regions, options);
  Made made;
  int paths = 0;
  for (const stills::PlannedRegion& region : plan.regions)
    for (const stills::Path& path : stills::one_way(region.paths)) {
      made.path += static_cast<double>(path.size());
      ++paths;
    }
  made.path /= std::max(1, paths);
  stills::render_frames(plan, taken, {.fps = shot.fps, .frames = frames, .flow_side = 480},
                        [&](const cv::Mat& frame) { made.frames.push_back(frame.clone()); });
  return made;
}

struct Row {
  std::string film, stills;
  double apart = 0, spectrum = 0, speed = 0, paced = 0, half_life = 0, again = 0, path = 0;
};

void add_paced(Row& row, const bench::Film& film, const bench::Film& truth, const bench::Region& region,
               double share) {
  row.paced += share * bench::compare(film, truth, region).spectrum_db;
  row.half_life += share * film.half_life_s;
  row.again += share * film.again;
}

/// One draw.
void add(Row& row, const Shot& shot, int count, int draw, const bench::Film& truth,
         const bench::Region& region, double share) {
  const Made made = made_of(shot, count, draw, 1);
  const bench::Distance far = bench::compare(measured(made.frames, shot.fps, region), truth, region);
  row.path += share * made.path;
  row.spectrum += share * far.spectrum_db;
  row.speed += share * far.pace;
  const double speed = std::clamp(std::exp2(-far.pace), .05, 20.);
  add_paced(row, measured(made_of(shot, count, draw, speed).frames, shot.fps, region), truth, region, share);
}

void print(const Row& row) {
  fmt::print("{:<24}{:>12}{:8.2f}{:10.2f}{:+8.2f}{:8.2f}{:11.2f}{:8.2f}{:8.1f}\n", row.film, row.stills,
             row.apart, row.spectrum, row.speed, row.paced, row.half_life, row.again, row.path);
  std::fflush(stdout);
}

std::vector<Row> rows_of(const Shot& shot, const Asked& asked) {
  std::vector<cv::Mat> all = shot.first;
  all.insert(all.end(), shot.second.begin(), shot.second.end());
  const bench::Region region{.matte = moving(all), .border = {}};
  const bench::Film truth = measured(shot.first, shot.fps, region);
  std::vector<Row> rows{{.film = shot.name, .stills = "other half"}};
  const bench::Film other = measured(shot.second, shot.fps, region);
  add_paced(rows[0], other, truth, region, 1);
  rows[0].spectrum = rows[0].paced;
  if (rows[0].spectrum == 0)
    throw Error(ErrorKind::kInput, shot.name,
                fmt::format("no block of {} px moves as a whole", bench::kSpectrumBlock), "Raise --width");
  rows[0].speed = bench::compare(other, truth, region).pace;
  print(rows[0]);
  for (const int count : asked.counts) {
    const auto frames = static_cast<double>(shot.first.size());
    if (count > frames) continue;
    Row& row = rows.emplace_back();
    row.film = shot.name;
    row.stills = std::to_string(count);
    row.apart = frames / shot.fps / (count - 1);
    for (int draw = 0; draw < asked.draws; ++draw)
      add(row, shot, count, draw, truth, region, 1. / asked.draws);
    print(row);
  }
  return rows;
}

/// A disc that goes evenly from side to side: its order and its pace must come out.
void check() {
  Shot shot{.name = "check", .first = {}, .second = {}};
  constexpr int kFrames = 40;
  for (int i = 0; i < kFrames; ++i) {
    shot.first.emplace_back(96, 256, CV_8UC3, cv::Scalar::all(40));
    cv::circle(shot.first.back(), {40 + 4 * i, 48}, 22, cv::Scalar::all(220), cv::FILLED, cv::LINE_AA);
  }
  const bench::Region region{.matte = moving(shot.first), .border = {}};
  Row row;
  add(row, shot, kFrames, 0, measured(shot.first, shot.fps, region), region, 1);
  if (row.path < kFrames || std::abs(row.speed) > .3)
    throw Error(
        ErrorKind::kInput, "bench_stills",
        fmt::format("the check failed: of {} frames of an even motion a path holds {:.1f}, and the film is "
                    "2^{:.2f} times as fast",
                    kFrames, row.path, row.speed));
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  Asked asked;
  std::string json;
  bench::Arguments app("Films made of few and of many stills, beside the footage the stills are from");
  app.option("FILM", asked.films, "Videos, or names of simulations");
  app.option("--stills", asked.counts, "How many stills").split_at(',').between(2, 200);
  app.option("--seconds", asked.seconds, "Of each half of a film, s");
  app.option("--draws", asked.draws, "Sequences of each").between(1, 100);
  app.option("--width", asked.width, "Longer side, px").between(128, 4096);
  app.option("--json", json, "Write the figures");
  app.parse(argc, argv);
  try {
    const bench::Machine machine = bench::this_machine();
    fmt::print("{}\n", bench::to_string(machine));
    check();
    fmt::print("{:<24}{:>12}{:>8}{:>10}{:>8}{:>8}{:>11}{:>8}{:>8}\n", "film", "stills", "apart", "spectrum",
               "speed", "paced", "half-life", "again", "a path");
    nlohmann::json figures = nlohmann::json::array();
    for (const std::string& film : asked.films)
      for (const Row& row : rows_of(shot_of(film, asked), asked))
        figures.push_back({{"film", row.film},
                           {"stills", row.stills},
                           {"apart_s", row.apart},
                           {"spectrum_db", row.spectrum},
                           {"speed_log2", row.speed},
                           {"paced_spectrum_db", row.paced},
                           {"half_life_s", row.half_life},
                           {"again", row.again},
                           {"stills_a_path", row.path}});
    if (!json.empty())
      std::ofstream(json) << nlohmann::json{{"machine", bench::to_json(machine)}, {"rows", figures}}.dump(1)
                          << '\n';
  } catch (const Error& fault) {
    fmt::print(stderr, "{}\n", fault.what());
    return 1;
  }
}
