#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/motion_file.h"
#include "media/picture/picture_sequence.h"
#include "media/video/picture_sink.h"
#include "synth/simulate/design/scene_file.h"
#include "synth/simulate/simulate.h"
#include "tools/commands.h"
#include "tools/console/numbers.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/synth/design_folder.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
namespace sim = synth::simulate;

struct SimulateCommand {
  std::string scene, out, alpha, emitters, print_scene;
  std::vector<std::string> motion;
  bool print_keys = false;
  // What the command line says stands above the scene.
  std::optional<cv::Size> size;
  std::optional<int> frames, rows, steps;
  std::optional<double> fps;
  std::optional<std::uint64_t> seed;
  int alpha_bits = 8;
};

std::string text_of(const std::string& scene) {
  if (!sim::names_scene_file(scene)) return sim::preset_scene(scene);
  return sim::scene_text(scene);
}

sim::SceneOptions scene_of(const SimulateCommand& command) {
  sim::SceneOptions scene = sim::named_scene(command.scene);
  if ((command.rows || command.steps) && scene.kind != sim::SceneKind::kDesign)
    throw Error(ErrorKind::kUsage, "--grid, --steps", "the ready-made clips choose their own",
                "Leave them out, or take a design such as plume");
  scene.size = command.size.value_or(scene.size);
  scene.frames = command.frames.value_or(scene.frames);
  scene.fps = command.fps.value_or(scene.fps);
  scene.seed = command.seed.value_or(scene.seed);
  scene.design.rows = command.rows.value_or(scene.design.rows);
  scene.design.steps = command.steps.value_or(scene.design.steps);
  scene.alpha_bits = command.alpha_bits;
  sim::check(scene);
  return scene;
}

void check_pattern(const char* option, const std::string& name) {
  if (!name.empty() && !media::is_pattern(name))
    throw Error(ErrorKind::kUsage, fmt::format("{} {}", option, name),
                "a numbered sequence is needed, one file per frame",
                fmt::format("For example {} {}/%05d{}", option, option + 2,
                            std::string(option) == "--motion" ? ".flo" : ".png"));
}

/// Names without an ending are folders.
bool names_a_folder(const fs::path& out) { return !out.has_extension() && !media::is_pattern(out); }

void run_simulate(const SimulateCommand& command, const RunContext& context) {
  if (command.print_keys) {
    fmt::print("{}", sim::scene_keys());
    return;
  }
  if (!command.print_scene.empty()) {
    fmt::print("{}", sim::preset_scene(command.print_scene));
    return;
  }
  if (command.scene.empty()) throw CLI::RequiredError("SCENE");
  if (command.out.empty()) throw CLI::RequiredError("--output");
  const sim::SceneOptions scene = scene_of(command);
  for (const std::string& pattern : command.motion) {
    check_pattern("--motion", pattern);
    if (!media::looks_like_motion(pattern))
      throw Error(ErrorKind::kUsage, "--motion " + pattern, "its ending names no format of motion",
                  "Give .flo or .exr");
  }
  check_pattern("--emitters", command.emitters);
  if (!names_a_folder(command.out)) check_frames_output(command.out, scene.frames);
  check_frames_output(command.alpha, scene.frames);
  check_frames_output(command.emitters, scene.frames);
  for (const std::string& pattern : command.motion) check_frames_output(pattern, scene.frames);
  std::optional<DesignFolder> folder;
  if (names_a_folder(command.out)) check_folder_output(command.out);
  if (names_a_folder(command.out)) folder.emplace(command.out, scene, text_of(command.scene));
  media::PictureSink sink(folder ? folder->preview() : fs::path(command.out), scene.size, scene.frames,
                          scene.fps);
  const bool deep = scene.alpha_bits == 16 && !command.alpha.empty();
  if (deep) check_pattern("--alpha", command.alpha);
  std::optional<media::PictureSink> alpha;
  if (!command.alpha.empty() && !deep) alpha.emplace(command.alpha, scene.size, scene.frames, scene.fps);

  if (!folder) say_size(command.out, scene.size);
  say_size(command.alpha, scene.size);

  sim::Simulation simulation(scene);
  sim::SimulatedFrame frame;
  cv::Mat alpha_picture;
  Progress progress;
  for (int i = 0; simulation.next(frame); ++i) {
    if (context.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "simulate", "stopped");
    sink.write(frame.picture);
    if (folder) folder->write(i, frame);
    if (alpha) {
      cv::merge(std::vector<cv::Mat>(3, frame.alpha), alpha_picture);
      alpha->write(alpha_picture);
    }
    if (deep) write_grey(command.alpha, i, frame.alpha);
    if (!command.emitters.empty()) write_grey(command.emitters, i, frame.emitters);
    for (const std::string& pattern : command.motion)
      media::write_motion(media::numbered(pattern, i), frame.motion);
    progress.show(command.scene, static_cast<std::size_t>(i + 1), static_cast<std::size_t>(scene.frames),
                  "frames");
  }
  sink.finish();
  if (alpha) alpha->finish();
  if (folder) folder->finish();
  progress.finish();
  std::vector<std::string> outputs{command.out, command.alpha, command.emitters};
  outputs.insert(outputs.end(), command.motion.begin(), command.motion.end());
  for (const std::string& path : outputs)
    if (!path.empty()) fmt::print("{}\n", path);
}

std::string help_of_scenes() {
  std::string text = "\nScenes:\n";
  for (const sim::PresetScene& each : sim::preset_scenes())
    text += fmt::format("  {:<16}{}\n", each.name, each.summary);
  return text + R"(
The first five are designs: emitters, obstacles and forces that a scene file says. To make your own:
  freshet synth simulate --print-scene plume > mine.toml    then edit it; --keys explains every key
  freshet synth simulate mine.toml -o mine

Flow t belongs to frame t: what lies at p in frame t lies at p + flow in frame t + 1, in px of the picture.
In .flo x is right and y down. In .exr (half floats, channels forward.u and forward.v) y is up, as compositors
have it. All sequences are numbered from 0.
)";
}

}  // namespace

void add_simulate(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<SimulateCommand>();
  CLI::App* sub =
      synth_command.add_subcommand("simulate", "Design a fluid's motion, or render a simulated clip");
  sub->footer(help_of_scenes());
  sub->add_option("SCENE", command->scene, "A preset (see below), or a scene file (.toml)");
  sub->add_option(
      "-o,--output", command->out,
      "A folder (a name without an ending) for alpha/, flow/, emitters/ and preview.mp4; or the "
      "preview or clip alone: .mkv (lossless), .mp4, ..., a sequence, one picture with --frames 1");
  sub->add_option("--print-scene", command->print_scene, "Print a preset as a scene file, to be edited")
      ->type_name("PRESET");
  sub->add_flag("--keys", command->print_keys, "Print what a scene file can say");
  sub->add_option_function<std::string>(
         "--size", [command](const std::string& text) { command->size = parse_size(text); }, "Size, px")
      ->type_name("WxH")
      ->default_str("[the scene's]");
  const auto override = [&](const char* name, auto& value, const char* help) {
    return sub->add_option(name, value, help)->default_str("[the scene's]");
  };
  override("--frames", command->frames, "Frames")->check(CLI::Range(1, 100000));
  override("--fps", command->fps, "Frames per second")->check(CLI::Range(1.0, 240.0));
  override("--seed", command->seed, "Another seed, another scene of the same kind");
  override("--grid", command->rows, "Cells of a design's simulation along the height, apart from the size")
      ->check(CLI::Range(16, 2048));
  override("--steps", command->steps, "Steps of a design's simulation per frame")->check(CLI::Range(1, 32));
  sub->add_option("--alpha", command->alpha, "Also write how much of each pixel the fluid covers, in grey");
  sub->add_option("--alpha-bits", command->alpha_bits, "Bits of a design's alpha, 8 or 16")
      ->check(CLI::IsMember({8, 16}))
      ->capture_default_str();
  sub->add_option(
      "--motion", command->motion,
      "Also write motion fields: motion/%05d.flo (Middlebury) or motion/%05d.exr; may be given twice");
  sub->add_option("--emitters", command->emitters,
                  "Also write where a design's emitters held fluid: emitters/%05d.png");
  add_overwrite(*sub);
  add_threads(*sub);
  sub->callback([command, &context] { run_simulate(*command, context); });
}

}  // namespace freshet::tools
