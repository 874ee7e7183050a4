#include "tools/synth/animate_command.h"

#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "freshet/error.h"
#include "stored/store_settings.h"
#include "synth/animate/motion/motion_field.h"
#include "synth/animate/placement/assigned.h"
#include "synth/judging/usual.h"
#include "synth/takes/pace.h"
#include "tools/console/run_context.h"
#include "vision/look/fluid_kind.h"

namespace freshet::tools {

void AnimateCommand::add_to(CLI::App& app) {
  target.add_to(app);
  hold.add_to(app);
  output.add_to(app);
  app.add_option("--sheet", sheet, "Write a contact sheet of the picture and frames (PNG, JPEG)");
  app.add_option(
      "--credits", credits,
      "Write which clips the film shows, with share, author, licence and source: .json for programs, else "
      "text");
  app.add_option(
         "--takes", takes,
         "Number of small takes to compare; the one with the fewest faults is made. They vary what no option "
         "sets: speed, layout, half-life of detail, flames of clips. --sheet shows them. 1: as asked")
      ->check(CLI::Range(1, synth::takes::kMaxTakes))
      ->capture_default_str();
  app.add_option("--assignment", assignment,
                 "Use this assignment, from freshet query label, in place of searching and labelling")
      ->group(in_detail("Labelling"));
  app.add_flag("--json", json, "Print files, labelling and seconds by stage as JSON");
  duration.add_to(app);
  motion.add_outputs_to(app);
  add_making_to(app);
  add_threads(app);
  add_short_help(app);
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
  motion.add_rendering_to(app);
  labelling.add_to(app);
  cache.add_to(app);
  play.add_to(app);
  outline.add_to(app);
  method.add_to(app);
}

void AnimateCommand::add_search_to(CLI::App& app) {
  search.add_to(app);
  motion.add_search_to(app);
  labelling.add_to(app);
  cache.add_to(app);
}

synth::animate::AnimateOptions AnimateCommand::rendering() const {
  synth::animate::AnimateOptions made;
  made.frames = duration.frames;
  made.fps = duration.fps;
  play.apply(made);
  made.method = method.method();
  if (method.names_method()) made.for_fires.reset();
  auto* forms = std::get_if<synth::animate::FormsOptions>(&made.method);
  if (forms == nullptr && made.for_fires) forms = &*made.for_fires;  // a take may show clips' flames
  if (forms != nullptr) {
    forms->excluded = search.options().excluded_clips;
    forms->placed_only = !assignment.empty();
  }
  return made;
}

query::HintSearch AnimateCommand::hint_search() const {
  const bool paper = std::holds_alternative<synth::animate::PaperOptions>(method.method());
  return paper ? query::HintSearch::kNarrow : query::HintSearch::kWide;
}

std::vector<PlannedStage> AnimateCommand::stages() const {
  std::vector<PlannedStage> stages;
  if (assignment.empty())
    stages = {{"reading the index", ""},    {"guessing the motion", ""},  {"describing the picture", ""},
              {"searching candidates", ""}, {"comparing neighbours", ""}, {"choosing patches", ""}};
  if (takes > 1) stages.push_back({"takes", "trying takes"});
  const synth::animate::Method made = method.method();
  if (std::holds_alternative<synth::animate::FormsOptions>(made)) {
    stages.push_back({"choosing forms", ""});
  } else {
    stages.push_back({"blend", "reading the clips"});
    stages.push_back({"base", "preparing the picture"});
  }
  if (std::holds_alternative<synth::animate::PaperOptions>(made))
    stages.push_back({"match", "matching contrast"});
  stages.push_back({"render", "rendering"});
  return stages;
}

AnimateInputs read_inputs(const AnimateCommand& command) {
  AnimateInputs inputs{
      .loaded = command.target.load_with_matte(), .options = command.rendering(), .asked = {}, .playing = {}};
  const cv::Mat held = command.hold.take_out(inputs.loaded);
  command.outline.apply(inputs.options, inputs.loaded.picture.size());
  inputs.options.outline.held = held;
  inputs.asked = command.motion.read(inputs.loaded, command.search, command.hint_search());
  inputs.playing = command.play.read(inputs.loaded.picture.size());
  inputs.pace = command.play.pace();
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
    chosen.kind = run.kind;
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
  chosen.kind.look = vision::fluid_kind(vision::fluid_look(loaded.picture, loaded.looked_at()));
  say_shares(chosen.assignment);
  return chosen;
}

/// Where faster is asked than a fluid goes.
void say_fastest(const query::MotionGuide& asked, cv::Size picture) {
  if (asked.speed.empty()) return;
  double most = 0;
  cv::minMaxLoc(asked.speed, nullptr, &most);
  const double fastest = synth::animate::fastest_speed(picture);
  if (most > fastest)
    say(fmt::format(
        "{:.0f} px/s are asked; it goes by at most {:.0f}, as the fastest fluid does at this size", most,
        fastest));
}

void pace_it(const store::Snapshot& snapshot, AnimateInputs& inputs, const query::Assignment& assignment,
             const std::string& kind) {
  say_fastest(inputs.asked.guide, inputs.loaded.picture.size());
  if (inputs.pace.empty()) return;
  const synth::takes::Paced paced =
      synth::takes::paced(snapshot, stored::settings_of(snapshot), assignment, inputs.loaded.matte,
                          inputs.pace, kind, !inputs.asked.guide.speed.empty());
  inputs.playing.factor = paced.factor;
  if (paced.factor != 1)
    say(fmt::format(
        "--speed {}: {:.0f} px/s is usual for {}; as filmed {:.0f}; it plays at {:.2f}, which makes {:.0f}",
        inputs.pace,
        synth::judging::speed_of(kind, inputs.pace == "auto" ? "natural" : inputs.pace,
                                 inputs.loaded.picture.size()),
        kind.empty() ? "all kinds" : kind, paced.filmed.mean, paced.factor,
        paced.factor * paced.filmed.mean));
  inputs.pace.clear();
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
