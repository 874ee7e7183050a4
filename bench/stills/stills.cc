// bench_stills — does freshet synth stills find the order of stills, what lies between them, and what moves
// by itself?
//
//   bench_stills order FOOTAGE     15 frames of each of ten clips and three simulations, shuffled: share of
//                                  steps of the kept paths that join true neighbours, Kendall's tau, beside
//                                  nearest-neighbour chains, a shortest tour, chance
//   bench_stills between FOOTAGE   the middle of frames 2, 4, 8, 16 apart: PSNR and SSIM where the clip
//                                  moves, beside a cross-fade, plain DIS warping, FFmpeg's minterpolate
//   bench_stills candles FOOTAGE   six candles from one clip at six phases: regions proposed
//   bench_stills motion FOOTAGE    clips and two lakes against animations from 15 of their frames, and
//                                  against ablations
//
// Checked first: the order of a disc that moves evenly, and the middle of two equal stills, are known.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/harness/machine.h"
#include "bench/harness/seeded_random.h"
#include "bench/quality/quality_measures.h"
#include "bench/stills/stills_clip.h"
#include "freshet/error.h"
#include "media/picture/picture.h"
#include "platform/whole_file.h"
#include "synth/stills/between.h"
#include "synth/stills/page.h"
#include "synth/stills/partial_order.h"
#include "synth/stills/plan.h"
#include "synth/stills/region_proposal.h"
#include "synth/stills/rendering.h"
#include "synth/stills/still_set.h"
#include "vision/flow.h"

namespace freshet::bench {
namespace {

namespace fs = std::filesystem;
namespace stills = synth::stills;
using Json = nlohmann::json;
using stills::Path;

// ---- order ----

struct Order {
  // Share of steps; mean over paths, weighed by their pairs; stills a path; stills on any path.
  double neighbours = 0, tau = 0, length = 0, covered = 0;
};

double kendall(const Path& path) {
  int same = 0, other = 0;
  for (std::size_t i = 0; i < path.size(); ++i)
    for (std::size_t j = i + 1; j < path.size(); ++j) ++(path[i] < path[j] ? same : other);
  return std::abs(same - other) / static_cast<double>(same + other);
}

/// Stills are numbered by time.
Order judge(const std::vector<Path>& paths) {
  Order order;
  int steps = 0, right = 0;
  double pairs = 0;
  for (const Path& path : stills::one_way(paths)) {
    for (std::size_t k = 0; k + 1 < path.size(); ++k, ++steps) right += std::abs(path[k] - path[k + 1]) == 1;
    const double weight = .5 * static_cast<double>(path.size() * (path.size() - 1));
    order.tau += weight * kendall(path);
    order.length += static_cast<double>(path.size());
    pairs += weight;
  }
  const auto count = static_cast<double>(stills::one_way(paths).size());
  std::set<int> covered;
  for (const Path& path : paths) covered.insert(path.begin(), path.end());
  return {steps > 0 ? static_cast<double>(right) / steps : 0, pairs > 0 ? order.tau / pairs : 0,
          count > 0 ? order.length / count : 0, static_cast<double>(covered.size())};
}

Path nearest_chain(const stills::Square<double>& rms, int start) {
  Path path{start};
  std::vector<char> used(static_cast<std::size_t>(rms.n), 0);
  used[start] = 1;
  while (static_cast<int>(path.size()) < rms.n) {
    int best = -1;
    for (int j = 0; j < rms.n; ++j)
      if (!used[j] && (best < 0 || rms(path.back(), j) < rms(path.back(), best))) best = j;
    used[best] = 1;
    path.push_back(best);
  }
  return path;
}

/// Open tours from every start, improved by turning stretches round until nothing gets shorter.
Path shortest_tour(const stills::Square<double>& rms) {
  const auto length = [&](const Path& path) {
    double sum = 0;
    for (std::size_t k = 0; k + 1 < path.size(); ++k) sum += rms(path[k], path[k + 1]);
    return sum;
  };
  Path best;
  for (int start = 0; start < rms.n; ++start) {
    Path path = nearest_chain(rms, start);
    for (bool better = true; better;) {
      better = false;
      for (std::size_t i = 0; i + 1 < path.size(); ++i)
        for (std::size_t j = i + 1; j < path.size(); ++j) {
          Path turned = path;
          std::reverse(turned.begin() + static_cast<std::ptrdiff_t>(i),
                       turned.begin() + static_cast<std::ptrdiff_t>(j) + 1);
          if (length(turned) < length(path) - 1e-9) path = turned, better = true;
        }
    }
    if (best.empty() || length(path) < length(best)) best = path;
  }
  return best;
}

Json order_of(const std::string& name, bool simulated, const std::vector<cv::Mat>& frames, double seconds) {
  // Shuffled, so that no tie is decided by time.
  std::vector<int> time(frames.size());
  std::iota(time.begin(), time.end(), 0);
  SeededRandom random(17);
  for (std::size_t i = time.size(); i-- > 1;) std::swap(time[i], time[random.below(i + 1)]);
  std::vector<cv::Mat> shuffled;
  for (const int each : time) shuffled.push_back(frames[each]);
  const auto timed = [&](std::vector<Path> paths) {
    for (Path& path : paths)
      for (int& still : path) still = time[still];
    return judge(paths);
  };
  const cv::Mat mask = moving_mask(shuffled);
  const stills::Square<double> rms = stills::still_distances(shuffled, mask);
  const stills::Square<double> plain = stills::still_distances(shuffled, mask, .6);
  const auto paths = [&](double power, const stills::Square<double>& distances) {
    return stills::extremal_paths(stills::make_graph(distances, {.power = power}));
  };
  Path random_path(frames.size());
  std::iota(random_path.begin(), random_path.end(), 0);
  std::vector<Path> draws;
  for (int draw = 0; draw < 200; ++draw) {
    for (std::size_t i = random_path.size(); i-- > 1;)
      std::swap(random_path[i], random_path[random.below(i + 1)]);
    draws.push_back(random_path);
  }
  const std::vector<std::pair<std::string, Order>> rows{
      {"ours", timed(paths(stills::GraphOptions{}.power, rms))},
      {"power 4", timed(paths(4, rms))},
      {"power 4, no blur", timed(paths(4, plain))},
      {"power 1 (as printed)", timed(paths(1, plain))},
      {"nearest chain", timed({nearest_chain(rms, 0)})},
      {"shortest tour", timed({shortest_tour(rms)})},
      {"shortest tour, no blur", timed({shortest_tour(plain)})},
      {"chance", judge(draws)}};
  Json json{{"clip", name}, {"simulated", simulated}, {"seconds", seconds}};
  fmt::print("{:<26}{:5.1f} s ", name, seconds);
  for (const auto& [method, order] : rows) {
    json[method] = {{"neighbours", order.neighbours},
                    {"tau", order.tau},
                    {"length", order.length},
                    {"covered", order.covered}};
    fmt::print(" {:.2f}/{:.2f}/{:<4.1f}", order.neighbours, order.tau, order.length);
  }
  fmt::print("\n");
  std::fflush(stdout);
  return json;
}

/// Means of each method over rows first .. end - 1.
void print_means(const Json& rows, std::size_t first, std::size_t end, const char* of) {
  static const std::array<const char*, 4> kFigures{"neighbours", "tau", "length", "covered"};
  std::map<std::string, std::array<double, 4>> sum;
  for (std::size_t k = first; k < end; ++k)
    for (const auto& [method, value] : rows[k].items())
      for (std::size_t i = 0; value.is_object() && i < kFigures.size(); ++i)
        sum[method][i] += value[kFigures[i]].get<double>() / static_cast<double>(end - first);
  for (const auto& [method, mean] : sum)
    fmt::print("mean of {:<12} {:<24} {:.3f} / {:.3f} / {:4.1f}, {:4.1f} stills on paths\n", of, method,
               mean[0], mean[1], mean[2], mean[3]);
}

Json run_order(const fs::path& footage) {
  fmt::print(
      "15 stills; share of steps between true neighbours / tau / stills a path, of ours, power "
      "4,\n"
      "power 4 without blur, power 1 (as printed), nearest chain, shortest tour, that without blur, "
      "chance\n");
  Json rows = Json::array();
  const auto add = [&](const StillsClip& clip, bool simulated) {
    for (const double seconds : {2.5, 8.0}) {
      const auto length = std::min(clip.frames.size(), static_cast<std::size_t>(seconds * clip.fps));
      std::vector<cv::Mat> frames;
      for (std::size_t i = 0; i < 15; ++i) frames.push_back(clip.frames[i * (length - 1) / 14]);
      rows.push_back(order_of(clip.name, simulated, frames, static_cast<double>(length) / clip.fps));
    }
  };
  for (const fs::path& path : stills_clips(footage)) add(read_stills_clip(path, 320, 240), false);
  const std::size_t real = rows.size();
  for (const char* scene : {"smoke", "fire", "waterfall"})
    add(simulated_stills_clip(scene, {320, 176}, 200), true);
  print_means(rows, real, rows.size(), "simulations");
  print_means(rows, 0, real, "real clips");
  return rows;
}

// ---- between ----

struct Likeness {
  double psnr = 0, ssim = 0;
};

Likeness likeness(const cv::Mat& made, const cv::Mat& truth, const cv::Mat& mask) {
  cv::Mat a, b, difference, ga, gb;
  made.convertTo(a, CV_32F);
  truth.convertTo(b, CV_32F);
  cv::subtract(a, b, difference);
  difference = difference.mul(difference);
  const cv::Scalar mean = cv::mean(difference, mask);
  cv::cvtColor(a, ga, cv::COLOR_BGR2GRAY);
  cv::cvtColor(b, gb, cv::COLOR_BGR2GRAY);
  return {10 * std::log10(255 * 255 / std::max(1e-9, (mean[0] + mean[1] + mean[2]) / 3)),
          cv::mean(ssim_map(ga, gb), mask)[0]};
}

cv::Mat plain_warp(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat ga, gb;
  cv::cvtColor(a, ga, cv::COLOR_BGR2GRAY);
  cv::cvtColor(b, gb, cv::COLOR_BGR2GRAY);
  const cv::Mat flow = vision::optical_flow(ga, gb);
  cv::Mat from(a.size(), CV_32FC2), to(a.size(), CV_32FC2), wa, wb, out;
  for (int y = 0; y < a.rows; ++y)
    for (int x = 0; x < a.cols; ++x) {
      const cv::Vec2f at(static_cast<float>(x), static_cast<float>(y)), move = flow.at<cv::Vec2f>(y, x);
      from.at<cv::Vec2f>(y, x) = at - .5f * move;
      to.at<cv::Vec2f>(y, x) = at + .5f * move;
    }
  cv::remap(a, wa, from, {}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::remap(b, wb, to, {}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::addWeighted(wa, .5, wb, .5, 0, out);
  return out;
}

/// What FFmpeg puts between the two; empty where it fails. It needs frames before and after: both are
/// repeated.
cv::Mat minterpolated(const cv::Mat& a, const cv::Mat& b, const fs::path& scratch) {
  for (int i = 0; i < 4; ++i) media::write_picture(scratch / fmt::format("in{}.png", i), i < 2 ? a : b);
  // At twice the rate frame 3 lies half way between frames 1 and 2 of the input.
  const std::string command = fmt::format(
      "cd '{0}' && rm -f out*.png && nice ffmpeg -v error -y -framerate 1 -i in%d.png -vf "
      "minterpolate=fps=2:mi_mode=mci:mc_mode=aobmc:me_mode=bidir:vsbmc=1:scd=none -pix_fmt bgr24 out%d.png "
      "< /dev/null",
      scratch.string());
  if (std::system(command.c_str()) != 0) return {};
  // Its first frame is input 0's or 1's by version: the one least like either still is the middle.
  cv::Mat best;
  double most = -1;
  for (int i = 1; i < 9; ++i) {
    const fs::path file = scratch / fmt::format("out{}.png", i);
    if (!fs::exists(file)) continue;
    const cv::Mat frame = media::read_picture(file).bgr;
    const double away = std::min(cv::norm(frame, a, cv::NORM_L1), cv::norm(frame, b, cv::NORM_L1));
    if (away > most) most = away, best = frame;
  }
  return best;
}

Json run_between(const fs::path& footage, int samples) {
  const fs::path scratch = fs::temp_directory_path() / fmt::format("bench_stills_{}", ::getpid());
  fs::create_directories(scratch);
  Json rows = Json::array();
  std::map<int, std::map<std::string, std::vector<double>>> psnr, ssim;
  fmt::print(
      "PSNR, dB / SSIM where the clip moves, of the middle of two frames\n{:<26}apart  cross-fade    ours    "
      "      plain DIS     minterpolate\n",
      "");
  for (const fs::path& path : stills_clips(footage)) {
    const StillsClip clip = read_stills_clip(path, 480, 96);
    const cv::Mat mask = moving_mask(clip.frames);
    for (const int apart : {2, 4, 8, 16}) {
      std::map<std::string, Likeness> mean;
      const int room = static_cast<int>(clip.frames.size()) - apart - 4;
      for (int k = 0; k < samples; ++k) {
        const int first = 4 + room * k / samples;
        const cv::Mat &a = clip.frames[first], &b = clip.frames[first + apart],
                      &truth = clip.frames[first + apart / 2];
        cv::Mat fade;
        cv::addWeighted(a, .5, b, .5, 0, fade);
        const cv::Mat ours = stills::moment_picture(stills::Between(stills::flow_between(a, b)).at(.5), a, b,
                                                    cv::Rect({}, a.size()));
        const std::vector<std::pair<std::string, cv::Mat>> made{
            {"fade", fade},
            {"ours", ours},
            {"dis", plain_warp(a, b)},
            {"minterpolate", minterpolated(a, b, scratch)}};
        for (const auto& [method, picture] : made) {
          if (picture.empty()) continue;
          const Likeness each = likeness(picture, truth, mask);
          mean[method].psnr += each.psnr / samples;
          mean[method].ssim += each.ssim / samples;
        }
      }
      Json row{{"clip", clip.name}, {"apart", apart}};
      fmt::print("{:<26}{:5}", clip.name, apart);
      for (const char* method : {"fade", "ours", "dis", "minterpolate"}) {
        row[method] = {{"psnr", mean[method].psnr}, {"ssim", mean[method].ssim}};
        psnr[apart][method].push_back(mean[method].psnr);
        ssim[apart][method].push_back(mean[method].ssim);
        fmt::print("  {:5.2f} / {:.3f}", mean[method].psnr, mean[method].ssim);
      }
      fmt::print("\n");
      std::fflush(stdout);
      rows.push_back(row);
    }
  }
  for (auto& [apart, methods] : psnr) {
    double worst = 1e9;
    for (std::size_t i = 0; i < methods["fade"].size(); ++i)
      worst = std::min(worst, methods["ours"][i] - methods["fade"][i]);
    fmt::print("mean {:2} apart:", apart);
    for (const char* method : {"fade", "ours", "dis", "minterpolate"}) {
      const auto mean = [](const std::vector<double>& of) {
        return std::accumulate(of.begin(), of.end(), 0.0) / static_cast<double>(of.size());
      };
      fmt::print("  {} {:.2f} / {:.3f}", method, mean(methods[method]), mean(ssim[apart][method]));
    }
    fmt::print("; ours less the cross-fade at worst {:+.2f} dB\n", worst);
  }
  fs::remove_all(scratch);
  return rows;
}

// ---- candles ----

Json run_candles(const fs::path& footage, const std::string& sheet) {
  const StillsClip clip = read_stills_clip(footage / "clips/fire/candle_yellow.mp4", 480, 200);
  const cv::Size one = clip.frames[0].size();
  const int width = one.width / 2 / 16 * 16;
  const cv::Rect cut(one.width / 2 - width / 2, 0, width, one.height);
  SeededRandom random(11);
  std::vector<cv::Mat> made;
  for (int still = 0; still < 14; ++still) {
    cv::Mat picture(2 * one.height, 3 * width, CV_8UC3);
    for (int candle = 0; candle < 6; ++candle)
      clip.frames[random.below(clip.frames.size())](cut).copyTo(
          picture(cv::Rect(candle % 3 * width, candle / 3 * one.height, width, one.height)));
    made.push_back(picture);
  }
  const stills::RegionProposal proposal = stills::propose_regions(made);
  int independent = 0, right = 0;
  for (const stills::Region& region : proposal.regions) {
    if (region.kind != stills::RegionKind::kIndependent) continue;
    ++independent;
    // Right: all of it within one candle's cell.
    int cells = 0;
    for (int candle = 0; candle < 6; ++candle) {
      const cv::Rect cell(candle % 3 * width, candle / 3 * one.height, width, one.height);
      cells += cv::countNonZero(region.mask(cell)) > .02 * cv::countNonZero(region.mask);
    }
    right += cells == 1;
  }
  fmt::print(
      "six candles, 14 stills of {} x {} px: {} independent regions proposed, {} of them within one candle\n",
      made[0].cols, made[0].rows, independent, right);
  if (!sheet.empty())
    media::write_picture(sheet, stills::region_sheet(made[0], proposal.regions, proposal.variation));
  return {{"proposed", independent}, {"within_one", right}};
}

// ---- motion ----

Film film_of(const std::vector<cv::Mat>& frames, double fps, const Region& region) {
  std::vector<cv::Mat> luma(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) cv::cvtColor(frames[i], luma[i], cv::COLOR_BGR2GRAY);
  return measure(luma, pair_motions(luma), fps, region);
}

std::vector<cv::Mat> animated(const std::vector<cv::Mat>& drawn, const stills::PlanOptions& plan_options,
                              int frames, double fps, bool regions, bool flow) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < drawn.size(); ++i) names.push_back(std::to_string(i));
  std::vector<stills::Region> parts{
      {.name = "1", .mask = cv::Mat(drawn[0].size(), CV_8U, cv::Scalar(255)), .parent = {}}};
  if (regions) parts = stills::propose_regions(drawn).regions;
  const stills::Plan plan = stills::make_plan(drawn, names, parts, plan_options);
  std::vector<cv::Mat> out;
  stills::render_frames(plan, drawn, {.fps = fps, .frames = frames, .flow_side = 480, .flow = flow},
                        [&](const cv::Mat& frame) { out.push_back(frame.clone()); });
  return out;
}

/// only   a clip's name; empty: all of them. Throws   Error{kUsage} when none has the name.
std::vector<fs::path> motion_clips(const fs::path& footage, const std::string& only) {
  std::vector<fs::path> clips = stills_clips(footage);
  for (const char* lake : {"clips/water/lake_reflection_calm.mp4", "wind/lakes/mountain_lake_ripples.mp4"})
    clips.push_back(footage / lake);
  if (only.empty()) return clips;
  std::string names;
  for (const fs::path& path : clips) {
    if (path.stem() == only) return {path};
    names += (names.empty() ? "" : ", ") + path.stem().string();
  }
  throw Error(ErrorKind::kUsage, "--clip " + only, "motion has no such clip", "Give one of " + names);
}

Json run_motion(const std::vector<fs::path>& clips) {
  Json rows = Json::array();
  fmt::print(
      "animation from 15 frames of a clip's first half against that half; ceiling: the other half\n"
      "{:<26}{:<22}  spectrum dB  speed log2  texture  patches  flicker log2\n",
      "clip", "method");
  for (const fs::path& path : clips) {
    const StillsClip clip = read_stills_clip(path, 320, 192);
    const auto half = static_cast<int>(clip.frames.size() / 2);
    const std::vector<cv::Mat> first(clip.frames.begin(), clip.frames.begin() + half);
    const std::vector<cv::Mat> second(clip.frames.begin() + half, clip.frames.begin() + 2 * half);
    const Region region{.matte = moving_mask(clip.frames), .border = {}};
    std::vector<cv::Mat> drawn;
    for (int i = 0; i < 15; ++i) drawn.push_back(first[static_cast<std::size_t>(i) * (half - 1) / 14]);
    stills::PlanOptions plan{.seconds = half / clip.fps};
    // The stills' own spacing: the animation then goes as fast as the clip where the order is the clip's.
    plan.timing.step_s = plan.seconds / 14;
    stills::PlanOptions first_order = plan, plain = plan, printed = plan, split = plan;
    first_order.sampling.order = 1;
    plain.graph.floyd = false;
    printed.sampling.by_sum = true;
    split.split = 5;
    std::vector<std::pair<std::string, std::vector<cv::Mat>>> made{
        {"other half (ceiling)", second},
        {"ours", animated(drawn, plan, half, clip.fps, true, true)},
        {"one region", animated(drawn, plan, half, clip.fps, false, true)},
        {"split in five", animated(drawn, split, half, clip.fps, false, true)},
        {"first order", animated(drawn, first_order, half, clip.fps, true, true)},
        {"without Floyd", animated(drawn, plain, half, clip.fps, true, true)},
        {"Eq. 2 by sum", animated(drawn, printed, half, clip.fps, true, true)},
        {"cross-fades alone", animated(drawn, plan, half, clip.fps, true, false)}};
    const Film truth = film_of(first, clip.fps, region);
    // Stills too far apart in time hide how fast the scene goes; a person sees that, and says --speed.
    stills::PlanOptions paced = plan;
    paced.timing.speed = std::exp2(-compare(film_of(made[1].second, clip.fps, region), truth, region).pace);
    made.emplace_back(fmt::format("ours, {:.2f} x as fast", paced.timing.speed),
                      animated(drawn, paced, half, clip.fps, true, true));
    for (const auto& [method, frames] : made) {
      const Film film = film_of(frames, clip.fps, region);
      const Distance far = compare(film, truth, region);
      const std::array<double, kPatchLevels> patches = patch_distances(film.patches, truth.patches);
      const double patch = std::accumulate(patches.begin(), patches.end(), 0.0) / kPatchLevels;
      fmt::print("{:<26}{:<22}  {:11.2f}  {:+10.2f}  {:7.3f}  {:7.2f}  {:+7.2f}\n", clip.name, method,
                 far.spectrum_db, far.pace, far.texture, patch, far.flicker);
      std::fflush(stdout);
      rows.push_back({{"clip", clip.name},
                      {"method", method},
                      {"spectrum_db", far.spectrum_db},
                      {"pace", far.pace},
                      {"texture", far.texture},
                      {"patches", patch},
                      {"flicker", far.flicker}});
    }
  }
  return rows;
}

/// What is known must come out before anything is measured.
void check() {
  std::vector<cv::Mat> frames;
  for (int i = 0; i < 12; ++i) {
    frames.push_back(cv::Mat(96, 160, CV_8UC3, cv::Scalar::all(40)));
    cv::circle(frames.back(), {24 + 10 * i, 48}, 20, cv::Scalar::all(220), cv::FILLED, cv::LINE_AA);
  }
  const Order order = judge(stills::extremal_paths(stills::make_graph(stills::still_distances(frames, {}))));
  const cv::Mat same =
      stills::moment_picture(stills::Between(stills::flow_between(frames[0], frames[0])).at(.5), frames[0],
                             frames[0], cv::Rect({}, frames[0].size()));
  cv::Mat truth;
  frames[0].convertTo(truth, CV_32F);
  if (order.tau != 1 || order.neighbours != 1 || cv::norm(same, truth, cv::NORM_INF) > .01) {
    fmt::print(stderr, "bench_stills: the check failed: tau {}, neighbours {}\n", order.tau,
               order.neighbours);
    std::exit(1);
  }
}

}  // namespace
}  // namespace freshet::bench

int main(int argc, char** argv) try {
  using namespace freshet::bench;
  cv::setNumThreads(1);
  CLI::App app("Order, frames between, regions and motion of freshet synth stills.", "bench_stills");
  std::string what, footage, out, sheet, only;
  int samples = 4;
  app.add_option("WHAT", what, "order, between, candles or motion")
      ->required()
      ->check(CLI::IsMember({"order", "between", "candles", "motion"}));
  app.add_option("FOOTAGE", footage, "The folder that holds clips/")->required();
  app.add_option("--samples", samples, "Pairs of frames a clip and distance")->capture_default_str();
  app.add_option("--sheet", sheet, "Write the candles' proposal (PNG)");
  app.add_option("--clip", only, "Motion of this clip alone, by its file's name without ending");
  app.add_option("--json", out, "Write the figures");
  CLI11_PARSE(app, argc, argv);
  if (!only.empty() && what != "motion")
    throw freshet::Error(freshet::ErrorKind::kUsage, "--clip " + only, "only motion takes it, not " + what);
  const std::vector<std::filesystem::path> clips = motion_clips(footage, only);
  const Machine machine = this_machine();
  fmt::print("{}\n", to_string(machine));
  check();
  const nlohmann::json rows = what == "order"     ? run_order(footage)
                              : what == "between" ? run_between(footage, samples)
                              : what == "candles" ? run_candles(footage, sheet)
                                                  : run_motion(clips);
  if (!out.empty())
    freshet::write_whole_file(out,
                              nlohmann::json{{"machine", to_json(machine)}, {"rows", rows}}.dump(1) + "\n");
} catch (const std::exception& fault) {
  fmt::print(stderr, "bench_stills: {}\n", fault.what());
  return 1;
}
