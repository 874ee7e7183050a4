// freshet synth stills: a moving scene from a handful of stills.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "media/video/picture_sink.h"
#include "platform/stopwatch.h"
#include "platform/whole_file.h"
#include "synth/stills/film.h"
#include "synth/stills/plan.h"
#include "synth/stills/region_proposal.h"
#include "synth/stills/rendering.h"
#include "synth/stills/still_set.h"
#include "synth/stills/stills_page.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/options/as_printed.h"
#include "tools/options/cache_options.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
namespace stills = synth::stills;
using Json = nlohmann::json;

constexpr double kUnblurred = 0.1;  // px: a Gaussian of one sample

struct StillsCommand {
  fs::path folder, out, sheet, page;
  stills::FilmOptions film;
  std::string distance = "paths", normalise = "mean";
  bool json = false, keys = false, no_slow_turns = false;
  CacheOptions cache;
  AsPrinted as_printed;
};

Json names_of(const std::vector<int>& shown, const std::vector<std::string>& names) {
  Json list = Json::array();
  for (const int still : shown) list.push_back(names[still]);
  return list;
}

Json report_of(const stills::Plan& plan, const std::vector<std::string>& names) {
  Json report{{"paths", Json::array()}, {"sequence", Json::array()}, {"regions", Json::array()}};
  for (const stills::PlannedRegion& region : plan.regions) {
    Json paths = Json::array();
    for (const stills::Path& path : stills::one_way(region.paths)) paths.push_back(names_of(path, names));
    const Json sequence = names_of(region.sequence, names);
    if (report["sequence"].empty()) report["sequence"] = sequence;
    if (region.region.kind == stills::RegionKind::kIndependent)
      report["paths"].insert(report["paths"].end(), paths.begin(), paths.end());
    const cv::Rect box = cv::boundingRect(region.region.mask);
    const double area =
        cv::countNonZero(region.region.mask) / static_cast<double>(region.region.mask.total());
    const auto across = static_cast<double>(region.region.mask.cols),
               down = static_cast<double>(region.region.mask.rows);
    report["regions"].push_back(
        {{"name", region.region.name},
         {"kind", stills::to_string(region.region.kind)},
         {"reference", region.reference},
         {"area", area},
         {"box", {box.x / across, box.y / down, box.width / across, box.height / down}},
         {"paths", paths},
         {"sequence", sequence}});
  }
  return report;
}

void write_frames(const StillsCommand& command, const stills::Film& film, const Job& job) {
  media::PictureSink sink(command.out, film.size(), film.render.frames, film.render.fps);
  stills::render_frames(
      film.plan, film.stills.pictures, film.render, [&](const cv::Mat& frame) { sink.write(frame); }, job);
  sink.finish();
}

/// What options mean to each other, and whether all outputs can be written: before the work.
void settle(StillsCommand& command) {
  if (command.folder.empty() || command.out.empty())
    throw Error(ErrorKind::kUsage, "synth stills", "a folder of stills and an --output are needed",
                "freshet synth stills FOLDER -o OUT.mp4");
  stills::PlanOptions& plan = command.film.plan;
  plan.timing.slow_turns = !command.no_slow_turns;
  plan.sampling.by_sum = command.normalise == "sum";
  if (command.distance == "l2") {
    plan.blur_px = kUnblurred;
    plan.graph.power = 1;
  }
  stills::settle(command.film);
  check_frames_output(command.out, command.film.render.frames);
  check_picture_output(command.sheet);
  check_output_folder(command.page);
}

/// The sheet of regions and the page, where they are asked for.
void write_pictures(const StillsCommand& command, const stills::Film& film) {
  std::vector<stills::Region> regions;  // as they are animated: split, and the slow one beside them
  for (const stills::PlannedRegion& planned : film.plan.regions) regions.push_back(planned.region);
  const cv::Mat sheet =
      stills::region_sheet(film.small[film.plan.standing], regions, stills::variation_of(film.small));
  if (!command.sheet.empty()) media::write_picture(command.sheet, sheet);
  if (command.page.empty()) return;
  const bool plays = !media::is_pattern(command.out);
  const fs::path folder = command.page.has_parent_path() ? command.page.parent_path() : fs::path(".");
  write_whole_file(
      command.page,
      stills::stills_page(film.plan, film.small, sheet,
                          {.title = command.folder.string(),
                           .video = plays ? fs::proximate(command.out, folder).string() : std::string(),
                           .names = film.stills.names,
                           .notices = film.notices,
                           .seconds = command.film.plan.seconds}));
}

/// By stage, s.
struct StageTimes {
  double read = 0, align = 0, plan = 0, frames = 0;
};

void tell(const StillsCommand& command, const stills::Film& film, const StageTimes& took) {
  const cv::Size size = film.size();
  say(fmt::format(
      "{} stills of {} x {} px, {} moving regions, {} frames: reading {:.1f} s, aligning {:.1f} s, regions "
      "and orders {:.1f} s, flow and frames {:.1f} s",
      film.stills.count(), size.width, size.height, film.plan.regions.size(), film.render.frames, took.read,
      took.align, took.plan, took.frames));
  if (command.json) {
    Json report = report_of(film.plan, film.stills.names);
    report["notices"] = film.notices;
    report["seconds"] = {
        {"read", took.read}, {"align", took.align}, {"plan", took.plan}, {"frames", took.frames}};
    fmt::print("{}\n", report.dump());
    return;
  }
  fmt::print("{}\n", command.out.string());
  for (const fs::path& each : {command.sheet, command.page})
    if (!each.empty()) fmt::print("{}\n", each.string());
}

void run_stills(StillsCommand command, RunContext& context) {
  if (command.keys) {
    fmt::print("{}", stills::edit_keys());
    return;
  }
  settle(command);
  Stopwatch watch;
  StageTimes took;
  Progress progress;
  const Job job{.progress = progress.callback(), .stop = context.stop};
  const std::unique_ptr<cache::ResultCache> cache = command.cache.open();
  stills::FilmOptions& options = command.film;
  options.render.cache = cache.get();

  stills::StillSet set = stills::read_stills(command.folder, stills::largest_side(options), job);
  media::PictureSink::check(command.out, set.size(), options.render.frames, options.fps);
  say_size(command.out, set.size());
  took.read = watch.lap();
  stills::straighten(set, options, job);
  took.align = watch.lap();
  const stills::Film film = stills::plan_film(std::move(set), options, job);
  took.plan = watch.lap();
  progress.finish();
  for (const std::string& notice : film.notices) say(notice);
  write_pictures(command, film);
  write_frames(command, film, job);
  progress.finish();
  finish_cache(cache.get());
  took.frames = watch.lap();
  tell(command, film, took);
}

void add_motion_options(CLI::App& sub, StillsCommand& command) {
  const std::string group = "Motion";
  sub.add_option("--step", command.film.plan.timing.step_s, "Mean time between stills, s")
      ->check(CLI::Range(0.04, 60.0))
      ->capture_default_str()
      ->group(group);
  sub.add_option("--speed", command.film.plan.timing.speed, "Speed factor")
      ->check(CLI::Range(0.05, 20.0))
      ->capture_default_str()
      ->group(group);
  sub.add_option("--sigma", command.film.plan.sampling.sigma, "Freedom to leave the paths; larger is freer")
      ->check(CLI::Range(1e-4, 100.0))
      ->capture_default_str()
      ->group(group);
  sub.add_option(
         "--distance", command.distance,
         "How unlike two stills are: paths (at six blurs, to the power 8, so that paths go through many "
         "stills) or l2 (the L2 norm, as printed: most paths have two stills)")
      ->check(CLI::IsMember({"paths", "l2"}))
      ->capture_default_str()
      ->group(group);
  sub.add_option(
         "--normalise", command.normalise,
         "What a step's penalty is divided by, times sigma: the mean of all, or their sum (as printed: "
         "the more paths, the more even the draw)")
      ->check(CLI::IsMember({"mean", "sum"}))
      ->capture_default_str()
      ->group(group);
  sub.add_option("--irregularity", command.film.plan.sampling.irregularity,
                 "Probability that motion turns within a path")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(group);
  sub.add_flag("--even-turns", command.no_slow_turns, "Keep the pace where motion turns")->group(group);
  sub.add_flag("--no-dead-ends", command.film.plan.sampling.avoid_dead_ends, "Skip dead-end branches")
      ->group(group);
  sub.add_option("--cut-above", command.film.plan.graph.cut_above,
                 "Cut steps that weigh more than this many times the mean")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str()
      ->group(group);
  sub.add_option("--seed", command.film.plan.sampling.seed, "Seed of the sequence")
      ->capture_default_str()
      ->group(group);
}

void add_region_options(CLI::App& sub, StillsCommand& command) {
  const std::string group = "Regions";
  sub.add_option("--regions", command.film.regions,
                 "Regions that move independently. An SVG over a still: closed outlines, with \"slow\" or "
                 "\"standing\" in their names where that applies. Or a picture: black stands still, grey is "
                 "slow, each colour and each white area is a region [proposed]")
      ->group(group);
  sub.add_option("--scribbles", command.film.scribbles,
                 "Picture of scribbles, of a still's size: white or green on each thing that moves, black or "
                 "red on what stands still")
      ->group(group);
  sub.add_flag("--one-region", command.film.one_region, "Treat the whole picture as one region")
      ->group(group);
  sub.add_option(
         "--split", command.film.plan.split,
         "Number of parts of each region that follow their neighbours loosely; 5 for a lake or the sea")
      ->check(CLI::Range(1, 8))
      ->capture_default_str()
      ->group(group);
  sub.add_option("--feather", command.film.render.feather_px,
                 "Width of a region's soft edge, px in a picture of 960 px")
      ->check(CLI::Range(0.0, 200.0))
      ->capture_default_str()
      ->group(group);
  sub.add_option("--edits", command.film.edits,
                 "TOML file that refuses or turns paths, cuts edges, sets orders and speeds, and pins where "
                 "something went "
                 "from one still to another; --keys explains it")
      ->group(group);
  sub.add_flag("--keys", command.keys, "Print the keys of an edits file")->group(group);
}

}  // namespace

void add_stills(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<StillsCommand>();
  CLI::App* sub = synth_command.add_subcommand("stills", "Make a moving scene from some stills of it");
  sub->add_option("FOLDER", command->folder,
                  "Ten to twenty stills of a scene (PNG, JPEG, TIFF), in any order");
  sub->add_option("-o,--output", command->out,
                  "The animation: " + frames_endings() +
                      " such as out/%05d.png; stills of 16 bits keep them where the format can");
  sub->add_option("--seconds", command->film.seconds, "Length, s")
      ->check(CLI::Range(0.04, 3600.0))
      ->capture_default_str();
  sub->add_option("--fps", command->film.fps, "Frames per second")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str();
  sub->add_flag("--loop", command->film.plan.loop, "Exact loop");
  sub->add_flag("--preview", command->film.preview, "Small and fast: 480 px, 12.5 frames per second");
  sub->add_option("--camera", command->film.camera,
                  "auto: hand-held stills are detected, aligned and cropped; tripod: unchanged; hand: "
                  "aligned and matched in exposure")
      ->check(CLI::IsMember({"auto", "tripod", "hand"}))
      ->capture_default_str();
  sub->add_option(
         "--level", command->film.level,
         "Match exposure and white balance by what stands still: on, off, or auto (hand-held stills)")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
  sub->add_option("--flow-side", command->film.render.flow_side,
                  "Longer side at which flow between stills is computed, px")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str();
  add_region_options(*sub, *command);
  add_motion_options(*sub, *command);
  sub->add_option("--sheet", command->sheet,
                  "Write a picture of the regions and of the variation (PNG, JPEG)");
  sub->add_option("--page", command->page,
                  "Write a page of graphs, paths and sequences, with the lines that edit them (.html)");
  sub->add_flag("--json", command->json, "Print paths, sequence and regions as JSON");
  command->cache.add_to(
      *sub,
      "the flow between stills in this folder, and use what is there: after an edit only what "
      "is new is found again");
  add_overwrite(*sub);
  add_threads(*sub);
  // Sigma, irregularity, slow turns and the regions are the person's.
  command->as_printed.add_to(*sub, "Lin et al. 2007",
                             {{"--camera", "tripod", "Sec. 1"},
                              {"--level", "off", "Sec. 1"},
                              {"--distance", "l2", "Sec. 3.1"},
                              {"--cut-above", "2", "Sec. 3.1"},
                              {"--normalise", "sum", "Eq. 2"}});
  sub->callback([command, &context] {
    command->as_printed.apply();
    if (command->as_printed.asked() && command->film.regions.empty() && command->film.scribbles.empty() &&
        !command->film.one_region && !command->keys)
      throw Error(ErrorKind::kUsage, "--as-printed", "a person marks the paper's regions, and none is marked",
                  "Give --regions, --scribbles or --one-region");
    run_stills(*command, context);
  });
}

}  // namespace freshet::tools
