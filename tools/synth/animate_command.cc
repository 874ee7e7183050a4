#include "tools/synth/animate_command.h"

#include <fmt/format.h>

#include "freshet/error.h"
#include "stored/store_settings.h"
#include "tools/console/run_context.h"

namespace freshet::tools {
namespace {

constexpr const char* kRendering = "Rendering";

/// What only --help-all explains: the search, the labelling and the rendering in their own words.
const std::vector<std::string> kModelOptions{
    "--assignment",  "--candidates", "--coherent",   "--min-scale",   "--max-rotation", "--piece",
    "--piece-scale", "--index",      "--checks",     "--solver",      "--iterations",   "--costs",
    "--lambda",      "--sigma",      "--vote",       "--rho",         "--tolerance",    "--speed-tolerance",
    "--resampling",  "--tau",        "--inpaint",    "--shutter",     "--softness",     "--method",
    "--variation",   "--renewal",    "--standing",   "--detail-life", "--blend",        "--low-band",
    "--matching",    "--max-gain",   "--cache-size", "--hint",        "--speed-white"};

}  // namespace

void AnimateCommand::add_to(CLI::App& app) {
  target.add_to(app);
  hold.add_to(app);
  output.add_to(app);
  app.add_option("--sheet", sheet, "Write a contact sheet of the picture and frames (PNG, JPEG)");
  app.add_option("--assignment", assignment,
                 "Use this assignment, from freshet query label, in place of searching and labelling");
  app.add_flag("--json", json, "Print files, labelling and seconds by stage as JSON");
  duration.add_to(app);
  motion.add_outputs_to(app);
  add_making_to(app);
  add_threads(app);
  add_short_help(app, kModelOptions);
}

void AnimateCommand::add_choosing_to(CLI::App& app) {
  target.add_to(app);
  hold.add_to(app);
  search.add_to(app);
  motion.add_to(app);
  labelling.add_to(app);
  cache.add_to(app);
  add_threads(app);
}

void AnimateCommand::add_making_to(CLI::App& app) {
  search.add_to(app);
  motion.add_to(app);
  labelling.add_to(app);
  cache.add_to(app);
  play.add_to(app);
  outline.add_to(app);
  add_carrying_to(app);
  add_blending_to(app);
}

void AnimateCommand::add_carrying_to(CLI::App& app) {
  app.add_option("--shutter", base.shutter_s,
                 "Exposure of what stands still below, s: blurs it along the motion")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str()
      ->group(kRendering);
  app.add_option("--softness", base.gaussian_s,
                 "Further blur in all directions: sigma in px for each px/s of speed")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str()
      ->group(kRendering);
  app.add_option(
         "--method", method,
         "carried (the picture, carried along the patches' motion) or paper (the patches' differences "
         "on a long exposure of the picture: Okabe et al. 2011)")
      ->check(CLI::IsMember({"carried", "paper"}))
      ->capture_default_str()
      ->group(kRendering);
  app.add_option(
         "--variation", carried.carrying.variation,
         "How much of the patches' own flow, beside its mean, carries the picture (0: a steady field)")
      ->check(CLI::Range(0.0, 4.0))
      ->capture_default_str()
      ->group(kRendering);
  app.add_option(
         "--renewal", carried.innovations->renewal.share,
         "Of what comes anew in the patches from frame to frame, how much comes anew in the picture, 0 to 1; "
         "the rest is the picture's own, carried along")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(kRendering);
  app.add_option(
         "--standing", carried.standing,
         "Of the light and dark that stays in its place in the patches while the fluid goes by, how much "
         "the picture keeps, 0 to 1; 0: all goes along")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(kRendering);
  app.add_option("--detail-life", carried.half_life_s,
                 "After how long half of the detail that is carried along is new, s: .2 for rapids and "
                 "flames, several for "
                 "clouds; 0: as in the patches that are shown")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str()
      ->group(kRendering);
}

void AnimateCommand::add_blending_to(CLI::App& app) {
  app.add_option("--blend", weights,
                 "variance (keeps the contrast of overlapping pieces) or paper (averages)")
      ->check(CLI::IsMember({"variance", "paper"}))
      ->capture_default_str()
      ->group(kRendering);
  app.add_option("--low-band", low_band,
                 "Level of each piece over time: shared with its neighbours, keep, or remove")
      ->check(CLI::IsMember({"shared", "keep", "remove"}))
      ->capture_default_str()
      ->group(kRendering);
  app.add_option("--matching", matching,
                 "Contrast and levels matched to the picture: over the whole sequence, by frame (the "
                 "paper's; pumps), or none")
      ->check(CLI::IsMember({"sequence", "frame", "none"}))
      ->capture_default_str()
      ->group(kRendering);
  app.add_option("--max-gain", paper.appearance.max_gain, "Most that matching amplifies a band")
      ->check(CLI::Range(1.0, 20.0))
      ->capture_default_str()
      ->group(kRendering);
}

synth::animate::AnimateOptions AnimateCommand::rendering() const {
  using namespace synth::animate;
  AnimateOptions made;
  made.frames = duration.frames;
  made.fps = duration.fps;
  play.apply(made);
  const BlendWeights blend = weights == "paper" ? BlendWeights::kPaper : BlendWeights::kVariance;
  if (method == "carried") {
    CarriedOptions of_carried = carried;
    of_carried.resampling = play.resampling();
    of_carried.base = base;
    of_carried.innovations->weights = blend;
    made.method = of_carried;
    return made;
  }
  PaperOptions of_paper = paper;
  of_paper.resampling = play.resampling();
  of_paper.base = base;
  of_paper.blend.weights = blend;
  of_paper.blend.low_band = low_band == "keep"     ? LowBand::kKeep
                            : low_band == "remove" ? LowBand::kRemove
                                                   : LowBand::kShared;
  of_paper.matching = matching == "none"    ? AppearanceMatching::kNone
                      : matching == "frame" ? AppearanceMatching::kFrame
                                            : AppearanceMatching::kSequence;
  made.method = of_paper;
  return made;
}

std::vector<PlannedStage> AnimateCommand::stages() const {
  std::vector<PlannedStage> stages;
  if (assignment.empty())
    stages = {{"reading the index", ""},    {"guessing the motion", ""},  {"describing the picture", ""},
              {"searching candidates", ""}, {"comparing neighbours", ""}, {"choosing patches", ""}};
  stages.push_back({"blend", "reading the clips"});
  stages.push_back({"base", "preparing the picture"});
  if (method == "paper") stages.push_back({"match", "matching contrast"});
  stages.push_back({"render", "rendering"});
  return stages;
}

std::function<void(const cv::Mat&)>* AnimateInputs::motion_sink() {
  auto* const carried = std::get_if<synth::animate::CarriedOptions>(&options.method);
  return carried != nullptr ? &carried->motion_sink : nullptr;
}

AnimateInputs read_inputs(const AnimateCommand& command) {
  AnimateInputs inputs{
      .loaded = command.target.load_with_matte(), .options = command.rendering(), .asked = {}, .playing = {}};
  const cv::Mat held = command.hold.take_out(inputs.loaded);
  command.outline.apply(inputs.options, inputs.loaded.picture.size());
  inputs.options.outline.held = held;
  inputs.asked =
      command.motion.read(inputs.loaded, command.search,
                          command.method == "paper" ? query::HintSearch::kNarrow : query::HintSearch::kWide);
  inputs.playing = command.play.read(inputs.loaded.picture.size());
  return inputs;
}

ChosenPatches choose_patches(const AnimateCommand& command, const store::Snapshot& snapshot,
                             const TargetFiles::Loaded& loaded, AskedMotion& asked, const BaseSource& base,
                             cache::ResultCache* cache, const RunContext& context) {
  ChosenPatches chosen;
  if (command.assignment.empty()) {
    const query::LabelRequest request =
        request_of(command.search, asked, command.duration, &command.labelling);
    const LabelRun run = label_with_progress(snapshot, base(command.search), loaded, request,
                                             command.duration, context, cache);
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

synth::animate::Staging stage(const store::Snapshot& snapshot, const AnimateInputs& inputs,
                              const query::Assignment& assignment) {
  return synth::animate::stage(snapshot, assignment, inputs.loaded.picture.size(), inputs.asked.guide,
                               inputs.playing, inputs.options);
}

synth::animate::AnimateReport render(const store::Snapshot& snapshot, const AnimateInputs& inputs,
                                     const synth::animate::Staging& staging, const cv::Mat& picture,
                                     const std::function<void(const cv::Mat&)>& sink,
                                     const ProgressFunction& progress, const RunContext& context) {
  return synth::animate::animate(snapshot, stored::settings_of(snapshot), picture, inputs.loaded.matte,
                                 staging.placement, staging.options, sink, progress, context.stop);
}

}  // namespace freshet::tools
