#include "tools/tour/tour_tool.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/exr_picture.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "platform/stopwatch.h"
#include "platform/text.h"
#include "synth/animate/frame_sheet.h"
#include "synth/tour/tour.h"
#include "tools/console/numbers.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/options/output_options.h"

namespace freshet::tools {
namespace {

namespace tour = synth::tour;

struct TourCommand {
  std::filesystem::path film, plan;
  std::string move, size, film_end = "repeat", depth_out, draw, sheet;
  double fps = 0;
  int frames = 0, memory_mb = 1000;
  std::optional<double> horizon, amount;
  bool print_keys = false, json = false;
  OutputOptions output;
};

/// The file, and what the command line says above it.
tour::TourPlan plan_of(const TourCommand& command) {
  tour::TourPlan plan = command.plan.empty() ? tour::TourPlan{} : tour::read_tour(command.plan);
  tour::change(plan, command.move, command.amount, command.horizon);
  return plan;
}

tour::TourOptions options_of(const TourCommand& command) {
  tour::TourOptions options;
  options.frames = command.frames;
  options.fps = command.fps;
  if (!command.size.empty()) options.size = parse_size(command.size);
  options.film_end = tour::parse_film_end(command.film_end);
  options.memory_bytes = static_cast<std::size_t>(command.memory_mb) << 20;
  return options;
}

void check_depth_name(const TourCommand& command) {
  if (command.depth_out.empty()) return;
  if (!media::is_pattern(command.depth_out) || lower_ending(command.depth_out) != ".exr")
    throw Error(ErrorKind::kUsage, "--depth-out " + command.depth_out, "it is no numbered sequence of .exr",
                "For example --depth-out depth/%05d.exr");
}

nlohmann::json report_json(const tour::Tour& made, const std::vector<std::string>& files, double stage_s,
                           double render_s) {
  nlohmann::json keys = nlohmann::json::array();
  for (const tour::PathKey& key : made.path().keys())
    keys.push_back({{"time", key.time_s},
                    {"position", {key.place.position[0], key.place.position[1], key.place.position[2]}},
                    {"look", {key.place.yaw_deg, key.place.pitch_deg}},
                    {"view", key.place.view_deg}});
  return {{"files", files},
          {"frames", made.frames()},
          {"fps", made.fps()},
          {"width", made.size().width},
          {"height", made.size().height},
          {"focal_px", made.room().focal_px()},
          {"vanishing", {made.room().mesh().vanishing.x, made.room().mesh().vanishing.y}},
          {"nearest_floor", made.room().nearest_floor()},
          {"narrowed", made.narrowed().share},
          {"beyond", made.beyond_share()},
          {"keys", keys},
          {"seconds", {{"stage", stage_s}, {"render", render_s}}}};
}

void run_tour(TourCommand& command, const RunContext& context) {
  if (command.print_keys) {
    fmt::print("{}", tour::tour_keys());
    return;
  }
  if (command.film.empty()) throw CLI::RequiredError("FILM");
  plan_stages({{"tour", "rendering"}});
  check_depth_name(command);
  check_picture_output(command.draw);
  check_picture_output(command.sheet);
  const bool renders = !command.output.name().empty() || command.draw.empty();
  if (renders && command.output.name().empty()) throw CLI::RequiredError("--output");
  Stopwatch watch;
  tour::Tour made(command.film, plan_of(command), options_of(command), context.stop);
  for (const std::string& notice : made.notices()) say(command.film.string() + ": " + notice);
  const double stage_s = watch.lap();
  if (!command.draw.empty()) media::write_picture(command.draw, made.drawn());
  if (!renders) {
    fmt::print("{}\n", command.draw);
    return;
  }

  synth::animate::FrameOptions form;
  form.frames = made.frames();
  form.fps = made.fps();
  TargetFiles::Loaded loaded;
  loaded.picture = cv::Mat(made.size(), CV_8UC3, cv::Scalar::all(0));
  loaded.still.bgr = loaded.picture;
  if (made.deep()) loaded.still.deep = cv::Mat(made.size(), CV_16UC3, cv::Scalar::all(0));
  loaded.matte = cv::Mat(made.size(), CV_8U, cv::Scalar(255));
  const std::unique_ptr<AnimationFiles> output = command.output.open(loaded, form);
  const auto first_number = command.output.first_number();
  if (!command.depth_out.empty())
    check_frames_output(command.depth_out, {.first = first_number,
                                            .last = first_number + made.frames() - 1,
                                            .from = first_number + form.from,
                                            .to = first_number + form.until - 1});

  cv::Mat frame(made.size(), form.form == synth::animate::FrameForm::kFluid ? CV_32FC4 : CV_8UC3), depth;
  const int shown = form.until - form.from;
  std::optional<synth::animate::FrameSheet> sheet;
  Progress progress;
  output->skip_to_range();
  double render_s = 0;
  for (int i = 0; i < form.until; ++i) {
    if (context.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "tour", "stopped");
    if (i < form.from) {
      made.skip();
      continue;
    }
    const Stopwatch each;
    made.render(frame, command.depth_out.empty() ? nullptr : &depth);
    render_s += each.seconds();
    const cv::Mat seen = output->write(frame);
    if (!command.sheet.empty()) {
      if (!sheet)
        sheet.emplace(seen, loaded.matte, made.frames(),
                      synth::animate::SheetOptions{.fps = made.fps(),
                                                   .first_number = first_number,
                                                   .first = form.from,
                                                   .shown = 8,
                                                   .width_px = 480});
      sheet->add(seen);
    }
    if (!command.depth_out.empty())
      media::write_exr_depth(media::numbered(command.depth_out, first_number + i), depth);
    progress.show("tour", static_cast<std::size_t>(i + 1 - form.from), static_cast<std::size_t>(shown),
                  "frames");
  }
  output->finish();
  progress.finish();
  if (sheet) media::write_picture(command.sheet, sheet->draw());
  say(fmt::format("{} frames of {} x {}: staged in {:.1f} s, rendered at {:.0f} frames/s", shown,
                  made.size().width, made.size().height, stage_s, shown / std::max(1e-9, render_s)));
  std::vector<std::string> files = command.output.files();
  for (const std::string& file : {command.depth_out, command.draw, command.sheet})
    if (!file.empty()) files.push_back(file);
  if (command.json)
    fmt::print("{}\n", report_json(made, files, stage_s, render_s).dump(2));
  else
    for (const std::string& file : files) fmt::print("{}\n", file);
}

}  // namespace

void add_tour(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<TourCommand>();
  CLI::App* sub = synth_command.add_subcommand(
      "tour", "Move a camera through an animated picture, or a still (Horry et al. 1997)");
  sub->add_option("FILM", command->film, "A film that synth animate made, any other, or a still picture");
  sub->add_option("PATH", command->plan,
                  "Planes, things that stand upright, and the camera's path (.toml); see --keys");
  command->output.add_frames_to(*sub);
  sub->add_option(
         "--move", command->move,
         "A path without keys: in (ahead), pan (turn), truck (aside), rise, or orbit (around and back) [in]")
      ->check(CLI::IsMember(tour::move_names()));
  sub->add_option("--amount", command->amount, "How far the move goes: 2 twice as far, -1 the other way [1]")
      ->check(CLI::Range(-100.0, 100.0));
  sub->add_option("--horizon", command->horizon,
                  "Row of the horizon, px from above [the file's, or the middle]")
      ->check(CLI::Range(-100000.0, 100000.0));
  sub->add_option("--frames", command->frames, "Number of frames [the path's, or the film's, or 4 s]")
      ->check(CLI::Range(1, 1000000));
  sub->add_option("--fps", command->fps, "Frames per second [the film's, or 25]")
      ->check(CLI::Range(1.0, 240.0));
  sub->add_option("--size", command->size, "Size of the frames, px [the film's]")->type_name("WxH");
  sub->add_option(
         "--film-end", command->film_end,
         "Where the film is shorter than the tour: repeat (cross-faded where it does not come round), "
         "ping-pong (backwards and forwards), hold (its last frame stays)")
      ->check(CLI::IsMember({"repeat", "ping-pong", "hold"}))
      ->capture_default_str();
  sub->add_option("--memory", command->memory_mb, "Memory for the frames of a film that goes backwards, MB")
      ->check(CLI::Range(16, 1000000))
      ->capture_default_str();
  sub->add_option(
         "--depth-out", command->depth_out,
         "Also write the depth of each frame: depth/%05d.exr (channel Z, in heights of the camera above the "
         "floor; 1e10: the sky)")
      ->group("Output");
  sub->add_option("--draw", command->draw,
                  "Write the picture with its planes and things (PNG, JPEG); alone, nothing is rendered");
  sub->add_flag("--keys", command->print_keys, "Print what a tour file can say");
  sub->add_option("--sheet", command->sheet, "Write a contact sheet of frames (PNG, JPEG)");
  sub->add_flag("--json", command->json, "Print files, mesh, path and seconds as JSON");
  add_threads(*sub);
  sub->callback([command, &context] { run_tour(*command, context); });
}

}  // namespace freshet::tools
