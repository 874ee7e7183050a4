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
#include "synth/stills/alignment.h"
#include "synth/stills/plan.h"
#include "synth/stills/region_file.h"
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

constexpr int kWorkSide = 960;      // px: regions and weights are kept so large
constexpr double kUnblurred = 0.1;  // px: a Gaussian of one sample
constexpr int kPreviewSide = 480, kPreviewFlowSide = 320;

struct StillsCommand {
  fs::path folder, out, regions, scribbles, edits, sheet, page;
  double seconds = 8, fps = 25;
  std::string camera = "auto", levelling = "auto", distance = "paths", normalise = "mean";
  bool one_region = false, preview = false, json = false, keys = false, no_slow_turns = false;
  stills::PlanOptions plan;
  stills::RenderOptions render;
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

/// Brings the stills onto each other and to one level where they need it; returns what was done, for a
/// person.
std::vector<std::string> straighten(const StillsCommand& command, stills::StillSet& set, const Job& job) {
  std::vector<std::string> said;
  bool hand_held = command.camera == "hand";
  if (command.camera != "tripod") {
    const stills::Alignment found =
        stills::find_alignment(set.pictures, set.names, {.side = command.preview ? 480 : 1024}, job);
    if (found.unsure)
      said.emplace_back(
          "nothing stands still in these stills by which they could be aligned; the camera is taken to "
          "have stood still (--camera tripod)");
    hand_held |= !found.tripod;
    if (!found.tripod) {
      stills::align(set.pictures, found);
      said.push_back(fmt::format("taken from the hand: aligned by up to {:.1f} px, and cut to {} x {} px",
                                 found.largest_px, set.size().width, set.size().height));
    }
  }
  if (command.levelling == "on" || (command.levelling == "auto" && hand_held))
    if (const int changed =
            stills::level(set.pictures, stills::find_levels(stills::reduced(set.pictures, 320))))
      said.push_back(
          fmt::format("{} stills were brought to the others' exposure and white balance", changed));
  return said;
}

std::vector<stills::Region> choose_regions(const StillsCommand& command, const stills::StillSet& set,
                                           const std::vector<cv::Mat>& small,
                                           std::vector<std::string>& said) {
  if (!command.regions.empty())
    return stills::read_regions(command.regions, set.size(), small[0].size(), said);
  if (!command.scribbles.empty()) {
    cv::Mat still = set.pictures[0];
    if (still.depth() == CV_16U) still.convertTo(still, CV_8U, 1.0 / 257);
    return stills::scribbled_regions(command.scribbles, still, small, said);
  }
  stills::RegionProposal proposal = stills::propose_regions(small);
  if (command.one_region)
    return {{.name = "1", .mask = cv::Mat(small[0].size(), CV_8U, cv::Scalar(255)), .parent = {}}};
  return std::move(proposal.regions);
}

void refuse_double_words(const StillsCommand& command) {
  if (!command.regions.empty() + !command.scribbles.empty() + command.one_region > 1)
    throw Error(ErrorKind::kUsage, "synth stills", "regions are said more than once",
                "Give one of --regions, --scribbles and --one-region");
}

void write_frames(const StillsCommand& command, const stills::Plan& plan, const stills::StillSet& set,
                  const Job& job) {
  media::PictureSink sink(command.out, set.size(), command.render.frames, command.fps);
  stills::render_frames(
      plan, set.pictures, command.render, [&](const cv::Mat& frame) { sink.write(frame); }, job);
  sink.finish();
}

/// What options mean to each other, and whether all outputs can be written: before the work.
void settle(StillsCommand& command) {
  if (command.folder.empty() || command.out.empty())
    throw Error(ErrorKind::kUsage, "synth stills", "a folder of stills and an --output are needed",
                "freshet synth stills FOLDER -o OUT.mp4");
  refuse_double_words(command);
  if (command.preview) {
    command.fps = std::min(command.fps, 12.5);
    command.render.flow_side = kPreviewFlowSide;
  }
  command.render.fps = command.fps;
  command.render.frames = std::max(1, static_cast<int>(std::lround(command.seconds * command.fps)));
  command.plan.seconds = command.render.frames / command.fps;
  command.plan.timing.slow_turns = !command.no_slow_turns;
  command.plan.sampling.by_sum = command.normalise == "sum";
  if (command.distance == "l2") {
    command.plan.blur_px = kUnblurred;
    command.plan.graph.power = 1;
  }
  check_frames_output(command.out, command.render.frames);
  check_picture_output(command.sheet);
  check_output_folder(command.page);
  if (!command.edits.empty()) command.plan.edits = stills::read_edits(command.edits);
}

/// The sheet of regions and the page, where they are asked for.
void write_pictures(const StillsCommand& command, const stills::Plan& plan, const stills::StillSet& set,
                    const std::vector<cv::Mat>& small, const std::vector<std::string>& said) {
  std::vector<stills::Region> regions;  // as they are animated: split, and the slow one beside them
  for (const stills::PlannedRegion& planned : plan.regions) regions.push_back(planned.region);
  const cv::Mat sheet = stills::region_sheet(small[plan.standing], regions, stills::variation_of(small));
  if (!command.sheet.empty()) media::write_picture(command.sheet, sheet);
  if (command.page.empty()) return;
  const bool plays = !media::is_pattern(command.out);
  const fs::path folder = command.page.has_parent_path() ? command.page.parent_path() : fs::path(".");
  write_whole_file(
      command.page,
      stills::stills_page(plan, small, sheet,
                          {.title = command.folder.string(),
                           .video = plays ? fs::proximate(command.out, folder).string() : std::string(),
                           .names = set.names,
                           .notices = said,
                           .seconds = command.plan.seconds}));
}

/// By stage, s.
struct StageTimes {
  double read = 0, align = 0, plan = 0, frames = 0;
};

void tell(const StillsCommand& command, const stills::Plan& plan, const stills::StillSet& set,
          const std::vector<std::string>& said, const StageTimes& took) {
  say(fmt::format(
      "{} stills of {} x {} px, {} moving regions, {} frames: reading {:.1f} s, aligning {:.1f} s, regions "
      "and orders {:.1f} s, flow and frames {:.1f} s",
      set.count(), set.size().width, set.size().height, plan.regions.size(), command.render.frames, took.read,
      took.align, took.plan, took.frames));
  if (command.json) {
    Json report = report_of(plan, set.names);
    report["notices"] = said;
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
  command.render.cache = cache.get();

  stills::StillSet set = stills::read_stills(command.folder, command.preview ? kPreviewSide : 0, job);
  media::PictureSink::check(command.out, set.size(), command.render.frames, command.fps);
  say_size(command.out, set.size());
  took.read = watch.lap();
  std::vector<std::string> said = straighten(command, set, job);
  took.align = watch.lap();
  const std::vector<cv::Mat> small = stills::reduced(set.pictures, kWorkSide);
  // Widths are said for a picture of the work side; smaller ones are not enlarged to it.
  const double scale = std::max(small[0].cols, small[0].rows) / static_cast<double>(kWorkSide);
  command.render.feather_px *= scale;
  command.render.grown_px *= scale;
  const std::vector<stills::Region> regions = choose_regions(command, set, small, said);
  const stills::Plan plan = stills::make_plan(small, set.names, regions, command.plan, job);
  took.plan = watch.lap();
  progress.finish();
  said.insert(said.begin(), set.notices.begin(), set.notices.end());
  said.insert(said.end(), plan.notices.begin(), plan.notices.end());
  for (const std::string& notice : said) say(notice);
  write_pictures(command, plan, set, small, said);
  write_frames(command, plan, set, job);
  progress.finish();
  finish_cache(cache.get());
  took.frames = watch.lap();
  tell(command, plan, set, said, took);
}

void add_motion_options(CLI::App& sub, StillsCommand& command) {
  const std::string group = "Motion";
  sub.add_option("--step", command.plan.timing.step_s, "Mean time between stills, s")
      ->check(CLI::Range(0.04, 60.0))
      ->capture_default_str()
      ->group(group);
  sub.add_option("--speed", command.plan.timing.speed, "Speed factor")
      ->check(CLI::Range(0.05, 20.0))
      ->capture_default_str()
      ->group(group);
  sub.add_option("--sigma", command.plan.sampling.sigma, "Freedom to leave the paths; larger is freer")
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
  sub.add_option("--irregularity", command.plan.sampling.irregularity,
                 "Probability that motion turns within a path")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(group);
  sub.add_flag("--even-turns", command.no_slow_turns, "Keep the pace where motion turns")->group(group);
  sub.add_flag("--no-dead-ends", command.plan.sampling.avoid_dead_ends, "Skip dead-end branches")
      ->group(group);
  sub.add_option("--cut-above", command.plan.graph.cut_above,
                 "Cut steps that weigh more than this many times the mean")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str()
      ->group(group);
  sub.add_option("--seed", command.plan.sampling.seed, "Seed of the sequence")
      ->capture_default_str()
      ->group(group);
}

void add_region_options(CLI::App& sub, StillsCommand& command) {
  const std::string group = "Regions";
  sub.add_option("--regions", command.regions,
                 "Regions that move independently. An SVG over a still: closed outlines, with \"slow\" or "
                 "\"standing\" in their names where that applies. Or a picture: black stands still, grey is "
                 "slow, each colour and each white area is a region [proposed]")
      ->group(group);
  sub.add_option("--scribbles", command.scribbles,
                 "Picture of scribbles, of a still's size: white or green on each thing that moves, black or "
                 "red on what stands still")
      ->group(group);
  sub.add_flag("--one-region", command.one_region, "Treat the whole picture as one region")->group(group);
  sub.add_option(
         "--split", command.plan.split,
         "Number of parts of each region that follow their neighbours loosely; 5 for a lake or the sea")
      ->check(CLI::Range(1, 8))
      ->capture_default_str()
      ->group(group);
  sub.add_option("--feather", command.render.feather_px,
                 "Width of a region's soft edge, px in a picture of 960 px")
      ->check(CLI::Range(0.0, 200.0))
      ->capture_default_str()
      ->group(group);
  sub.add_option(
         "--edits", command.edits,
         "TOML file that refuses or turns paths, cuts edges, sets orders and speeds; --keys explains it")
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
  sub->add_option("--seconds", command->seconds, "Length, s")
      ->check(CLI::Range(0.04, 3600.0))
      ->capture_default_str();
  sub->add_option("--fps", command->fps, "Frames per second")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str();
  sub->add_flag("--loop", command->plan.loop, "Exact loop");
  sub->add_flag("--preview", command->preview, "Small and fast: 480 px, 12.5 frames per second");
  sub->add_option("--camera", command->camera,
                  "auto: hand-held stills are detected, aligned and cropped; tripod: unchanged; hand: "
                  "aligned and matched in exposure")
      ->check(CLI::IsMember({"auto", "tripod", "hand"}))
      ->capture_default_str();
  sub->add_option(
         "--level", command->levelling,
         "Match exposure and white balance by what stands still: on, off, or auto (hand-held stills)")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
  sub->add_option("--flow-side", command->render.flow_side,
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
    if (command->as_printed.asked() && command->regions.empty() && command->scribbles.empty() &&
        !command->one_region && !command->keys)
      throw Error(ErrorKind::kUsage, "--as-printed", "a person marks the paper's regions, and none is marked",
                  "Give --regions, --scribbles or --one-region");
    run_stills(*command, context);
  });
}

}  // namespace freshet::tools
