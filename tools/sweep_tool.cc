// freshet synth sweep: one picture animated with all combinations of some settings.

#include <algorithm>
#include <atomic>
#include <exception>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "media/video/picture_sink.h"
#include "platform/stopwatch.h"
#include "query/labelling/label_sweep.h"
#include "query/labelling/labelling_memo.h"
#include "synth/animate/staging.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/label_run.h"
#include "tools/options/cache_options.h"
#include "tools/options/hold_options.h"
#include "tools/options/motion_options.h"
#include "tools/options/play_options.h"
#include "tools/sweep_grid.h"
#include "tools/sweep_page.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

struct SweepCommand {
  TargetFiles target;
  HoldOptions hold;
  SearchOptions search;
  MotionOptions motion;
  Duration duration;
  SolverOptions labelling;
  PlayOptions play;
  CacheOptions cache;
  std::vector<std::string> sweeps;
  std::string folder, video = "mp4";
  bool json = false;
};

struct SweepSeconds {
  double open = 0, search = 0, label = 0, render = 0;
};

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  if (!file) throw Error(ErrorKind::kIo, path.string(), "it cannot be written");
}

/// Of the points, those whose labelling is another than that of each point before; and for each point, which.
struct DistinctLabellings {
  std::vector<query::LabelVariation> variations;
  std::vector<std::size_t> of_point;
};
DistinctLabellings distinct_labellings(const std::vector<SweepPoint>& points) {
  DistinctLabellings distinct;
  const auto same = [](const query::LabelVariation& a, const query::LabelVariation& b) {
    return a.costs.form == b.costs.form && a.costs.lambda == b.costs.lambda &&
           a.costs.sigma == b.costs.sigma && a.costs.rho == b.costs.rho && a.costs.vote == b.costs.vote &&
           a.minimizer == b.minimizer && a.max_iterations == b.max_iterations;
  };
  for (const SweepPoint& point : points) {
    std::size_t at = 0;
    while (at < distinct.variations.size() && !same(distinct.variations[at], point.labelling)) ++at;
    if (at == distinct.variations.size()) distinct.variations.push_back(point.labelling);
    distinct.of_point.push_back(at);
  }
  return distinct;
}

/// Runs work(0) .. work(count - 1), so many at once; the first error is thrown when all have ended. Each is
/// its own thread: a task of one animation must not begin another, whose memory was not counted.
void run_beside(std::size_t count, std::size_t at_once, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::mutex guard;
  std::exception_ptr fault;
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < std::min(count, at_once); ++t)
      threads.emplace_back([&] {
        for (std::size_t i = next++; i < count; i = next++) {
          try {
            work(i);
          } catch (...) {
            const std::lock_guard lock(guard);
            if (!fault) fault = std::current_exception();
            next = count;
          }
        }
      });
  }
  if (fault) std::rethrow_exception(fault);
}

nlohmann::json report_of(const std::vector<SweepPoint>& points, const std::vector<SweptAnimation>& animations,
                         const query::CandidateSearch& search, std::size_t labellings,
                         const SweepSeconds& seconds) {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < points.size(); ++i) {
    nlohmann::json settings;
    for (const auto& [name, value] : points[i].settings) settings[name] = value;
    list.push_back({{"settings", settings},
                    {"energy", animations[i].energy},
                    {"changed", animations[i].changed},
                    {"video", animations[i].video},
                    {"assignment", animations[i].assignment}});
    if (std::isfinite(animations[i].gap)) list.back()["gap"] = animations[i].gap;
    list.back()["gap_reached"] = animations[i].gap <= query::kGapAimed;
  }
  return {{"pieces", search.target.size()},
          {"edges", search.target.edges.size()},
          {"labellings", labellings},
          {"combinations", list},
          {"seconds",
           {{"open", seconds.open},
            {"search", seconds.search},
            {"label", seconds.label},
            {"render", seconds.render}}}};
}

/// What all animations of a sweep share.
struct SweepStage {
  const store::Snapshot& snapshot;
  const vision::Settings& settings;
  const TargetFiles::Loaded& loaded;
  const query::MotionGuide& guide;
  const synth::animate::Playing& playing;
  const fs::path& folder;
  std::stop_token stop;
};

/// Of pieces, how many are labelled otherwise than the first labelling does.
double fraction_unlike(const query::Labels& labels, const query::Labels& first) {
  std::size_t unlike = 0;
  for (std::size_t piece = 0; piece < first.size(); ++piece) unlike += first[piece] != labels[piece];
  return static_cast<double>(unlike) / static_cast<double>(first.size());
}

/// Stages and renders one animation into its file and keeps its middle frame.
/// at_once   animations that share the memory.
void render_point(const SweepStage& stage, const SweepPoint& point, const query::Assignment& assignment,
                  std::size_t at_once, SweptAnimation& animation) {
  synth::animate::Staging staging = synth::animate::stage(
      stage.snapshot, assignment, stage.loaded.picture.size(), stage.guide, stage.playing, point.rendering);
  synth::animate::AnimateOptions& options = staging.options;
  options.memory_bytes /= at_once;
  media::PictureSink sink(stage.folder / animation.video, stage.loaded.picture.size(), options.frames,
                          options.fps);
  int frame = 0;
  synth::animate::animate(
      stage.snapshot, stage.settings, stage.loaded.picture, stage.loaded.matte, staging.placement, options,
      [&](const cv::Mat& picture) {
        sink.write(picture);
        if (frame++ == options.frames / 2) animation.frame = picture.clone();
      },
      {}, stage.stop);
  sink.finish();
}

/// All animations, as many beside each other as the memory allows.
std::vector<SweptAnimation> render_points(const SweepStage& stage, std::span<const SweepPoint> points,
                                          const DistinctLabellings& distinct,
                                          std::span<const query::SweptLabelling> labellings,
                                          const std::string& video, std::size_t memory_bytes,
                                          Progress& progress) {
  std::vector<SweptAnimation> animations(points.size());
  const std::size_t at_once =
      std::min(points.size(), synth::animate::animations_at_once(memory_bytes, stage.loaded.picture.size()));
  std::mutex guard;
  std::size_t rendered = 0;
  progress.show("rendering", 0, points.size(), "animations");
  run_beside(points.size(), at_once, [&](std::size_t i) {
    if (stage.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "sweep", "stopped");
    const query::SweptLabelling& labelling = labellings[distinct.of_point[i]];
    SweptAnimation& animation = animations[i];
    animation.title = points[i].title();
    animation.video = fmt::format("{:02}.{}", i + 1, video);
    animation.assignment = fmt::format("{:02}.json", i + 1);
    animation.energy = labelling.assignment.energy;
    animation.gap = labelling.assignment.gap();
    animation.changed = fraction_unlike(labelling.labels, labellings[distinct.of_point[0]].labels);
    query::write_assignment(stage.folder / animation.assignment, labelling.assignment);
    render_point(stage, points[i], labelling.assignment, at_once, animation);
    const std::lock_guard lock(guard);
    progress.show("rendering", ++rendered, points.size(), "animations");
  });
  progress.finish();
  return animations;
}

/// The table for people.
void print_sweep(std::span<const SweptAnimation> animations, std::size_t labellings, std::size_t pieces,
                 const SweepSeconds& seconds, const fs::path& folder) {
  for (const SweptAnimation& animation : animations)
    fmt::print("{}  {}  {}, {:.0f}% of pieces unlike the first's\n", animation.video, animation.title,
               energy_text(animation), 100 * animation.changed);
  say(fmt::format(
      "{} animations of {} labellings of {} pieces in {:.1f} s (index {:.1f}, search {:.1f}, label "
      "{:.1f}, render {:.1f})",
      animations.size(), labellings, pieces, seconds.open + seconds.search + seconds.label + seconds.render,
      seconds.open, seconds.search, seconds.label, seconds.render));
  fmt::print("{}\n{}\n", (folder / "sheet.png").string(), (folder / "index.html").string());
}

void run_sweep(const SweepCommand& command, const RunContext& context) {
  std::vector<SweepAxis> axes;
  for (const std::string& text : command.sweeps) axes.push_back(parse_axis(text));
  synth::animate::AnimateOptions rendering;
  rendering.frames = command.duration.frames;
  rendering.fps = command.duration.fps;
  command.play.apply(rendering);
  std::vector<SweepPoint> points = make_grid(axes, command.labelling, rendering);
  for (const SweepPoint& point : points) query::check_weights(point.labelling.costs);
  command.motion.check_outputs();
  const store::Snapshot snapshot = store::Store::open_read(command.target.store).snapshot();
  TargetFiles::Loaded loaded = command.target.load_with_matte();
  command.hold.take_out(loaded);
  say_reduction(command.target, loaded);
  AskedMotion asked = command.motion.read(loaded, command.search);
  const synth::animate::Playing playing = command.play.read(loaded.picture.size());
  const query::LabelRequest request = request_of(command.search, asked, command.duration);
  asked.guide = query::guide_of_animation(request, loaded.picture.size());
  command.motion.draw(loaded, asked, {});
  const fs::path folder = command.folder;
  check_folder_output(folder);

  Progress progress;
  SweepSeconds seconds;
  const auto cache = command.cache.open();
  const auto base = open_with_progress(snapshot, command.search, cache != nullptr);
  seconds.open = base->seconds;
  Stopwatch watch;
  std::unique_ptr<query::LabellingMemo> memo;
  if (cache) memo = std::make_unique<query::LabellingMemo>(*cache, snapshot, *base);
  const query::LabelOptions options =
      prepare_with_progress(snapshot, *base, loaded, request, context, memo.get());
  const query::CandidateSearch search = query::search_candidates(
      snapshot, *base, loaded.picture, loaded.matte, options, progress.callback(), context.stop, memo.get());
  finish_cache(cache.get());
  progress.finish();
  say_filters(search.filtered, command.duration);
  for (const std::string& note : search.candidates.notes) say(note);
  seconds.search = watch.lap();

  const DistinctLabellings distinct = distinct_labellings(points);
  std::mutex guard;
  progress.show("labelling", 0, distinct.variations.size(), "combinations");
  const std::vector<query::SweptLabelling> labellings = query::label_variations(
      snapshot, search, distinct.variations,
      {.guide_costs = options.guide_costs, .reuse = options.reuse, .memory_bytes = rendering.memory_bytes},
      [&](std::size_t done) {
        const std::lock_guard lock(guard);
        progress.show("labelling", done, distinct.variations.size(), "combinations");
      },
      context.stop);
  progress.finish();
  seconds.label = watch.lap();

  const SweepStage stage{snapshot, base->settings, loaded, asked.guide, playing, folder, context.stop};
  const std::vector<SweptAnimation> animations =
      render_points(stage, points, distinct, labellings, command.video, rendering.memory_bytes, progress);
  seconds.render = watch.lap();

  media::write_picture(folder / "still.png", loaded.picture);
  media::write_picture(folder / "sheet.png", sweep_sheet(loaded.picture, animations));
  write_text(folder / "index.html", sweep_page("Sweep of " + command.target.picture.filename().string(),
                                               "still.png", loaded.picture.size(), animations));
  const nlohmann::json report = report_of(points, animations, search, labellings.size(), seconds);
  write_text(folder / "sweep.json",
             report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  if (command.json) {
    fmt::print("{}\n", report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return;
  }
  print_sweep(animations, labellings.size(), search.target.size(), seconds, folder);
}

}  // namespace

void add_sweep(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<SweepCommand>();
  CLI::App* sub = synth_command.add_subcommand(
      "sweep", "Animate a still picture with all combinations of some settings, side by side");
  command->target.add_to(*sub);
  command->hold.add_to(*sub);
  sub->add_option("--sweep", command->sweeps,
                  "NAME=VALUE,VALUE,...; may be given several times: all combinations are made, " +
                      std::to_string(kMaxPoints) + " at most. Names: " + sweepable_names())
      ->required()
      ->type_name("NAME=VALUES");
  sub->add_option("-o,--output", command->folder,
                  "Folder for index.html, sheet.png, sweep.json, and a video and an assignment for each "
                  "combination; made when it is not there")
      ->required()
      ->type_name("DIR");
  sub->add_option("--video", command->video, "Kind of the videos: mp4 or webp")
      ->check(CLI::IsMember({"mp4", "webp"}))
      ->capture_default_str();
  sub->add_flag("--json", command->json, "Print the result as JSON");
  command->duration.add_to(*sub);
  command->search.add_to(*sub);
  command->motion.add_to(*sub);
  command->labelling.add_to(*sub);
  command->play.add_to(*sub);
  command->cache.add_to(*sub);
  add_overwrite(*sub);
  add_threads(*sub);
  sub->callback([command, &context] { run_sweep(*command, context); });
}

}  // namespace freshet::tools
