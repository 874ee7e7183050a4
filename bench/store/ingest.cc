// How many frames per second does ingest take in, stage by stage, and how long would the paper's 151 clips of
// 100 frames at 640 x 480 take?
//
//   bench_ingest CLIP.. [--frames N] [--flow dis|tv-l1]... [--native] [--threads N] [--json FILE]
//
// The first N frames (100) of each clip are scaled to 640 x 480 by the ffmpeg program, without further loss,
// and ingested into a new store, whatever screening says; with --native the clips go in as they are. All
// frames of each store are read back once, with their hashes. CPU time is that of all threads: on a machine
// with other work it says more than the clock, and "busy" is what part of the threads' time it is.

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <stdlib.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <string_view>
#include <vector>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "freshet/error.h"
#include "ingest/ingest.h"
#include "store/store.h"
#include "vision/settings.h"

namespace {

using namespace freshet;
namespace fs = std::filesystem;

constexpr int kWidth = 640, kHeight = 480;
constexpr double kPaperFrames = 151 * 100;

struct Arguments {
  std::vector<fs::path> clips;
  std::vector<std::string> flows;
  int frames = 100;
  bool native = false;
  std::size_t threads = 0;
  std::string json_file;
};

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// The clip's first frames at 640 x 480, 4:2:0, lossless, in a folder of its class.
fs::path scaled(const fs::path& clip, const fs::path& folder, int max_frames) {
  const fs::path to = folder / clip.parent_path().filename() / (clip.stem().string() + ".mkv");
  fs::create_directories(to.parent_path());
  const std::string command = fmt::format(
      "ffmpeg -v error -nostdin -y -noautorotate -i {} -frames:v {} -an -vf scale={}:{} -pix_fmt yuv420p "
      "-c:v ffv1 "
      "-level 3 -slices 4 {}",
      quoted(clip.string()), max_frames, kWidth, kHeight, quoted(to.string()));
  if (std::system(command.c_str()) != 0) throw Error(ErrorKind::kInput, command, "failed");
  return to;
}

/// Reads all frames back, so that a store that cannot be read is not timed.
void check(const store::Snapshot& snapshot) {
  std::vector<std::byte> samples;
  for (const store::ClipId id : snapshot.clips()) {
    const store::StreamShape& shape = snapshot.clip(id).frames;
    for (std::uint32_t p = 0; p < shape.planes.size(); ++p) {
      const store::PlaneShape& plane = shape.planes[p];
      samples.resize(std::size_t{plane.width} * plane.height * plane.bytes_per_sample);
      for (std::uint32_t f = 0; f < shape.frames; f += 16) {
        snapshot.read(id, store::Stream::kFrames, p, {0, 0, plane.width, plane.height}, f, 1, samples);
      }
    }
  }
}

struct Stage {
  const char* name;
  double ingest::IngestSeconds::*seconds;
};
constexpr Stage kStages[] = {
    {"flow", &ingest::IngestSeconds::flow},       {"store", &ingest::IngestSeconds::store},
    {"texture", &ingest::IngestSeconds::texture}, {"life", &ingest::IngestSeconds::life},
    {"motion", &ingest::IngestSeconds::motion},   {"patches", &ingest::IngestSeconds::patches},
    {"commit", &ingest::IngestSeconds::commit},   {"hash", &ingest::IngestSeconds::hash},
    {"decode", &ingest::IngestSeconds::decode},   {"screen", &ingest::IngestSeconds::screen}};

nlohmann::json measure(const std::vector<fs::path>& clips, const std::string& flow, const fs::path& file,
                       std::size_t threads) {
  vision::Settings settings;
  settings.flow.method = vision::parse_flow_method(flow);
  store::Store store = store::Store::create(file, vision::to_json(settings));
  const double wall_start = bench::wall_seconds(), cpu_start = bench::process_seconds();
  const ingest::IngestReport report = ingest::ingest(store, settings, clips, {.force = true});
  const double wall = bench::wall_seconds() - wall_start, cpu = bench::process_seconds() - cpu_start;
  if (report.stopped) throw Error(*report.stopped);
  check(store.snapshot());

  double frames = 0, patches = 0;
  ingest::IngestSeconds sum;
  nlohmann::json rows = nlohmann::json::array();
  for (const ingest::ClipReport& clip : report.clips) {
    if (clip.outcome != ingest::Outcome::kAdded) {
      fmt::print("{} {}\n", clip.name, ingest::to_string(clip.outcome));
      continue;
    }
    frames += clip.frames;
    patches += static_cast<double>(clip.patches);
    nlohmann::json stages;
    for (const Stage& stage : kStages) {
      sum.*stage.seconds += clip.seconds.*stage.seconds;
      stages[stage.name] = clip.seconds.*stage.seconds;
    }
    rows.push_back({{"clip", clip.name},
                    {"frames", clip.frames},
                    {"size", fmt::format("{}x{}", clip.width, clip.height)},
                    {"stored_bytes", clip.stored_bytes},
                    {"total_seconds", clip.seconds.total},
                    {"seconds", stages}});
  }
  const auto bytes = static_cast<double>(fs::file_size(file));
  fmt::print(
      "\n{}: {} clips, {} frames, {} patches; {:.1f} s by the clock, {:.1f} s of CPU, busy {:.2f} of {}\n",
      flow, rows.size(), frames, patches, wall, cpu, cpu / (wall * static_cast<double>(threads)), threads);
  fmt::print("  {:.1f} frames/s, {:.1f} frames per second of CPU, {:.0f} bytes per frame\n", frames / wall,
             frames / cpu, bytes / frames);
  nlohmann::json stages;
  for (const Stage& stage : kStages) {
    const double seconds = sum.*stage.seconds;
    const bool beside = std::string_view(stage.name) == "decode" || std::string_view(stage.name) == "screen";
    fmt::print("  {:<8} {:>7.2f} ms per frame {:>5.1f} %{}\n", stage.name, 1e3 * seconds / frames,
               100 * seconds / wall, beside ? "  beside the others" : "");
    stages[stage.name] = {{"ms_a_frame", 1e3 * seconds / frames}, {"share", seconds / wall}};
  }
  return {{"flow", flow},       {"frames", frames}, {"patches", patches}, {"wall_seconds", wall},
          {"cpu_seconds", cpu}, {"bytes", bytes},   {"stages", stages},   {"clips", rows}};
}

}  // namespace

int main(int argc, char** argv) try {
  Arguments arguments;
  bench::Arguments app("How many frames per second does ingest take in, stage by stage?");
  app.option("CLIP", arguments.clips).required();
  app.option("--frames", arguments.frames, "The first frames of each clip");
  app.option("--flow", arguments.flows, "dis or tv-l1; may be repeated [both]").one_each();
  app.flag("--native", arguments.native, "The clips as they are, not at 640 x 480");
  app.option("--threads", arguments.threads, "[all]");
  app.option("--json", arguments.json_file, "Write the figures here");
  app.parse(argc, argv);
  if (arguments.flows.empty()) arguments.flows = {"dis", "tv-l1"};
  cv::setNumThreads(1);  // as the program does
  const bench::Machine machine = bench::this_machine();
  const std::size_t threads =
      arguments.threads > 0 ? arguments.threads : static_cast<std::size_t>(machine.threads);
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
  std::string name = (fs::temp_directory_path() / "ingest_XXXXXX").string();
  const fs::path folder = mkdtemp(name.data());
  if (!arguments.native) {
    for (fs::path& clip : arguments.clips) clip = scaled(fs::absolute(clip), folder, arguments.frames);
  }
  fmt::print("{}\n", to_string(machine));
  nlohmann::json runs = nlohmann::json::array();
  for (const std::string& flow : arguments.flows) {
    nlohmann::json run = measure(arguments.clips, flow, folder / (flow + ".freshet"), threads);
    if (!arguments.native) {
      const double times = kPaperFrames / run["frames"].get<double>();
      const double wall = times * run["wall_seconds"].get<double>(),
                   cpu = times * run["cpu_seconds"].get<double>();
      fmt::print("  151 clips of 100 frames: {:.1f} min by the clock, {:.1f} min of CPU, {:.2f} GB\n",
                 wall / 60, cpu / 60, 1e-9 * times * run["bytes"].get<double>());
      run["paper"] = {
          {"wall_seconds", wall}, {"cpu_seconds", cpu}, {"bytes", times * run["bytes"].get<double>()}};
    }
    runs.push_back(run);
    std::fflush(stdout);
  }
  if (!arguments.json_file.empty())
    std::ofstream(arguments.json_file) << nlohmann::json{{"bench", "ingest"},
                                                         {"machine", to_json(machine)},
                                                         {"threads", threads},
                                                         {"runs", runs}}
                                              .dump(1)
                                       << '\n';
  fs::remove_all(folder);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
