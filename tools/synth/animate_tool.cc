#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "hints/stroke_field.h"
#include "media/picture/picture.h"
#include "stored/store_settings.h"
#include "synth/animate/frame_sheet.h"
#include "synth/animate/motion/motion_field.h"
#include "synth/animate/printed.h"
#include "synth/judging/critic.h"
#include "synth/takes/takes_sheet.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/judging/verdict_report.h"
#include "tools/query/credits.h"
#include "tools/synth/animate_command.h"
#include "tools/synth/animate_run.h"
#include "tools/synth/takes_run.h"

namespace freshet::tools {
namespace {

/// Whose flames are shown, and what speaks against them.
void say_forms(const store::Snapshot& snapshot, const synth::animate::AnimateReport& report) {
  if (report.by_itself)
    say("a fire: its own flames move as light, over the ground, which stands. --method carried moves all of "
        "the matte");
  if (report.tongues > 0)
    say(fmt::format("flames of one tongue: {}, which sway in one piece as that of {}", report.tongues,
                    snapshot.clip(report.sways_as).name));
  for (const synth::animate::ShownForm& form : report.forms)
    say(fmt::format("forms of {} from frame {} on, fit {:.2f}", snapshot.clip(form.clip).name, form.first,
                    form.fit));
  if (!report.forms_lack.empty())
    say(fmt::format("the forms may not suit the picture: {}. --method carried does without",
                    report.forms_lack));
}

/// With what is needed to credit a clip, as an assignment names it.
nlohmann::json forms_json(const store::Snapshot& snapshot, const synth::animate::AnimateReport& report) {
  nlohmann::json forms = nlohmann::json::array();
  for (const synth::animate::ShownForm& form : report.forms) {
    const store::ClipRecord& clip = snapshot.clip(form.clip);
    forms.push_back({{"clip", clip.name},
                     {"class", clip.class_name},
                     {"licence", clip.licence},
                     {"source_hash", clip.source_hash},
                     {"first_frame", form.first},
                     {"fit", form.fit}});
  }
  return forms;
}

void say_made(const synth::animate::AnimateReport& report, const AnimateInputs& inputs) {
  const int frames = inputs.options.until - inputs.options.from;
  say(fmt::format(
      "{} frames of {} x {} from {} pieces of {} clips in {:.1f} s, {:.1f} frames/s (decode {:.1f}, blend "
      "{:.1f}, base {:.1f}, match {:.1f}, render and write {:.1f})",
      frames, inputs.loaded.picture.cols, inputs.loaded.picture.rows, report.pieces, report.clips,
      report.total_s, frames / report.total_s, report.decode_s, report.blend_s, report.base_s,
      report.appearance_s, report.render_s));
  if (report.half_life_s > 0)
    say(
        fmt::format("{:.0f} % of the detail comes anew in each frame (--renewal), half of all after {:.2f} s "
                    "(--detail-life)",
                    100 * report.renewed, report.half_life_s));
}

/// For a program, or the names of the files alone.
void print_made(const AnimateCommand& command, const store::Snapshot& snapshot, const AnimateInputs& inputs,
                const ChosenPatches& chosen, const synth::animate::AnimateReport& report,
                const nlohmann::json& verdict, const nlohmann::json& takes) {
  std::vector<std::string> files = command.output.files();
  files.push_back(command.sheet);
  files.push_back(command.credits);
  for (const std::string& path : command.motion.outputs()) files.push_back(path);
  std::erase(files, "");
  if (!command.json) {
    for (const std::string& path : files) fmt::print("{}\n", path);
    return;
  }
  fmt::print("{}\n",
             nlohmann::json{{"files", files},
                            {"frames", inputs.options.frames},
                            {"width", inputs.loaded.picture.cols},
                            {"height", inputs.loaded.picture.rows},
                            {"fps", inputs.options.fps},
                            {"method", report.method},
                            {"by_itself", report.by_itself},
                            {"flames", report.flames},
                            {"forms", forms_json(snapshot, report)},
                            {"forms_fit", report.forms_fit},
                            {"forms_lack", report.forms_lack},
                            {"tongues", report.tongues},
                            {"sways_as", report.tongues > 0 ? snapshot.clip(report.sways_as).name : ""},
                            {"pieces", report.pieces},
                            {"clips", report.clips},
                            {"batches", report.batches},
                            {"half_life_s", report.half_life_s},
                            {"renewed", report.renewed},
                            {"labelling", chosen.labelled},
                            {"shares", shares_json(chosen.assignment)},
                            {"looks_like", to_json(chosen.kind)},
                            {"verdict", verdict},
                            {"takes", takes},
                            {"seconds",
                             {{"decode", report.decode_s},
                              {"blend", report.blend_s},
                              {"base", report.base_s},
                              {"match", report.appearance_s},
                              {"render", report.render_s},
                              {"total", report.total_s}}}}
                 .dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

/// Says what was assumed and what looks worst; the whole verdict for a program. Null for a film too short, or too
/// faint a matte, to judge.
nlohmann::json judged(const AnimateInputs& inputs, const query::ShownKind& kind,
                      const synth::judging::Evidence& film) {
  if (film.count() < synth::judging::kFewestFrames || cv::countNonZero(film.fluid()) == 0) return nullptr;
  const query::MotionGuide& asked = inputs.asked.guide;
  const Assumed assumed{.kind = kind,
                        .direction_asked = !asked.direction.empty(),
                        .speed_asked = !asked.speed.empty(),
                        .holds = !inputs.options.outline.held.empty()};
  const synth::judging::Verdict verdict =
      synth::judging::judge(film, assumed.kind.name, {.direction = asked.direction, .speed = asked.speed});
  say(take_words(assumed, verdict, film));
  return verdict_json(verdict, film, assumed.kind.name);
}

void run_animate(AnimateCommand& command, const RunContext& context) {
  plan_stages(command.stages());
  const store::Snapshot snapshot = command.target.open_store(context);
  AnimateInputs inputs = read_inputs(command);
  const TargetFiles::Loaded& loaded = inputs.loaded;
  synth::animate::AnimateOptions& options = inputs.options;
  // The output first: a mistyped folder should not cost a labelling.
  command.motion.check_outputs();
  check_picture_output(command.sheet);
  check_output_folder(command.credits);
  const std::unique_ptr<AnimationFiles> output = command.output.open(loaded, options);

  const auto cache = command.cache.open();
  const ChosenPatches chosen = choose_patches(
      command, snapshot, loaded, inputs.asked,
      [&](const SearchOptions& search) { return open_with_progress(snapshot, search, cache != nullptr); },
      cache.get(), context);
  const query::Assignment& assignment = chosen.assignment;
  const query::ShownKind kind =
      query::shown_kind(command.search.options().class_name, chosen.kind, assignment);
  pace_it(snapshot, inputs, assignment, kind.name);
  const std::optional<synth::takes::Trial> trial =
      command.takes > 1
          ? choose_take(snapshot, inputs, assignment, kind.name, command.takes, command.open, context)
          : std::nullopt;
  const synth::animate::Staging staging = stage(snapshot, inputs, assignment);
  const cv::Mat motion = command.motion.needs_motion(inputs.asked)
                             ? synth::animate::motion_field(snapshot, stored::settings_of(snapshot),
                                                            staging.placement, loaded.picture.size())
                             : cv::Mat();
  command.motion.draw(loaded, inputs.asked, motion);
  command.motion.write_maps(loaded, motion);

  output->skip_to_range();
  synth::animate::FrameSheet sheet(loaded.picture, loaded.matte, options.until - options.from,
                                   {.fps = options.fps,
                                    .first_number = command.output.first_number(),
                                    .first = options.from,
                                    .shown = 8,
                                    .width_px = 480});
  synth::judging::Evidence film(loaded.picture, loaded.matte, options.fps);
  Progress progress;
  const synth::animate::AnimateReport report = render(
      snapshot, inputs, staging, output->picture(),
      [&](const cv::Mat& frame) {
        const cv::Mat shown = output->write(frame);
        sheet.add(shown);
        film.add(shown);
      },
      progress.callback(), context);
  output->finish();
  progress.finish();
  if (!command.credits.empty()) {
    std::vector<store::ClipId> forms;
    for (const synth::animate::ShownForm& form : report.forms) forms.push_back(form.clip);
    write_credits(command.credits, credits_of(snapshot, assignment, forms));
  }
  if (!command.sheet.empty())
    media::write_picture(command.sheet,
                         trial ? synth::takes::with_takes(sheet.draw(), *trial) : sheet.draw());
  say_forms(snapshot, report);
  say_made(report, inputs);
  print_made(command, snapshot, inputs, chosen, report, judged(inputs, kind, film), takes_json(trial));
}

/// Options that an assignment leaves nothing to do.
void say_unused(const CLI::App& given, const std::string& assignment) {
  CLI::App searching;
  AnimateCommand options;
  options.add_search_to(searching);
  for (const CLI::Option* option : searching.get_options())
    if (const std::string name = option->get_name(); given.count(name) > 0)
      say(fmt::format("{} has no effect: {} says which patches are used", name, assignment));
}

}  // namespace

void animate_layer(const AnimateRequest& request, const std::function<void(const cv::Mat&)>& sink,
                   const std::function<void(const cv::Mat&)>& motion, const RunContext& context) {
  AnimateCommand command;
  CLI::App app("options of freshet synth animate", "options");
  command.add_making_to(app);
  try {
    app.parse(std::vector<std::string>(request.words.rbegin(), request.words.rend()));
  } catch (const CLI::ParseError& fault) {
    throw Error(ErrorKind::kUsage, request.where, fmt::format("options: {}", fault.what()),
                "freshet synth animate --help-all explains those that there are, but for files and length");
  }
  command.target.store = request.store;
  command.duration = {.frames = request.frames, .fps = request.fps};
  const store::Snapshot snapshot = store::Store::open_read(request.store).snapshot();
  const std::unique_ptr<cache::ResultCache> cache = command.cache.open();
  AnimateInputs inputs{.loaded = request.loaded,
                       .options = command.rendering(),
                       .asked = command.motion.read(request.loaded, command.search, command.hint_search()),
                       .playing = command.play.read(request.loaded.picture.size()),
                       .pace = command.play.pace()};
  inputs.options.loop = request.loop;
  inputs.options.form = synth::animate::FrameForm::kFluid;
  inputs.options.motion_sink = motion;
  command.outline.apply(inputs.options, request.loaded.picture.size());
  if (!request.strokes.empty() && inputs.asked.strokes.empty()) {
    const hints::StrokeField field =
        hints::interpolate(request.strokes, request.loaded.picture.size(), request.where,
                           {.horizon = inputs.asked.guide.horizon});
    inputs.asked.guide.direction = field.direction;
    inputs.asked.guide.speed = field.speed;
  }
  const ChosenPatches chosen = choose_patches(
      command, snapshot, request.loaded, inputs.asked,
      [&](const SearchOptions& search) { return open_with_progress(snapshot, search, cache != nullptr); },
      cache.get(), context);
  pace_it(snapshot, inputs, chosen.assignment,
          query::shown_kind(command.search.options().class_name, chosen.kind, chosen.assignment).name);
  render(snapshot, inputs, stage(snapshot, inputs, chosen.assignment), request.loaded.picture, sink, {},
         context);
}

void add_animate(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<AnimateCommand>();
  CLI::App* sub =
      synth_command.add_subcommand("animate", "Animate a still picture with the patches of a store");
  command->add_to(*sub);
  std::vector<PrintedValue> printed;
  for (const auto& [name, value, where] : synth::animate::printed_options())
    printed.push_back({std::string("--") + name, value, where});
  command->as_printed.add_to(*sub, "Okabe et al. 2011", std::move(printed))->group(in_detail("Rendering"));
  sub->callback([command, sub, &context] {
    if (!command->assignment.empty()) say_unused(*sub, command->assignment);
    command->as_printed.apply();
    command->open = open_of(*sub);
    run_animate(*command, context);
  });
}

}  // namespace freshet::tools
