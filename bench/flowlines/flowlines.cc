// Is a short clip made endless along its flow lines without a seam, without repeating itself and without losing
// texture; do edited lines lead the fluid where they are drawn; and what does it cost?
//
//   bench_flowlines CLIP.. [--seconds 2] [--output-seconds 20] [--width 320] [--json FILE]
//   bench_flowlines $FRESHET_FOOTAGE/clips/water/{waterfall_dusk_pool,brook_mossy_rocks}.mp4 ...
//
// The first seconds of each clip are made 20 s long: by flow lines (cut; mixed with contrast kept; and feathered as
// printed), by a loop with a cross-fade, by video textures (Schoedl et al. 2000), by dynamic textures (Doretto et al.
// 2003). Columns:
//   jump max, mean   how much more a 16 px block changes from frame to frame than in 19 of 20 frames of the clip, mean
//                    over blocks that move: the worst frame, and all of them. 0 is none.
//   dip max, mean    the other way: how much less fine texture (mean |Laplacian|) than in 19 of 20 frames of the clip.
//                    A cross-fade has no jumps; all of the picture goes soft at once.
//   both max, mean   of jumps and dips together, frame by frame. The clip itself has some of all, in one frame of 20:
//                    the first row.
//   repeats          correlation of frames (less their mean) a lag apart: of all lags from a third of a second to three
//                    seconds the most alike. 1: it is a loop. The clip's own further frames have what its kind has.
//   kept             fine texture (mean |Laplacian|) over the film by that of the clip's own two seconds, in blocks
//                    that move: 1 is nothing lost. A loop shows the same two seconds again and again, and so keeps all
//                    but what its cross-fade costs.
//   CPU s, ms        to prepare, and a frame
//   then bench/quality's measures against the clip's further frames, as many again of those being the ceiling.
// Edits: all lines bent together by up to 35 degrees, where patches cover all (bench/flowlines/followed.h). Lines that
// are not bent say how much of that is the measure's own error.
//
//   bench_flowlines CLIP.. --brief                   without video textures, other mixes and edits
//   bench_flowlines CLIP.. --cost [--width 1280]     what preparing and a frame cost, and nothing else

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/flowlines/dynamic_texture.h"
#include "bench/flowlines/followed.h"
#include "bench/flowlines/video_texture.h"
#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "bench/quality/quality_footage.h"
#include "bench/quality/quality_measures.h"
#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "synth/flowlines/flowlines.h"

namespace {

using namespace freshet;
namespace fs = std::filesystem;
namespace flowlines = synth::flowlines;

constexpr int kBlock = 16, kBentFrames = 60;

/// Changes from frame to frame by block: a row a pair.
cv::Mat changes(const std::vector<cv::Mat>& luma) {
  const cv::Size blocks(luma.front().cols / kBlock, luma.front().rows / kBlock);
  cv::Mat out(static_cast<int>(luma.size()) - 1, blocks.area(), CV_32F), difference, reduced;
  for (int t = 0; t < out.rows; ++t) {
    cv::absdiff(luma[static_cast<std::size_t>(t)], luma[static_cast<std::size_t>(t) + 1], difference);
    difference.convertTo(difference, CV_32F);
    cv::resize(difference, reduced, blocks, 0, 0, cv::INTER_AREA);
    reduced.reshape(1, 1).copyTo(out.row(t));
  }
  return out;
}

/// Fine texture by block: a row a frame.
cv::Mat textures(const std::vector<cv::Mat>& luma) {
  const cv::Size blocks(luma.front().cols / kBlock, luma.front().rows / kBlock);
  cv::Mat out(static_cast<int>(luma.size()), blocks.area(), CV_32F), detail, reduced;
  for (int t = 0; t < out.rows; ++t) {
    cv::Laplacian(luma[static_cast<std::size_t>(t)], detail, CV_32F);
    cv::resize(cv::abs(detail), reduced, blocks, 0, 0, cv::INTER_AREA);
    reduced.reshape(1, 1).copyTo(out.row(t));
  }
  return out;
}

/// By block, the value that `share` of the clip's frames stay below.
std::vector<float> quantiles(const cv::Mat& clip, double share) {
  std::vector<float> out;
  for (int b = 0; b < clip.cols; ++b) {
    std::vector<float> column;
    for (int t = 0; t < clip.rows; ++t) column.push_back(clip.at<float>(t, b));
    std::sort(column.begin(), column.end());
    out.push_back(column[static_cast<std::size_t>(share * clip.rows)]);
  }
  return out;
}

/// By frame, how far a film's blocks go beyond their usual value, relative to it: above when `sign` is 1, below when
/// -1; mean over blocks that move.
std::vector<double> departures(const cv::Mat& film, const std::vector<float>& usual, int sign,
                               const std::vector<bool>& moves) {
  std::vector<double> out;
  for (int t = 0; t < film.rows; ++t) {
    double sum = 0;
    int moving = 0;
    for (int b = 0; b < film.cols; ++b) {
      const auto at = static_cast<std::size_t>(b);
      if (!moves[at] || usual[at] <= 0) continue;
      sum += std::max(0.0, sign * (static_cast<double>(film.at<float>(t, b) / usual[at]) - 1));
      ++moving;
    }
    out.push_back(sum / std::max(1, moving));
  }
  return out;
}

/// Mean over all frames and the blocks that move.
double mean_over(const cv::Mat& film, const std::vector<bool>& moves) {
  double sum = 0;
  int count = 0;
  for (int b = 0; b < film.cols; ++b)
    if (moves[static_cast<std::size_t>(b)]) {
      sum += cv::mean(film.col(b))[0];
      ++count;
    }
  return sum / std::max(1, count);
}

struct Departure {
  double worst = 0, mean = 0;
};

Departure departure(const std::vector<double>& by_frame) {
  Departure out;
  for (const double one : by_frame) {
    out.worst = std::max(out.worst, one);
    out.mean += one / static_cast<double>(by_frame.size());
  }
  return out;
}

double repetition(const std::vector<cv::Mat>& luma, double fps) {
  std::vector<cv::Mat> small;
  cv::Mat mean;
  for (const cv::Mat& frame : luma) {
    cv::Mat reduced;
    cv::resize(frame, reduced, cv::Size(frame.cols / 4, frame.rows / 4), 0, 0, cv::INTER_AREA);
    reduced.convertTo(reduced, CV_32F);
    small.push_back(reduced);
    mean = mean.empty() ? reduced.clone() : cv::Mat(mean + reduced);
  }
  mean *= 1.0 / static_cast<double>(small.size());
  for (cv::Mat& frame : small) frame -= mean;
  double most = -1;
  const int last = std::min(static_cast<int>(3 * fps), static_cast<int>(small.size()) / 2);
  for (int lag = static_cast<int>(fps / 3); lag <= last; ++lag) {
    double product = 0, squares = 0;
    for (std::size_t t = 0; t + static_cast<std::size_t>(lag) < small.size(); ++t) {
      const cv::Mat &a = small[t], &b = small[t + static_cast<std::size_t>(lag)];
      product += a.dot(b);
      squares += 0.5 * (a.dot(a) + b.dot(b));
    }
    most = std::max(most, product / std::max(1e-9, squares));
  }
  return most;
}

/// CPU seconds, of all threads together: what they are on a machine with others on it.
struct Cost {
  double prepare_s = 0, prepare_cpu_s = 0, frame_s = 0, frame_cpu_s = 0;
};

struct Row {
  std::string name;
  Departure jumps{}, dips{}, both{};
  double repeats = 0, kept = 0;
  bench::Distance distance{};
  Cost cost{};
};

bench::Film film_of(const std::vector<cv::Mat>& frames, double fps, const bench::Region& region) {
  const std::vector<cv::Mat> luma = bench::luma_of(frames);
  return bench::measure(luma, bench::pair_motions(luma), fps, region);
}

/// From the middle, where rungs of every kind have gone by; texture from four parts, for what a film shows in
/// two seconds is a matter of chance.
bench::Distance distance_of(const std::vector<cv::Mat>& frames, const bench::Film& truth,
                            std::size_t truth_frames, double fps, const bench::Region& region) {
  const auto part = [&](std::size_t from) {
    const auto begin = frames.begin() + static_cast<std::ptrdiff_t>(from);
    return film_of({begin, begin + static_cast<std::ptrdiff_t>(truth_frames)}, fps, region);
  };
  bench::Film film = part((frames.size() - truth_frames) / 2);
  const std::size_t parts = std::min<std::size_t>(4, frames.size() / truth_frames);
  film.texture.fill(0);
  for (std::size_t i = 0; i < parts; ++i) {
    const bench::Film one = part(i * (frames.size() / parts));
    for (std::size_t l = 0; l < film.texture.size(); ++l)
      film.texture[l] += one.texture[l] / static_cast<double>(parts);
  }
  return bench::compare(film, truth, region);
}

Row judged(const std::string& name, const std::vector<cv::Mat>& frames, const std::vector<cv::Mat>& clip,
           const bench::Film* truth, std::size_t truth_frames, double fps, const bench::Region& region) {
  Row row{.name = name};
  const std::vector<cv::Mat> luma = bench::luma_of(frames);
  const std::vector<cv::Mat> clip_luma = bench::luma_of(clip);
  const std::vector<float> changed = quantiles(changes(clip_luma), 0.95);
  std::vector<bool> moves;
  for (const float most : changed) moves.push_back(most >= 2);  // grey levels: less is coding noise
  const std::vector<double> jumps = departures(changes(luma), changed, 1, moves);
  const cv::Mat film_texture = textures(luma), clip_texture = textures(clip_luma);
  std::vector<double> dips = departures(film_texture, quantiles(clip_texture, 0.05), -1, moves);
  row.kept = mean_over(film_texture, moves) / std::max(1e-9, mean_over(clip_texture, moves));
  row.jumps = departure(jumps);
  row.dips = departure(dips);
  for (std::size_t t = 0; t < jumps.size(); ++t) dips[t] += jumps[t];
  row.both = departure(dips);
  row.repeats = repetition(luma, fps);
  if (truth != nullptr) {
    row.distance = distance_of(frames, *truth, truth_frames, fps, region);
  }
  return row;
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// make   the engine, whose next() is a frame.
template <typename Make>
std::vector<cv::Mat> endless(const Make& make, int frames, Cost& cost) {
  const Stopwatch watch;
  const double cpu = cpu_seconds();
  auto engine = make();
  cost = {.prepare_s = watch.seconds(), .prepare_cpu_s = cpu_seconds() - cpu};
  std::vector<cv::Mat> out;
  for (int t = 0; t < frames; ++t) {
    const Stopwatch one;
    const double before = cpu_seconds();
    const cv::Mat& frame = engine.next();
    cost.frame_s += one.seconds() / frames;
    cost.frame_cpu_s += (cpu_seconds() - before) / frames;
    out.push_back(frame.clone());
  }
  return out;
}

/// Where an edit covers all, and what flow sees around it.
cv::Mat covered(const flowlines::Flowlines& engine) {
  cv::Mat out;
  cv::erode(engine.fluid() > 0.95, out, cv::Mat::ones(9, 9, CV_8U));
  return out;
}

/// The clip's found lines bent, and how well its fluid goes along them; 0 degrees: how well they are measured.
bench::Followed bent(const flowlines::Footage& footage, double degrees) {
  flowlines::FlowlinesOptions options;
  options.lines = flowlines::Flowlines(footage, options).lines();
  options.edited = degrees > 0 ? bench::bent(options.lines, degrees) : options.lines;
  flowlines::Flowlines engine(footage, options);
  const cv::Mat shown = covered(engine);
  std::vector<cv::Mat> film;
  for (int t = 0; t < kBentFrames; ++t) film.push_back(engine.next().clone());
  return bench::followed(film, footage.frames, options.lines, options.edited, options.view.correspondence,
                         shown);
}

void print(const Row& row) {
  const bench::Distance& d = row.distance;
  fmt::print(
      "  {:<22}{:9.3f}{:8.4f}{:9.3f}{:8.4f}{:9.3f}{:8.4f}{:9.2f}{:7.3f}{:7.2f}{:7.1f} "
      "|{:8.2f}{:9.2f}{:8.1f}{:8.2f}{:8.2f}{:8.3f}",
      row.name, row.jumps.worst, row.jumps.mean, row.dips.worst, row.dips.mean, row.both.worst, row.both.mean,
      row.repeats, row.kept, row.cost.prepare_cpu_s, 1e3 * row.cost.frame_cpu_s, d.texture, d.contrast,
      d.spectrum_db, d.angle_deg, d.pace, d.ssim);
  fmt::print("\n");
  std::fflush(stdout);
}

nlohmann::json json_of(const Row& row) {
  const bench::Distance& d = row.distance;
  return {{"name", row.name},
          {"jump_max", row.jumps.worst},
          {"jump_mean", row.jumps.mean},
          {"dip_max", row.dips.worst},
          {"dip_mean", row.dips.mean},
          {"both_max", row.both.worst},
          {"both_mean", row.both.mean},
          {"repeats", row.repeats},
          {"kept", row.kept},
          {"texture", d.texture},
          {"contrast", d.contrast},
          {"spectrum_db", d.spectrum_db},
          {"angle_deg", d.angle_deg},
          {"pace", d.pace},
          {"ssim", d.ssim},
          {"prepare_cpu_s", row.cost.prepare_cpu_s},
          {"frame_cpu_s", row.cost.frame_cpu_s}};
}

flowlines::Footage beginning(const std::string& path, const std::vector<cv::Mat>& all, double seconds,
                             double fps) {
  const auto count = std::min(all.size(), static_cast<std::size_t>(std::lround(seconds * fps)));
  return {
      .name = path, .frames = {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)}, .fps = fps};
}

nlohmann::json cost_of(const std::string& path, double seconds, int width) {
  double fps = 25;
  const flowlines::Footage footage = beginning(path, bench::read_video(path, width, &fps), seconds, fps);
  constexpr int kFrames = 120;
  Cost cost;
  endless([&] { return flowlines::Flowlines(footage, {}); }, kFrames, cost);
  fmt::print(
      "{} ({} x {}): prepared in {:.1f} s ({:.1f} s of CPU); a frame in {:.1f} ms ({:.1f} ms of CPU)\n",
      fs::path(path).stem().string(), footage.size().width, footage.size().height, cost.prepare_s,
      cost.prepare_cpu_s, 1e3 * cost.frame_s, 1e3 * cost.frame_cpu_s);
  return {{"clip", path},
          {"width", footage.size().width},
          {"height", footage.size().height},
          {"prepare_cpu_s", cost.prepare_cpu_s},
          {"frame_s", cost.frame_s},
          {"frame_cpu_s", cost.frame_cpu_s}};
}

nlohmann::json bends_of(const flowlines::Footage& footage) {
  nlohmann::json out = nlohmann::json::array();
  for (const double degrees : {0.0, 35.0}) {
    const bench::Followed led = bent(footage, degrees);
    fmt::print(
        "  bent by up to {:.0f} degrees: {:.1f} degrees off (the clip from its own lines {:.1f}); log2 of "
        "speed "
        "{:.2f} by flow, {:.2f} by ribbons ({:+.2f}); {} places\n",
        degrees, led.degrees, led.clip_degrees, led.flow_speed, led.ribbon_speed, led.slower, led.places);
    out.push_back({{"bent", degrees},
                   {"degrees", led.degrees},
                   {"clip_degrees", led.clip_degrees},
                   {"flow_speed_log2", led.flow_speed},
                   {"ribbon_speed_log2", led.ribbon_speed},
                   {"slower_log2", led.slower},
                   {"places", led.places}});
  }
  return out;
}

void print_heading(const flowlines::Footage& footage) {
  fmt::print("{} ({} x {}, {} frames of {:.1f} s)\n", fs::path(footage.name).stem().string(),
             footage.size().width, footage.size().height, footage.count(), footage.count() / footage.fps);
  fmt::print("  {:<22}{:>9}{:>8}{:>9}{:>8}{:>9}{:>8}{:>9}{:>7}{:>7}{:>7} |{:>8}{:>9}{:>8}{:>8}{:>8}{:>8}\n",
             "", "jump max", "mean", "dip max", "mean", "both max", "mean", "repeats", "kept", "CPU s", "ms",
             "texture", "contrast", "dB", "angle", "pace", "ssim");
}

struct Asked {
  double seconds = 2, output_seconds = 20;
  int width = 320;
  bool brief = false;  // without video textures, other mixes and edits
};

nlohmann::json run(const std::string& path, const Asked& asked) {
  double fps = 25;
  const std::vector<cv::Mat> all = bench::read_video(path, asked.width, &fps);
  const flowlines::Footage footage = beginning(path, all, asked.seconds, fps);
  const std::size_t count = footage.frames.size();
  const int frames = static_cast<int>(asked.output_seconds * fps);
  const std::size_t further = std::min<std::size_t>(count, (all.size() - count) / 2);
  print_heading(footage);
  nlohmann::json rows = nlohmann::json::array();
  flowlines::FlowlinesOptions options;
  Cost cost;
  const auto lines = [&] { return flowlines::Flowlines(footage, options); };
  const std::vector<cv::Mat> kept = endless(lines, frames, cost);
  const bench::Region region{.matte = flowlines::Flowlines(footage, options).matte(), .border = {0, 0}};
  bench::Film truth;
  const bool judges = further >= 16;  // frames
  const auto part = [&](std::size_t from) {
    return std::vector<cv::Mat>(all.begin() + static_cast<std::ptrdiff_t>(from),
                                all.begin() + static_cast<std::ptrdiff_t>(from + further));
  };
  if (judges) truth = film_of(part(count), fps, region);
  const auto add = [&](const std::string& name, const std::vector<cv::Mat>& film, const Cost& costs) {
    Row row = judged(name, film, footage.frames, judges ? &truth : nullptr, further, fps, region);
    row.cost = costs;
    print(row);
    rows.push_back(json_of(row));
  };
  const auto add_mixed = [&](const std::string& name, flowlines::Mixing mixing) {
    options.mixing = mixing;
    const std::vector<cv::Mat> film = endless(lines, frames, cost);
    add(name, film, cost);
  };
  const auto add_dynamic = [&] {
    std::size_t bytes = 0;
    double modulus = 0;
    const std::vector<cv::Mat> film = endless(
        [&] {
          bench::DynamicTexture texture(footage.frames);
          bytes = texture.bytes(), modulus = texture.found_modulus();
          return texture;
        },
        frames, cost);
    add("dynamic textures", film, cost);
    fmt::print("  (its states are {:.1f} MB; the largest eigenvalue {:.3f})\n",
               static_cast<double>(bytes) / (1 << 20), modulus);
  };
  add("the clip itself", footage.frames, {});
  add("flow lines", kept, cost);
  add("loop with a cross-fade", bench::fading_loop(footage.frames, 8, frames), {});
  add_dynamic();
  if (asked.brief) return {{"clip", path}, {"rows", rows}};
  add("video textures", bench::video_texture(footage.frames, frames), {});
  add_mixed("flow lines, mixed", flowlines::Mixing::kContrast);
  add_mixed("flow lines, as printed", flowlines::Mixing::kFeather);
  if (judges) add("the clip goes on", part(count + further), {});
  return {{"clip", path}, {"rows", rows}, {"edited", bends_of(footage)}};
}

}  // namespace

int main(int argc, char** argv) {
  bench::Arguments app("Endless and edited clips along flow lines, beside a loop and video textures");
  std::vector<std::string> clips;
  Asked asked;
  bool only_cost = false;
  std::string json;
  app.option("CLIP", clips, "Clips from a camera that stands still").required().existing_file();
  app.option("--seconds", asked.seconds, "Of the clip that are made endless");
  app.option("--output-seconds", asked.output_seconds, "That are made");
  app.option("--width", asked.width, "Longer side to which clips are reduced, px");
  app.flag("--brief", asked.brief,
           "Only flow lines as they are by default, the cross-fade and dynamic textures");
  app.flag("--cost", only_cost, "Only what preparing and a frame cost");
  app.option("--json", json, "Also write the figures here");
  app.parse(argc, argv);
  cv::setNumThreads(1);
  fmt::print("{}\n", bench::to_string(bench::this_machine()));
  nlohmann::json report{{"machine", bench::to_json(bench::this_machine())},
                        {"clips", nlohmann::json::array()}};
  for (const std::string& clip : clips) {
    try {
      report["clips"].push_back(only_cost ? cost_of(clip, asked.seconds, asked.width) : run(clip, asked));
    } catch (const freshet::Error& error) {
      fmt::print("  refused: {}\n", error.what());
    }
  }
  fmt::print("peak memory {} MB\n", bench::peak_bytes() >> 20);
  if (!json.empty()) std::ofstream(json) << report.dump(2) << "\n";
  return 0;
}
