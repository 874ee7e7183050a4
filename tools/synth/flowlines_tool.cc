// freshet synth flowlines: endless video from a short clip, along the lines that its fluid flows on.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "platform/stopwatch.h"
#include "store/store.h"
#include "synth/animate/frame_sheet.h"
#include "synth/flowlines/files/asked_lines.h"
#include "synth/flowlines/files/footage_files.h"
#include "synth/flowlines/files/line_drawing.h"
#include "synth/flowlines/files/line_files.h"
#include "synth/flowlines/flowlines.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/options/as_printed.h"
#include "tools/options/output_options.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
namespace flowlines = synth::flowlines;

struct FlowlinesCommand {
  std::string clip, store, stored_clip;
  flowlines::AskedLines asked;
  fs::path draw, lines_out, sheet;
  flowlines::FootageOptions footage;
  flowlines::FlowlinesOptions options;
  std::string dynamics = "auto", blend = "cut", correspondence = "equal", ground = "none", repeats = "varied";
  int frames = 500, memory_mb = 1200;
  double fps = 0;
  bool loop = false, json = false;
  OutputOptions output;
  AsPrinted as_printed;
};

flowlines::Footage read_clip(const FlowlinesCommand& command) {
  const bool stored = !command.store.empty() || !command.stored_clip.empty();
  if (stored == !command.clip.empty() || command.store.empty() != command.stored_clip.empty())
    throw Error(ErrorKind::kUsage, "synth flowlines",
                stored && !command.clip.empty() ? "two clips are given" : "nothing says which clip",
                "Give a video file, or --store STORE with --clip NAME");
  flowlines::FootageOptions options = command.footage;
  options.memory_bytes = static_cast<std::size_t>(command.memory_mb) << 20;
  flowlines::Footage footage =
      stored ? flowlines::read_footage(store::Store::open_read(command.store).snapshot(), command.stored_clip,
                                       options)
             : flowlines::read_footage(command.clip, options);
  for (const std::string& notice : footage.notices) say(footage.name + ": " + notice);
  return footage;
}

flowlines::FlowlinesOptions options_of(const FlowlinesCommand& command, const flowlines::Footage& footage) {
  flowlines::FlowlinesOptions options = command.options;
  options.dynamics = flowlines::parse_dynamics(command.dynamics);
  options.in_turn = command.repeats == "in-turn";
  options.mixing = flowlines::parse_mixing(command.blend);
  options.view.correspondence = flowlines::parse_correspondence(command.correspondence);
  options.view.ground = media::parse_ground(command.ground);
  if (command.loop) options.loop_frames = command.frames;
  std::vector<std::string> notices;
  flowlines::read_asked(command.asked, footage, options, notices);
  for (const std::string& notice : notices) say(notice);
  return options;
}

/// A frame in the form that the output asks for. alpha   CV_32F: what of it is fluid.
cv::Mat formed(const cv::Mat& frame, const cv::Mat& alpha, synth::animate::FrameForm form, bool alone) {
  if (form == synth::animate::FrameForm::kWhole) return frame;
  cv::Mat out(frame.size(), CV_32FC4);
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x) {
      const float covered = alone ? alpha.at<float>(y, x) : 1.0f;
      const cv::Vec3f colour = cv::Vec3f(frame.at<cv::Vec3b>(y, x)) * (covered / 255);
      out.at<cv::Vec4f>(y, x) = {colour[0], colour[1], colour[2], covered};
    }
  return out;
}

std::string summary(const flowlines::FlowlinesReport& report, double fps) {
  return fmt::format(
      "{} lines in {} stream{}, {} dynamics (speeds of their own explain {:.0f} % more); {} entries repeat, "
      "particles "
      "ride {:.1f} s{}; patch {:.0f} px",
      report.lines, report.streams, report.streams == 1 ? "" : "s",
      report.stationary ? "stationary" : "non-stationary", 100 * report.gain, report.entries,
      report.way / fps,
      report.cut_share > 0 ? fmt::format(", slower than {:.1f} px a frame ({:.0f} %) not to the end",
                                         report.floor_px, 100 * report.cut_share)
                           : "",
      report.patch_px);
}

nlohmann::json report_json(const flowlines::FlowlinesReport& report, const std::vector<std::string>& files,
                           double render_s) {
  return {{"files", files},
          {"lines", report.lines},
          {"edited", report.drawn},
          {"joining", report.interpolated},
          {"streams", report.streams},
          {"stationary", report.stationary},
          {"gain", report.gain},
          {"patch_px", report.patch_px},
          {"spacing_px", report.spacing_px},
          {"entries", report.entries},
          {"way_frames", report.way},
          {"floor_px", report.floor_px},
          {"cut_share", report.cut_share},
          {"jump_cost", report.jump_cost},
          {"seconds",
           {{"motion", report.motion_s},
            {"rides", report.ride_s},
            {"plan", report.plan_s},
            {"render", render_s}}}};
}

/// The output's files, open before the preparation: a mistyped folder should not cost it.
std::unique_ptr<AnimationFiles> open_output(FlowlinesCommand& command, const flowlines::Footage& footage,
                                            synth::animate::FrameOptions& options) {
  TargetFiles::Loaded loaded;
  loaded.picture = footage.frames.front();
  loaded.still.bgr = loaded.picture;
  loaded.matte = cv::Mat(footage.size(), CV_8U, cv::Scalar(255));
  return command.output.open(loaded, options);
}

void tell(const flowlines::Flowlines& engine, const flowlines::Footage& footage) {
  for (const std::string& notice : engine.report().notices) say(footage.name + ": " + notice);
  say(summary(engine.report(), footage.fps));
  if (engine.report().drawn > 0)
    say(fmt::format("{} edited lines, and {} that join them", engine.report().drawn,
                    engine.report().interpolated));
}

void write_lines(const FlowlinesCommand& command, const flowlines::Footage& footage,
                 const flowlines::Flowlines& engine, const std::vector<flowlines::FlowLine>& edited) {
  if (!command.draw.empty())
    media::write_picture(
        command.draw, flowlines::draw_lines(footage.frames.front(), engine.matte(), engine.lines(), edited));
  if (!command.lines_out.empty()) flowlines::write_lines(command.lines_out, engine.lines(), footage.size());
}

/// All frames, and the sheet of some. Returns the seconds that rendering took, writing apart.
double write_frames(const FlowlinesCommand& command, const flowlines::Footage& footage,
                    const synth::animate::FrameOptions& options, flowlines::Flowlines& engine,
                    AnimationFiles& output, RunContext& context) {
  synth::animate::FrameSheet sheet(
      footage.frames.front(), cv::Mat(footage.size(), CV_8U, cv::Scalar(255)), command.frames,
      {.fps = options.fps, .first_number = command.output.first_number(), .shown = 8, .width_px = 480});
  Progress progress;
  cv::Mat fluid = engine.fluid();
  double render_s = 0;
  for (int i = 0; i < command.frames; ++i) {
    if (context.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "flowlines", "stopped");
    progress.show("rendering", static_cast<std::size_t>(i), static_cast<std::size_t>(command.frames),
                  "frames");
    const Stopwatch watch;
    const cv::Mat& frame = engine.next();
    render_s += watch.seconds();
    if (!command.asked.edited.empty()) fluid = engine.fluid();
    if (options.matte_sink) options.matte_sink(fluid);
    sheet.add(output.write(formed(frame, fluid, options.form, command.output.fluid_alone())));
  }
  output.finish();
  progress.finish();
  if (!command.sheet.empty()) media::write_picture(command.sheet, sheet.draw());
  return render_s;
}

void run_flowlines(FlowlinesCommand& command, RunContext& context) {
  plan_stages(
      {{"measuring flow", ""}, {"following particles", ""}, {"planning repeats", ""}, {"rendering", ""}});
  check_picture_output(command.draw.string());
  check_output_folder(command.lines_out);
  check_picture_output(command.sheet.string());
  const flowlines::Footage footage = read_clip(command);
  synth::animate::FrameOptions frame_options;
  frame_options.frames = command.frames;
  frame_options.fps = command.fps > 0 ? command.fps : footage.fps;
  const std::unique_ptr<AnimationFiles> output = open_output(command, footage, frame_options);

  Progress progress;
  flowlines::FlowlinesOptions options = options_of(command, footage);
  options.fps = frame_options.fps;
  flowlines::Flowlines engine(footage, options, {progress.callback(), context.stop});
  progress.finish();
  tell(engine, footage);
  write_lines(command, footage, engine, options.edited);
  const double render_s = write_frames(command, footage, frame_options, engine, *output, context);

  const flowlines::FlowlinesReport& report = engine.report();
  say(fmt::format("{} frames of {} x {} from {}: prepared in {:.1f} s, rendered at {:.0f} frames/s",
                  command.frames, footage.size().width, footage.size().height, footage.count(),
                  report.motion_s + report.ride_s + report.plan_s,
                  command.frames / std::max(1e-9, render_s)));
  std::vector<std::string> files = command.output.files();
  for (const fs::path& path : {command.draw, command.lines_out, command.sheet})
    if (!path.empty()) files.push_back(path.string());
  if (command.json)
    fmt::print("{}\n", report_json(report, files, render_s).dump(2));
  else
    for (const std::string& path : files) fmt::print("{}\n", path);
}

void add_clip(CLI::App& sub, FlowlinesCommand& command) {
  sub.add_option("CLIP", command.clip, "The clip: a video file, a folder or a pattern of pictures");
  sub.add_option("--store", command.store, "Store that holds the clip, instead of CLIP [none]");
  sub.add_option("--clip", command.stored_clip, "Name of the clip in --store");
  sub.add_option("--from", command.footage.from, "First frame to use")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  sub.add_option("--input-frames", command.footage.frames, "Number of frames to use [all that fit]")
      ->check(CLI::Range(16, 100000));
  sub.add_option("--memory", command.memory_mb, "Memory for the clip's frames, MB (3 bytes a pixel)")
      ->check(CLI::Range(16, 1000000))
      ->capture_default_str();
  sub.add_option("--frames", command.frames, "Frames of the output")
      ->check(CLI::Range(1, 10000000))
      ->capture_default_str();
  sub.add_option("--fps", command.fps, "Frames per second of the output [the clip's]")
      ->check(CLI::Range(1.0, 240.0));
  sub.add_flag("--loop", command.loop, "Seamless loop [off]");
}

void add_lines(CLI::App& sub, FlowlinesCommand& command) {
  const std::string lines = "Lines";
  sub.add_option("--lines", command.asked.lines,
                 "Flow lines as SVG, drawn over the clip in the direction of the flow [from the clip]")
      ->group(lines);
  sub.add_option("--matte", command.asked.matte,
                 "Grey picture, white where lines are allowed [where the clip moves]")
      ->group(lines);
  sub.add_option("--spacing", command.options.spacing_px, "Distance between lines, px [half a patch]")
      ->check(CLI::Range(2.0, 1000.0))
      ->group(lines);
  sub.add_option("--draw", command.draw,
                 "Write a picture of the clip with its lines and the edited ones (PNG, JPEG)")
      ->group(lines);
  sub.add_option("--lines-out", command.lines_out, "Write the lines as SVG, for editing")->group(lines);
}

void add_editing(CLI::App& sub, FlowlinesCommand& command) {
  const std::string editing = "Editing";
  sub.add_option("--edited", command.asked.edited,
                 "New paths of the fluid: SVG lines with the ids of the input lines whose texture they show "
                 "(fall, or fall-2 for a second copy). Input lines without one are removed. data-speed sets "
                 "a speed factor, data-time the time of a position, s [as in the clip]")
      ->group(editing);
  sub.add_option("--correspondence", command.correspondence,
                 "equal (texture keeps its size) or stretched (the whole input line maps to the edited one)")
      ->check(CLI::IsMember({"equal", "stretched"}))
      ->capture_default_str()
      ->group(editing);
  sub.add_option("--join", command.options.join_px,
                 "Maximum distance at which neighbouring edited lines are joined by interpolated ones, px "
                 "[from their input lines]")
      ->check(CLI::Range(1.0, 100000.0))
      ->group(editing);
  sub.add_option("--ground", command.ground,
                 "Background that makes the fluid transparent: black (fire), white (smoke), or none (opaque)")
      ->check(CLI::IsMember(media::ground_names()))
      ->capture_default_str()
      ->group(editing);
  sub.add_option("--background", command.asked.background,
                 "Picture of what lies behind removed fluid [guessed]")
      ->group(editing);
  sub.add_flag("--on-background", command.options.view.on_background,
               "Show the edited fluid over the background alone [off]")
      ->group(editing);
}

void add_particles(CLI::App& sub, FlowlinesCommand& command) {
  const std::string particles = "Particles";
  sub.add_option("--patch", command.options.patch_px,
                 "Side of a particle's texture, px; larger for flames: 100 in a clip 320 px wide [24 in a "
                 "clip of 320 px, in proportion]")
      ->check(CLI::Range(4.0, 1000.0))
      ->group(particles);
  sub.add_option(
         "--dynamics", command.dynamics,
         "stationary (one speed for each place), non-stationary (one for each particle), or auto (measured)")
      ->check(CLI::IsMember({"auto", "stationary", "non-stationary"}))
      ->capture_default_str()
      ->group(particles);
  sub.add_option("--entries", command.options.entries,
                 "Number of frames whose particles repeat (K) [chosen for the smallest discontinuity]")
      ->check(CLI::Range(8, 100000))
      ->group(particles);
  sub.add_option(
         "--repeats", command.repeats,
         "Order of the repeats: varied, or in-turn (all K frames' particles again and again, as printed)")
      ->check(CLI::IsMember({"varied", "in-turn"}))
      ->capture_default_str()
      ->group(particles);
  sub.add_option("--strand", command.options.strand_px,
                 "Width of independently repeating strands, px; 0: one order for all [3 patches]")
      ->check(CLI::Range(0.0, 100000.0))
      ->group(particles);
  sub.add_option("--blend", command.blend,
                 "How two repeats meet: feather (averages, as printed), contrast (restores their fine "
                 "detail), or cut (seam where they are most alike)")
      ->check(CLI::IsMember({"feather", "contrast", "cut"}))
      ->capture_default_str()
      ->group(particles);
  sub.add_option("--seed", command.options.seed, "Seed of the order of repeats")
      ->capture_default_str()
      ->group(particles);
}

}  // namespace

void add_flowlines(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<FlowlinesCommand>();
  CLI::App* sub = synth_command.add_subcommand("flowlines",
                                               "Extend a short clip of flowing water, fire or smoke to any "
                                               "length, or redirect its fluid (Bhat et al. 2004)");
  add_clip(*sub, *command);
  command->output.add_fluid_to(*sub);
  add_lines(*sub, *command);
  add_editing(*sub, *command);
  add_particles(*sub, *command);
  sub->add_flag("--moving-camera", command->options.moving_camera, "Accept a moving camera [off]");
  sub->add_option("--sheet", command->sheet, "Write a contact sheet of frames (PNG, JPEG)");
  sub->add_flag("--json", command->json, "Print lines, repeats and seconds by stage as JSON");
  add_threads(*sub);
  // Spacing, texture size, dynamics and correspondence are the artist's.
  command->as_printed.add_to(*sub, "Bhat et al. 2004",
                             {{"--blend", "feather", "Sec. 3"},
                              {"--repeats", "in-turn", "Sec. 3, Fig. 3"},
                              {"--strand", "0", "Sec. 3"},
                              {"--ground", "none", "Sec. 6"}});
  sub->callback([command, &context] {
    command->as_printed.apply();
    if (command->as_printed.asked() && command->asked.lines.empty())
      throw Error(ErrorKind::kUsage, "--as-printed", "an artist draws the paper's lines, and there are none",
                  "Give --lines; --lines-out writes those that are found, to be edited");
    run_flowlines(*command, context);
  });
}

}  // namespace freshet::tools
