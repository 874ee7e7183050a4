// bench/animation/rendering.cc — how fast is a labelled picture animated, stage by stage, and how long does it all
// take?
//
//   bench_rendering STORE CLASS:PICTURE[:MATTE].. [--sizes 640x480,1920x1080] [--frames 96] [--runs 3]
//                   [--json FILE]
//
// Each picture's middle, of a size's shape, is brought to that size, and labelled and rendered with the
// defaults (appearance matching, what is carried, MP4). Seconds by stage and frames per second are wall clock
// on all cores, medians of the runs:
// - rendered: frames made and dropped; with a file: made and written. The rest is what the encoder costs.
// - encoder: the same frames, kept, written by the encoder with both cores to itself. No renderer that writes
//   this file can be faster.
// - CPU a frame: of the process, user and system, while frames are rendered, and rendered and written.
// - end to end: from an unopened store to the finished file; cold: with the store dropped from the system's
//   cache before (as far as no other process maps it).

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "bench/harness/median.h"
#include "bench/harness/page_cache.h"
#include "bench/harness/picture_argument.h"
#include "freshet/error.h"
#include "media/video/video_writer.h"
#include "platform/allocation.h"
#include "query/labelling/labelling.h"
#include "query/search/picture_scale.h"
#include "stored/store_settings.h"
#include "synth/animate/animate.h"
#include "synth/animate/placement/assigned.h"

namespace {

using namespace freshet;
using nlohmann::json;
namespace fs = std::filesystem;

struct Command {
  std::string store, json_path;
  std::vector<std::string> pictures, sizes{"640x480", "1920x1080"};
  int frames = 96, runs = 3;
};

class Rendering {
 public:
  Rendering(const Command& command, const std::string& argument, cv::Size size)
      : command_(command), file_(fs::temp_directory_path() / "freshet_bench_rendering.mp4") {
    const std::size_t colon = argument.find(':');
    if (colon == std::string::npos)
      throw Error(ErrorKind::kUsage, argument, "expected CLASS:PICTURE[:MATTE]");
    target_ = bench::brought_to(bench::read_picture_argument(argument.substr(colon + 1)), size);
    options_.candidates.class_name = argument.substr(0, colon);
    options_.candidates.min_duration_s = command.frames / 25.0;
    options_.piece_scale = query::auto_piece_scale(size);
    animate_.frames = command.frames;
  }
  Rendering(const Rendering&) = delete;
  Rendering& operator=(const Rendering&) = delete;
  ~Rendering() { fs::remove(file_); }

  json measure() {
    json result{{"picture", target_.name},
                {"class", options_.candidates.class_name},
                {"size", fmt::format("{}x{}", target_.picture.cols, target_.picture.rows)},
                {"frames", command_.frames}};
    std::vector<double> rendered, written, encoded, whole, cold, rendered_cpu, written_cpu;
    std::map<std::string, std::vector<double>> stages;
    for (int run = 0; run < command_.runs; ++run) {
      bench::drop_from_cache(command_.store);
      cold.push_back(end_to_end(result));
      whole.push_back(end_to_end(result));

      const store::Snapshot snapshot = store::Store::open_read(command_.store).snapshot();
      const query::SearchBase base = query::open_search(snapshot);
      const synth::animate::Placement placement = placed(snapshot, base);
      std::vector<cv::Mat> kept;
      double cpu = bench::process_seconds();
      const synth::animate::AnimateReport alone =
          render(snapshot, placement, [&](const cv::Mat& frame) { kept.push_back(frame); });
      rendered_cpu.push_back(bench::process_seconds() - cpu);
      rendered.push_back(alone.total_s);
      for (const auto& [stage, seconds] : {std::pair{"decode", alone.decode_s},
                                           {"blend", alone.blend_s},
                                           {"base", alone.base_s},
                                           {"match", alone.appearance_s},
                                           {"render", alone.render_s}})
        stages[stage].push_back(seconds);
      result["pieces"] = alone.pieces;
      result["clips"] = alone.clips;
      result["batches"] = alone.batches;

      const double begin = bench::wall_seconds();
      {
        media::VideoWriter writer(file_, target_.picture.size());
        for (const cv::Mat& frame : kept) writer.write(frame);
        writer.finish();
      }
      encoded.push_back(bench::wall_seconds() - begin);
      kept.clear();
      cpu = bench::process_seconds();
      written.push_back(animated(snapshot, placement));
      written_cpu.push_back(bench::process_seconds() - cpu);
    }
    for (const auto& [stage, seconds] : stages) result["seconds"][stage] = bench::median(seconds);
    result["fps"] = {{"rendered", command_.frames / bench::median(rendered)},
                     {"written", command_.frames / bench::median(written)},
                     {"encoder", command_.frames / bench::median(encoded)}};
    result["cpu_s_a_frame"] = {{"rendered", bench::median(rendered_cpu) / command_.frames},
                               {"written", bench::median(written_cpu) / command_.frames}};
    result["end_to_end_s"] = bench::median(whole);
    result["cold_s"] = bench::median(cold);
    result["peak_bytes"] = bench::peak_bytes();
    return result;
  }

 private:
  synth::animate::Placement placed(const store::Snapshot& snapshot, const query::SearchBase& base) const {
    return synth::animate::placement_from(
        query::label(snapshot, base, target_.picture, target_.matte, options_).assignment, snapshot);
  }

  synth::animate::AnimateReport render(const store::Snapshot& snapshot,
                                       const synth::animate::Placement& placement,
                                       const std::function<void(const cv::Mat&)>& sink) const {
    return synth::animate::animate(snapshot, stored::settings_of(snapshot), target_.picture, target_.matte,
                                   placement, animate_, sink);
  }

  /// Seconds to the finished file.
  double animated(const store::Snapshot& snapshot, const synth::animate::Placement& placement) const {
    const double begin = bench::wall_seconds();
    media::VideoWriter writer(file_, target_.picture.size());
    render(snapshot, placement, [&](const cv::Mat& frame) { writer.write(frame); });
    writer.finish();
    return bench::wall_seconds() - begin;
  }

  double end_to_end(json& result) const {
    const double begin = bench::wall_seconds();
    const store::Snapshot snapshot = store::Store::open_read(command_.store).snapshot();
    const query::SearchBase base = query::open_search(snapshot);
    const synth::animate::Placement placement = placed(snapshot, base);
    result["labelled_s"] = bench::wall_seconds() - begin;
    animated(snapshot, placement);
    return bench::wall_seconds() - begin;
  }

  const Command& command_;
  fs::path file_;
  bench::PictureArgument target_;
  query::LabelOptions options_;
  synth::animate::AnimateOptions animate_;
};

int run(int argc, char** argv) {
  bench::Arguments app("Frames per second of the renderer, by stage");
  Command command;
  app.option("STORE", command.store, "The store").required();
  app.option("PICTURE", command.pictures, "CLASS:PICTURE[:MATTE]").required();
  app.option("--sizes", command.sizes, "Sizes, px").split_at(',');
  app.option("--frames", command.frames, "Frames of each animation");
  app.option("--runs", command.runs, "Runs, of which the medians are printed").between(1, 100);
  app.option("--json", command.json_path, "Write the figures here");
  app.parse(argc, argv);

  const bench::Machine machine = bench::this_machine();
  fmt::print("{}\n\n", bench::to_string(machine));
  fmt::print(
      "| picture | size | pieces | decode | blend | base | match | render | frames/s | with a file | encoder "
      "| CPU s a frame | and written | "
      "end to end s | cold s | peak MB |\n| --- | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: "
      "| --: | --: | "
      "--: | --: | --: |\n");
  json all{{"machine", bench::to_json(machine)}, {"runs", command.runs}, {"rows", json::array()}};
  for (const std::string& picture : command.pictures)
    for (const std::string& size : command.sizes) {
      const json row = Rendering(command, picture, bench::parse_size(size)).measure();
      const auto at = [&](const char* group, const char* name) { return row[group][name].get<double>(); };
      fmt::print(
          "| {} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | **{:.1f}** | {:.1f} | {:.1f} | "
          "{:.3f} | {:.3f} | {:.1f} | {:.1f} | {:.0f} |\n",
          row["picture"].get<std::string>(), size, row["pieces"].get<int>(), at("seconds", "decode"),
          at("seconds", "blend"), at("seconds", "base"), at("seconds", "match"), at("seconds", "render"),
          at("fps", "rendered"), at("fps", "written"), at("fps", "encoder"), at("cpu_s_a_frame", "rendered"),
          at("cpu_s_a_frame", "written"), row["end_to_end_s"].get<double>(), row["cold_s"].get<double>(),
          row["peak_bytes"].get<double>() / 1e6);
      std::fflush(stdout);
      all["rows"].push_back(row);
    }
  if (!command.json_path.empty()) std::ofstream(command.json_path) << all.dump(2) << '\n';
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();  // as freshet does
  cv::setNumThreads(1);
  try {
    return run(argc, argv);
  } catch (const freshet::Error& fault) {
    fmt::print(stderr, "{}\n", fault.what());
    return 1;
  }
}
