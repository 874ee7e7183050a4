// freshet synth scene: a picture's layers, all moved by one wind.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "platform/stopwatch.h"
#include "synth/animate/frame_sheet.h"
#include "synth/matte/marks.h"
#include "synth/matte/matte.h"
#include "synth/scene/rendering/scene_animation.h"
#include "synth/scene/rendering/stand_in_cut.h"
#include "synth/scene/scene_file.h"
#include "synth/scene/scene_marks.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/options/output_options.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
namespace scene = synth::scene;

struct SceneCommand {
  std::string file, init, sheet;
  OutputOptions output;
  bool print_keys = false, json = false;
};

void say_all(const std::vector<std::string>& notices) {
  for (const std::string& notice : notices) say(notice);
}

/// Leaves a scene to start from.
void write_first_scene(const SceneCommand& command) {
  const fs::path out = command.output.name();
  if (out.empty()) throw CLI::RequiredError("--output");
  if (out.extension() != ".toml")
    throw Error(ErrorKind::kUsage, out.string(), "a scene is a TOML file", "Name it SCENE.toml");
  check_output_folder(out);
  const media::Picture picture = media::read_picture(command.init);
  const fs::path folder = fs::absolute(out).parent_path();
  std::ofstream file(out);
  file << scene::first_scene(fs::relative(fs::absolute(command.init), folder).generic_string(),
                             picture.bgr.size());
  file.close();
  if (!file)
    throw Error(ErrorKind::kIo, out.string(), "it cannot be written", "Check the folder and its free space");
  fmt::print("{}\n", out.string());
}

cv::Mat matte_of(const scene::Scene& asked, const scene::SceneLayer& layer, const cv::Mat& picture) {
  using Kind = scene::MatteFrom::Kind;
  std::vector<std::string> notices;
  cv::Mat alpha;
  switch (layer.matte.kind) {
    case Kind::kRest:
      break;
    case Kind::kScribbles: {
      const synth::matte::Marks marks = synth::matte::read_scribbles(layer.matte.file, picture, &notices);
      alpha = synth::matte::make_matte(picture, marks, {}, layer.matte.file.string()).alpha;
      break;
    }
    default: {
      const media::Matte matte = media::read_matte(layer.matte.file, picture.size());
      notices = matte.notices;
      alpha = matte.alpha;
    }
  }
  static_cast<void>(asked);
  for (const std::string& notice : notices) say(layer.matte.file.string() + ": " + notice);
  return alpha;
}

void run_scene(SceneCommand& command, const RunContext& context) {
  if (command.print_keys) {
    fmt::print("{}", scene::scene_keys());
    return;
  }
  if (!command.init.empty()) {
    write_first_scene(command);
    return;
  }
  if (command.file.empty()) throw CLI::RequiredError("SCENE");
  plan_stages({{"cut", "cutting layers"}, {"render", "rendering"}});
  scene::Scene asked = scene::read_scene(command.file);
  TargetFiles::Loaded loaded{.picture = {}, .matte = {}, .still = media::read_still(asked.picture)};
  for (const std::string& notice : loaded.still.notices) say(asked.picture.string() + ": " + notice);
  loaded.picture = loaded.still.bgr;
  loaded.matte = cv::Mat(loaded.picture.size(), CV_8U, cv::Scalar(255));
  std::vector<std::string> notices;
  scene::read_marks(asked, loaded.picture.size(), &notices);

  synth::animate::AnimateOptions form;
  form.frames = asked.frames;
  form.fps = asked.fps;
  check_picture_output(command.sheet);
  const std::unique_ptr<AnimationFiles> output = command.output.open(loaded, form);

  Stopwatch watch;
  std::vector<cv::Mat> mattes;
  for (const scene::SceneLayer& layer : asked.layers)
    mattes.push_back(layer.is_cut() ? matte_of(asked, layer, loaded.picture) : cv::Mat());
  const std::vector<scene::LayerPixels> pixels =
      scene::stand_in_cut(media::coded_picture(loaded.still), mattes, asked);
  const double cut_s = watch.lap();
  scene::SceneAnimation animation(asked, pixels, loaded.picture.size(), {}, &notices);
  say_all(notices);
  const double stage_s = watch.lap();

  synth::animate::FrameSheet sheet(
      loaded.picture, loaded.matte, asked.frames,
      {.fps = asked.fps, .first_number = command.output.first_number(), .shown = 8, .width_px = 480});
  const bool deep = form.form == synth::animate::FrameForm::kFluid;
  cv::Mat frame(loaded.picture.size(), deep ? CV_32FC4 : CV_8UC3);
  Progress progress;
  for (int i = 0; i < asked.frames && i < form.until; ++i) {
    if (context.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "scene", "stopped");
    animation.render(i, frame);
    sheet.add(output->write(frame));
    progress.show("render", static_cast<std::size_t>(i + 1), static_cast<std::size_t>(asked.frames),
                  "frames");
  }
  output->finish();
  progress.finish();
  if (!command.sheet.empty()) media::write_picture(command.sheet, sheet.draw());
  const double render_s = watch.lap();
  const scene::SceneSeconds& seconds = animation.seconds();
  say(
      fmt::format("{} frames of {} x {} from {} layers in {:.1f} s (cut {:.1f}, stage {:.1f}; motion {:.1f}, "
                  "composite {:.1f}, "
                  "layers' own frames {:.1f}, write {:.1f}); sprites {:.0f} MB",
                  asked.frames, frame.cols, frame.rows, asked.layers.size(), cut_s + stage_s + render_s,
                  cut_s, stage_s, seconds.motion, seconds.composite, seconds.frames,
                  render_s - seconds.motion - seconds.composite - seconds.frames,
                  1e-6 * static_cast<double>(animation.bytes())));
  std::vector<std::string> files = command.output.files();
  if (!command.sheet.empty()) files.push_back(command.sheet);
  if (!command.json) {
    for (const std::string& path : files) fmt::print("{}\n", path);
    return;
  }
  fmt::print("{}\n", nlohmann::json{{"files", files},
                                    {"frames", asked.frames},
                                    {"layers", asked.layers.size()},
                                    {"width", frame.cols},
                                    {"height", frame.rows},
                                    {"fps", asked.fps},
                                    {"seconds",
                                     {{"cut", cut_s},
                                      {"stage", stage_s},
                                      {"motion", seconds.motion},
                                      {"composite", seconds.composite},
                                      {"layers", seconds.frames},
                                      {"render", render_s}}}}
                         .dump(2));
}

}  // namespace

void add_scene(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<SceneCommand>();
  CLI::App* sub = synth_command.add_subcommand(
      "scene",
      "Animate a picture's layers under one wind: trees, water, boats, clouds, and what other commands make");
  sub->add_option("SCENE", command->file, "The scene file (.toml); see --init and --keys");
  command->output.add_frames_to(*sub);
  sub->add_option("--init", command->init,
                  "Write a commented scene for this picture to -o SCENE.toml, to be edited")
      ->type_name("PICTURE");
  sub->add_flag("--keys", command->print_keys, "Print what a scene file can say");
  sub->add_option("--sheet", command->sheet, "Write a contact sheet of the picture and frames (PNG, JPEG)");
  sub->add_flag("--json", command->json, "Print files and seconds by stage as JSON");
  add_threads(*sub);
  sub->callback([command, &context] { run_scene(*command, context); });
}

}  // namespace freshet::tools
