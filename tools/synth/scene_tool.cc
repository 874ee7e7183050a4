// freshet synth scene: a picture's layers, all moved by one wind.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "platform/stopwatch.h"
#include "synth/animate/frame_sheet.h"
#include "synth/scene/frames/made_frames.h"
#include "synth/scene/measured/measured_plants.h"
#include "synth/scene/printed_scene.h"
#include "synth/scene/rendering/scene_animation.h"
#include "synth/scene/rendering/scene_cut.h"
#include "synth/scene/rendering/scene_drawing.h"
#include "synth/scene/scene_file.h"
#include "synth/scene/scene_marks.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/options/output_options.h"
#include "tools/synth/animate_run.h"
#include "tools/synth/layer_files.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
namespace scene = synth::scene;

struct SceneCommand {
  std::string file, init, sheet, drawing, layers_out;
  OutputOptions output;
  bool as_printed = false, print_keys = false, json = false;
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

/// A layer of patches, made as freshet synth animate makes a picture.
void make_patches(const scene::PatchesTarget& target, const scene::PushedFrames::Sinks& sinks,
                  const RunContext& context) {
  AnimateRequest request;
  request.store = target.motion->store.string();
  request.words = target.motion->options;
  request.frames = target.scene->frames;
  request.fps = target.scene->fps;
  request.loop = target.scene->loop;
  request.where = fmt::format("{}: layer {}", target.scene->file.string(), target.layer->name);
  if (!target.motion->class_name.empty())
    request.words.insert(request.words.end(), {"--class", target.motion->class_name});
  if (!target.motion->strokes.empty())
    request.words.insert(request.words.end(), {"--strokes", target.motion->strokes.string()});
  request.loaded.picture = request.loaded.still.bgr = target.picture;
  request.loaded.matte = target.matte;
  request.loaded.matte_known = true;
  request.strokes = target.strokes;
  animate_layer(request, sinks.frame, sinks.motion, context);
}

/// All that was written.
std::vector<std::string> files_of(const SceneCommand& command, const LayerFiles& layers) {
  std::vector<std::string> files = command.output.files();
  files.insert(files.end(), layers.files().begin(), layers.files().end());
  for (const std::string& file : {command.sheet, command.drawing})
    if (!file.empty()) files.push_back(file);
  return files;
}

struct Spent {
  double cut = 0, stage = 0, render = 0;  // s
};

/// Says what was made, and prints its files.
void report(const SceneCommand& command, const scene::Scene& asked, cv::Size size,
            const std::vector<std::string>& files, const Spent& spent,
            const scene::SceneAnimation& animation) {
  const scene::SceneSeconds& seconds = animation.seconds();
  say(fmt::format(
      "{} frames of {} x {} from {} layers in {:.1f} s (cut {:.1f}, stage {:.1f}; motion {:.1f}, "
      "composite {:.1f}, layers' own frames {:.1f}, write {:.1f}); sprites {:.0f} MB",
      asked.frames, size.width, size.height, asked.layers.size(), spent.cut + spent.stage + spent.render,
      spent.cut, spent.stage, seconds.motion, seconds.composite, seconds.frames,
      spent.render - seconds.motion - seconds.composite - seconds.frames,
      1e-6 * static_cast<double>(animation.bytes())));
  if (!command.json) {
    for (const std::string& path : files) fmt::print("{}\n", path);
    return;
  }
  fmt::print("{}\n", nlohmann::json{{"files", files},
                                    {"frames", asked.frames},
                                    {"layers", asked.layers.size()},
                                    {"width", size.width},
                                    {"height", size.height},
                                    {"fps", asked.fps},
                                    {"seconds",
                                     {{"cut", spent.cut},
                                      {"stage", spent.stage},
                                      {"motion", seconds.motion},
                                      {"composite", seconds.composite},
                                      {"layers", seconds.frames},
                                      {"render", spent.render}}}}
                         .dump(2));
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
  plan_stages({{"cut", "cutting layers"}, {"stage", "staging layers"}, {"render", "rendering"}});
  scene::Scene asked =
      command.as_printed ? scene::read_printed_scene(command.file) : scene::read_scene(command.file);
  TargetFiles::Loaded loaded{.picture = {}, .matte = {}, .still = media::read_still(asked.picture)};
  for (const std::string& notice : loaded.still.notices) say(asked.picture.string() + ": " + notice);
  loaded.picture = loaded.still.bgr;
  loaded.matte = cv::Mat(loaded.picture.size(), CV_8U, cv::Scalar(255));
  std::vector<std::string> notices;
  scene::read_marks(asked, loaded.picture.size(), &notices);
  scene::measure_plants(asked, &notices, context.stop);

  synth::animate::FrameOptions form;
  form.frames = asked.frames;
  form.fps = asked.fps;
  check_picture_output(command.sheet);
  check_picture_output(command.drawing);
  std::unique_ptr<AnimationFiles> output;
  if (!command.output.name().empty() || command.drawing.empty()) output = command.output.open(loaded, form);
  LayerFiles layer_files(output == nullptr ? "" : command.layers_out, asked, loaded.picture.size(),
                         command.output.first_number());

  Stopwatch watch;
  Progress progress;
  const std::vector<scene::LayerPixels> pixels = scene::cut_scene(
      asked, loaded.still, {},
      [&](std::size_t layer, const std::string&) {
        progress.show("cut", layer, asked.layers.size(), "layers");
      },
      &notices, context.stop);
  const double cut_s = watch.lap();
  const auto draw = [&] {
    if (!command.drawing.empty())
      media::write_picture(command.drawing, scene::draw_scene(loaded.picture, asked, pixels));
  };
  const scene::PatchesMaker patches = [&](const scene::PatchesTarget& target,
                                          const scene::PushedFrames::Sinks& sinks) {
    make_patches(target, sinks, context);
  };
  const auto frames_of = [&](const scene::SceneLayer& layer, const scene::LayerPixels& own) {
    progress.show("stage", static_cast<std::size_t>(&layer - asked.layers.data()), asked.layers.size(),
                  "layers");
    return scene::frames_of_layer(asked, layer, own, patches, context.stop, layer_files.work());
  };
  if (output == nullptr) {
    // What a run would refuse is refused here too. Patches are labelled before the first is refused.
    const scene::SceneAnimation staged(
        asked, pixels, loaded.picture.size(),
        [&](const scene::SceneLayer& layer, const scene::LayerPixels& own) {
          return layer.as<scene::PatchesMotion>() != nullptr ? nullptr : frames_of(layer, own);
        },
        &notices);
    draw();
    progress.finish();
    say_all(notices);
    fmt::print("{}\n", command.drawing);
    return;
  }
  scene::SceneAnimation animation(asked, pixels, loaded.picture.size(), frames_of, &notices);
  draw();
  say_all(notices);
  const double stage_s = watch.lap();

  synth::animate::FrameSheet sheet(
      loaded.picture, loaded.matte, asked.frames,
      {.fps = asked.fps, .first_number = command.output.first_number(), .shown = 8, .width_px = 480});
  const bool deep = form.form == synth::animate::FrameForm::kFluid;
  cv::Mat frame(loaded.picture.size(), deep ? CV_32FC4 : CV_8UC3);
  for (int i = 0; i < asked.frames && i < form.until; ++i) {
    if (context.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "scene", "stopped");
    animation.render(i, frame);
    sheet.add(output->write(frame));
    layer_files.write(animation);
    progress.show("render", static_cast<std::size_t>(i + 1), static_cast<std::size_t>(asked.frames),
                  "frames");
  }
  output->finish();
  layer_files.finish();
  progress.finish();
  if (!command.sheet.empty()) media::write_picture(command.sheet, sheet.draw());
  const double render_s = watch.lap();
  report(command, asked, frame.size(), files_of(command, layer_files), {cut_s, stage_s, render_s}, animation);
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
  sub->add_option(
      "--draw", command->drawing,
      "Write the picture with what was understood: layers, armatures, the water's plane, hull lines (PNG, "
      "JPEG); alone, nothing is rendered; it checks everything that a run checks, except patches");
  sub->add_option(
         "--layers-out", command->layers_out,
         "Also write each layer alone, with alpha: 'layers/{layer}.####.exr' (half floats, linear light, "
         "premultiplied), '{layer}.mov' (ProRes 4444, straight), or another format with alpha, as deep as it "
         "holds. Without {layer}, 'layers.####.exr', all in one file a frame: the film, and a part for each "
         "layer with its motion to the next frame, px, y up (LAYER.forward.u, LAYER.forward.v)")
      ->group("Output");
  std::string keys;
  for (const scene::PrintedKey& key : scene::printed_keys())
    keys += fmt::format("{}{}.{} = {}", keys.empty() ? "" : ", ", key.table, key.key, key.value);
  sub->add_flag("--as-printed", command->as_printed,
                "The method as Chuang et al. 2005 print it, whole: " + keys);
  sub->add_flag("--keys", command->print_keys, "Print what a scene file can say");
  sub->add_option("--sheet", command->sheet, "Write a contact sheet of the picture and frames (PNG, JPEG)");
  sub->add_flag("--json", command->json, "Print files and seconds by stage as JSON");
  add_threads(*sub);
  sub->callback([command, &context] { run_scene(*command, context); });
}

}  // namespace freshet::tools
