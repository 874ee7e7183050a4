// freshet synth stills: a moving scene from a handful of stills.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/video/picture_sink.h"
#include "platform/stopwatch.h"
#include "synth/stills/plan.h"
#include "synth/stills/rendering.h"
#include "synth/stills/still_set.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
namespace stills = synth::stills;

struct StillsCommand {
  fs::path folder, out;
  double seconds = 8, fps = 25;
  stills::PlanOptions plan;
  stills::RenderOptions render;
  bool json = false;
};

using Json = nlohmann::json;

Json names_of(const std::vector<int>& stills, const std::vector<std::string>& names) {
  Json list = Json::array();
  for (const int still : stills) list.push_back(names[still]);
  return list;
}

/// Of a path and its reverse the one that comes first.
std::vector<stills::Path> one_way(const std::vector<stills::Path>& paths) {
  std::vector<stills::Path> kept;
  for (const stills::Path& path : paths)
    if (std::find(kept.begin(), kept.end(), stills::reversed(path)) == kept.end()) kept.push_back(path);
  return kept;
}

Json report_of(const stills::Plan& plan, const std::vector<std::string>& names) {
  Json report{{"paths", Json::array()}, {"sequence", Json::array()}, {"regions", Json::array()}};
  for (const stills::PlannedRegion& region : plan.regions) {
    Json paths = Json::array();
    for (const stills::Path& path : one_way(region.paths)) paths.push_back(names_of(path, names));
    const Json sequence = names_of(region.sequence, names);
    if (report["sequence"].empty()) report["sequence"] = sequence;
    if (region.region.kind == stills::RegionKind::kIndependent)
      report["paths"].insert(report["paths"].end(), paths.begin(), paths.end());
    report["regions"].push_back({{"name", region.region.name},
                                 {"kind", stills::to_string(region.region.kind)},
                                 {"paths", paths},
                                 {"sequence", sequence}});
  }
  return report;
}

void run_stills(StillsCommand command, RunContext& context) {
  const Stopwatch total;
  Stopwatch watch;
  Progress progress;
  const Job job{.progress = progress.callback(), .stop = context.stop};
  command.render.fps = command.fps;
  command.render.frames = std::max(1, static_cast<int>(std::lround(command.seconds * command.fps)));
  command.plan.seconds = command.render.frames / command.fps;
  check_frames_output(command.out, command.render.frames);
  const stills::StillSet set = stills::read_stills(command.folder, job);
  media::PictureSink::check(command.out, set.size(), command.render.frames, command.fps);
  const double read_s = watch.lap();
  const std::vector<cv::Mat> small = stills::reduced(set.pictures, 800);
  std::vector<stills::Region> regions{
      {.name = "all", .mask = cv::Mat(small[0].size(), CV_8U, cv::Scalar(255)), .parent = {}}};
  const stills::Plan plan = stills::make_plan(small, regions, command.plan, job);
  const double plan_s = watch.lap();
  progress.finish();
  for (const std::string& notice : set.notices) say(notice);
  for (const std::string& notice : plan.notices) say(notice);
  media::PictureSink sink(command.out, set.size(), command.render.frames, command.fps);
  stills::render_frames(
      plan, set.pictures, command.render, [&](const cv::Mat& frame) { sink.write(frame); }, job);
  sink.finish();
  progress.finish();
  say(fmt::format("{} stills, {} frames: read {:.1f} s, orders {:.1f} s, frames {:.1f} s", set.count(),
                  command.render.frames, read_s, plan_s, watch.lap()));
  if (command.json)
    fmt::print("{}\n", report_of(plan, set.names).dump());
  else
    fmt::print("{}\n", command.out.string());
}

}  // namespace

void add_stills(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<StillsCommand>();
  CLI::App* sub = synth_command.add_subcommand("stills", "Make a moving scene from some stills of it");
  sub->add_option("FOLDER", command->folder,
                  "Ten to twenty stills of a scene (PNG, JPEG, TIFF), in any order")
      ->required();
  sub->add_option(
         "-o,--output", command->out,
         "The animation: .mp4, .mkv (lossless), .mov, .webp, .apng, or a sequence such as out/%05d.png")
      ->required();
  sub->add_option("--seconds", command->seconds, "Length, s")
      ->check(CLI::Range(0.04, 3600.0))
      ->capture_default_str();
  sub->add_option("--fps", command->fps, "Frames per second")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str();
  sub->add_flag("--loop", command->plan.loop, "The end goes over into the beginning");
  sub->add_option("--step", command->plan.timing.step_s, "Mean time from still to still, s")
      ->check(CLI::Range(0.04, 60.0))
      ->capture_default_str();
  sub->add_option("--seed", command->plan.sampling.seed, "Another seed, another sequence")
      ->capture_default_str();
  sub->add_flag("--json", command->json, "Print paths, sequence and regions as JSON");
  add_overwrite(*sub);
  add_threads(*sub);
  sub->callback([command, &context] { run_stills(*command, context); });
}

}  // namespace freshet::tools
