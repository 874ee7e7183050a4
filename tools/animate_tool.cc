#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "query/hints/stroke_field.h"
#include "synth/animate/animate.h"
#include "synth/animate/frame_sheet.h"
#include "synth/animate/motion/motion_field.h"
#include "synth/animate/staging.h"
#include "tools/animate_run.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/label_run.h"
#include "tools/options/cache_options.h"
#include "tools/options/hold_options.h"
#include "tools/options/motion_options.h"
#include "tools/options/outline_options.h"
#include "tools/options/output_options.h"
#include "tools/options/play_options.h"
#include "tools/options/search_options.h"

namespace freshet::tools {
namespace {

struct AnimateCommand {
  TargetFiles target;
  HoldOptions hold;
  SearchOptions search;
  MotionOptions motion;
  Duration duration;
  SolverOptions labelling;
  CacheOptions cache;
  PlayOptions play;
  OutlineOptions boundary;
  OutputOptions output;
  std::string assignment, sheet;
  std::string method = "carried", weights = "variance", low_band = "shared", matching = "sequence";
  synth::animate::AnimateOptions options;
  bool json = false;
};

/// What only --help-all explains: the search, the labelling and the rendering in their own words.
const std::vector<std::string> kModelOptions{
    "--assignment",  "--candidates", "--coherent",   "--min-scale",   "--max-rotation", "--piece",
    "--piece-scale", "--index",      "--checks",     "--solver",      "--iterations",   "--costs",
    "--lambda",      "--sigma",      "--vote",       "--rho",         "--tolerance",    "--speed-tolerance",
    "--resampling",  "--tau",        "--inpaint",    "--shutter",     "--softness",     "--method",
    "--variation",   "--renewal",    "--standing",   "--detail-life", "--blend",        "--low-band",
    "--matching",    "--max-gain",   "--cache-size", "--hint",        "--speed-white"};

synth::animate::AnimateOptions render_options(const AnimateCommand& command) {
  synth::animate::AnimateOptions options = command.options;
  options.frames = command.duration.frames;
  options.fps = command.duration.fps;
  command.play.apply(options);
  options.method =
      command.method == "paper" ? synth::animate::Method::kPaper : synth::animate::Method::kCarried;
  options.blend.weights = command.weights == "paper" ? synth::animate::BlendWeights::kPaper
                                                     : synth::animate::BlendWeights::kVariance;
  options.blend.low_band = command.low_band == "keep"     ? synth::animate::LowBand::kKeep
                           : command.low_band == "remove" ? synth::animate::LowBand::kRemove
                                                          : synth::animate::LowBand::kShared;
  options.matching = command.matching == "none"    ? synth::animate::AppearanceMatching::kNone
                     : command.matching == "frame" ? synth::animate::AppearanceMatching::kFrame
                                                   : synth::animate::AppearanceMatching::kSequence;
  return options;
}

std::vector<PlannedStage> stages_of(const AnimateCommand& command) {
  std::vector<PlannedStage> stages;
  if (command.assignment.empty())
    stages = {{"reading the index", ""},    {"guessing the motion", ""},  {"describing the picture", ""},
              {"searching candidates", ""}, {"comparing neighbours", ""}, {"choosing patches", ""}};
  stages.push_back({"blend", "reading the clips"});
  stages.push_back({"base", "preparing the picture"});
  if (command.method == "paper") stages.push_back({"match", "matching contrast"});
  stages.push_back({"render", "rendering"});
  return stages;
}

struct Chosen {
  query::Assignment assignment;
  nlohmann::json labelled;  // null for an assignment from a file
};

/// One patch for each piece, searched and labelled or read; what was guessed becomes part of what is asked.
Chosen choose_patches(const AnimateCommand& command, const store::Snapshot& snapshot,
                      const TargetFiles::Loaded& loaded, AskedMotion& asked, const RunContext& context) {
  Chosen chosen;
  if (command.assignment.empty()) {
    const query::LabelRequest request =
        request_of(command.search, asked, command.duration, &command.labelling);
    const LabelRun run = label_with_progress(snapshot, loaded, command.search, request, command.duration,
                                             context, command.cache.open().get());
    asked.guide = query::guide_of_animation(request, loaded.picture.size());
    say(label_summary(run));
    chosen.labelled = label_json(run);
    chosen.assignment = run.labelling.assignment;
    return chosen;
  }
  chosen.assignment = query::read_assignment(command.assignment);
  if (chosen.assignment.picture != loaded.picture.size())
    throw Error(ErrorKind::kInput, command.assignment,
                fmt::format("it was made for a picture of {} x {} px, and {} has {} x {}",
                            chosen.assignment.picture.width, chosen.assignment.picture.height,
                            command.target.picture.string(), loaded.picture.cols, loaded.picture.rows),
                "Label this picture with freshet query label");
  say_shares(chosen.assignment);
  return chosen;
}

void run_animate(AnimateCommand& command, const RunContext& context) {
  plan_stages(stages_of(command));
  const store::Snapshot snapshot = store::Store::open_read(command.target.store).snapshot();
  TargetFiles::Loaded loaded = command.target.load_with_matte();
  const cv::Mat held = command.hold.take_out(loaded);
  synth::animate::AnimateOptions options = render_options(command);
  command.boundary.apply(options, loaded.picture.size());
  options.boundary.held = held;
  AskedMotion asked =
      command.motion.read(loaded, command.search,
                          options.method == synth::animate::Method::kPaper ? query::HintSearch::kNarrow
                                                                           : query::HintSearch::kWide);
  const synth::animate::Playing playing = command.play.read(loaded.picture.size());
  // The output first: a mistyped folder should not cost a labelling.
  command.motion.check_outputs();
  check_picture_output(command.sheet);
  const std::unique_ptr<AnimationFiles> output = command.output.open(loaded, options);

  const Chosen chosen = choose_patches(command, snapshot, loaded, asked, context);
  const query::Assignment& assignment = chosen.assignment;
  const synth::animate::Staging staging =
      synth::animate::stage(snapshot, assignment, loaded.picture.size(), asked.guide, playing, options);
  const vision::Settings settings = vision::settings_from_json(snapshot.settings());
  const cv::Mat motion =
      command.motion.needs_motion(asked)
          ? synth::animate::motion_field(snapshot, settings, staging.placement, loaded.picture.size())
          : cv::Mat();
  command.motion.draw(loaded, asked, motion);
  command.motion.write_maps(loaded, motion);

  synth::animate::FrameSheet sheet(
      loaded.picture, loaded.matte, options.frames,
      {.fps = options.fps, .first_number = command.output.first_number(), .shown = 8, .width_px = 480});
  Progress progress;
  const synth::animate::AnimateReport report = synth::animate::animate(
      snapshot, settings, output->picture(), loaded.matte, staging.placement, staging.options,
      [&](const cv::Mat& frame) { sheet.add(output->write(frame)); }, progress.callback(), context.stop);
  output->finish();
  progress.finish();
  if (!command.sheet.empty()) media::write_picture(command.sheet, sheet.draw());
  say(fmt::format(
      "{} frames of {} x {} from {} pieces of {} clips in {:.1f} s, {:.1f} frames/s (decode {:.1f}, blend "
      "{:.1f}, base {:.1f}, match {:.1f}, render and write {:.1f})",
      options.frames, loaded.picture.cols, loaded.picture.rows, report.pieces, report.clips, report.total_s,
      options.frames / report.total_s, report.decode_s, report.blend_s, report.base_s, report.appearance_s,
      report.render_s));
  if (report.half_life_s > 0)
    say(fmt::format("half of the detail that is carried along is new after {:.2f} s (--detail-life)",
                    report.half_life_s));
  std::vector<std::string> files = command.output.files();
  files.push_back(command.sheet);
  for (const std::string& path : command.motion.outputs()) files.push_back(path);
  std::erase(files, "");
  if (!command.json) {
    for (const std::string& path : files) fmt::print("{}\n", path);
    return;
  }
  fmt::print("{}\n", nlohmann::json{{"files", files},
                                    {"frames", options.frames},
                                    {"width", loaded.picture.cols},
                                    {"height", loaded.picture.rows},
                                    {"fps", options.fps},
                                    {"pieces", report.pieces},
                                    {"clips", report.clips},
                                    {"batches", report.batches},
                                    {"half_life_s", report.half_life_s},
                                    {"labelling", chosen.labelled},
                                    {"shares", shares_json(assignment)},
                                    {"seconds",
                                     {{"decode", report.decode_s},
                                      {"blend", report.blend_s},
                                      {"base", report.base_s},
                                      {"match", report.appearance_s},
                                      {"render", report.render_s},
                                      {"total", report.total_s}}}}
                         .dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

/// The options that say how an animation is made, whoever asks for it and wherever it goes.
void add_making(CLI::App& app, AnimateCommand& command) {
  command.search.add_to(app);
  command.motion.add_to(app);
  command.labelling.add_to(app);
  command.cache.add_to(app);
  command.play.add_to(app);
  command.boundary.add_to(app);
  const std::string group = "Rendering";
  app.add_option("--shutter", command.options.base.shutter_s,
                 "Exposure of what stands still below, s: blurs it along the motion")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str()
      ->group(group);
  app.add_option("--softness", command.options.base.gaussian_s,
                 "Further blur in all directions: sigma in px for each px/s of speed")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str()
      ->group(group);
  app.add_option(
         "--method", command.method,
         "carried (the picture, carried along the patches' motion) or paper (the patches' differences "
         "on a long exposure of the picture: Okabe et al. 2011)")
      ->check(CLI::IsMember({"carried", "paper"}))
      ->capture_default_str()
      ->group(group);
  app.add_option(
         "--variation", command.options.carrying.variation,
         "How much of the patches' own flow, beside its mean, carries the picture (0: a steady field)")
      ->check(CLI::Range(0.0, 4.0))
      ->capture_default_str()
      ->group(group);
  app.add_option(
         "--renewal", command.options.renewal,
         "Of each band's contrast (variance), how much comes anew from the patches, 0 to 1; the rest is "
         "the picture's own, carried along")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(group);
  app.add_option(
         "--standing", command.options.standing,
         "Of the light and dark that stays in its place in the patches while the fluid goes by, how much "
         "the picture keeps, 0 to 1; 0: all goes along")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(group);
  app.add_option("--detail-life", command.options.half_life_s,
                 "After how long half of the detail that is carried along is new, s: .2 for rapids and "
                 "flames, several for "
                 "clouds; 0: as in the patches that are shown")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str()
      ->group(group);
  app.add_option("--blend", command.weights,
                 "variance (keeps the contrast of overlapping pieces) or paper (averages)")
      ->check(CLI::IsMember({"variance", "paper"}))
      ->capture_default_str()
      ->group(group);
  app.add_option("--low-band", command.low_band,
                 "Level of each piece over time: shared with its neighbours, keep, or remove")
      ->check(CLI::IsMember({"shared", "keep", "remove"}))
      ->capture_default_str()
      ->group(group);
  app.add_option("--matching", command.matching,
                 "Contrast and levels matched to the picture: over the whole sequence, by frame (the "
                 "paper's; pumps), or none")
      ->check(CLI::IsMember({"sequence", "frame", "none"}))
      ->capture_default_str()
      ->group(group);
  app.add_option("--max-gain", command.options.appearance.max_gain, "Most that matching amplifies a band")
      ->check(CLI::Range(1.0, 20.0))
      ->capture_default_str()
      ->group(group);
}

void add_animate(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<AnimateCommand>();
  CLI::App* sub =
      synth_command.add_subcommand("animate", "Animate a still picture with the patches of a store");
  command->target.add_to(*sub);
  command->hold.add_to(*sub);
  command->output.add_to(*sub);
  sub->add_option("--sheet", command->sheet, "Write a contact sheet of the picture and frames (PNG, JPEG)");
  sub->add_option("--assignment", command->assignment,
                  "Use this assignment, from freshet query label, in place of searching and labelling");
  sub->add_flag("--json", command->json, "Print files, labelling and seconds by stage as JSON");
  command->duration.add_to(*sub);
  command->motion.add_outputs_to(*sub);
  add_making(*sub, *command);
  add_threads(*sub);
  add_short_help(*sub, kModelOptions);
  sub->callback([command, sub, &context] {
    if (!command->assignment.empty())
      for (const char* name :
           {"--class", "--direction", "--exclude", "--piece", "--piece-scale", "--solver", "--hint",
            "--hint-search", "--strokes", "--orientation-map", "--speed-map", "--cache"})
        if (sub->count(name) > 0)
          say(fmt::format("{} has no effect: {} says which patches are used", name, command->assignment));
    run_animate(*command, context);
  });
}

}  // namespace

void animate_layer(const AnimateRequest& request, const std::function<void(const cv::Mat&)>& sink,
                   const RunContext& context) {
  AnimateCommand command;
  CLI::App app("options of freshet synth animate", "options");
  add_making(app, command);
  try {
    app.parse(std::vector<std::string>(request.words.rbegin(), request.words.rend()));
  } catch (const CLI::ParseError& fault) {
    throw Error(ErrorKind::kUsage, request.where, fmt::format("options: {}", fault.what()),
                "freshet synth animate --help-all explains those that there are, but for files and length");
  }
  command.target.store = request.store;
  command.duration = {.frames = request.frames, .fps = request.fps};
  const store::Snapshot snapshot = store::Store::open_read(request.store).snapshot();
  synth::animate::AnimateOptions options = render_options(command);
  options.loop = request.loop;
  options.form = synth::animate::FrameForm::kFluid;
  command.boundary.apply(options, request.loaded.picture.size());
  AskedMotion asked = command.motion.read(request.loaded, command.search);
  if (!request.strokes.empty() && asked.strokes.empty()) {
    const query::StrokeField field =
        query::interpolate(request.strokes, request.loaded.picture.size(), request.where);
    asked.guide.direction = field.direction;
    asked.guide.speed = field.speed;
  }
  const Chosen chosen = choose_patches(command, snapshot, request.loaded, asked, context);
  const synth::animate::Staging staging =
      synth::animate::stage(snapshot, chosen.assignment, request.loaded.picture.size(), asked.guide,
                            command.play.read(request.loaded.picture.size()), options);
  synth::animate::animate(snapshot, vision::settings_from_json(snapshot.settings()), request.loaded.picture,
                          request.loaded.matte, staging.placement, staging.options, sink, {}, context.stop);
}

void add_synth(CLI::App& app, RunContext& context) {
  CLI::App* synth_command = app.add_subcommand(
      "synth", "Synthesise: animate a picture or some stills, simulate a fluid, or transfer a look");
  synth_command->require_subcommand(1);
  add_animate(*synth_command, context);
  add_sweep(*synth_command, context);
  add_matte(*synth_command, context);
  add_simulate(*synth_command, context);
  add_stills(*synth_command, context);
  add_transfer(*synth_command, context);
  add_scene(*synth_command, context);
  add_layers(*synth_command, context);
  add_flowlines(*synth_command, context);
}

}  // namespace freshet::tools
