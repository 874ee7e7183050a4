// freshet synth layers: a scene's layers cut free, with what lies behind them, as a file to paint in.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/openraster.h"
#include "media/picture/picture.h"
#include "platform/stopwatch.h"
#include "synth/scene/layers/cut_layers.h"
#include "synth/scene/layers/layer_paint.h"
#include "synth/scene/measured/measured_plants.h"
#include "synth/scene/rendering/scene_cut.h"
#include "synth/scene/scene_file.h"
#include "synth/scene/scene_marks.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"

namespace freshet::tools {
namespace {

namespace scene = synth::scene;

struct LayersCommand {
  std::filesystem::path file, out, refill;
  std::string edge = scene::to_string(scene::CutOptions{}.alpha);
  scene::CutOptions options;
  double uncover_px = -1;  // of every layer; negative: as far as its motion goes
  int bits = 0;            // 0: as deep as the picture
  bool json = false;
};

// The widest error that laying the layers over each other as they are written leaves, in levels of their bits.
double error_of(const media::OpenRaster& paint, const cv::Mat& picture, double levels) {
  std::vector<scene::CutLayer> layers;
  for (const media::RasterLayer& layer : paint.layers)
    if (layer.visible) layers.push_back(scene::from_paint(layer, paint.canvas));
  return levels * cv::norm(scene::composited(layers), picture, cv::NORM_INF);
}

nlohmann::json summary(const LayersCommand& command, const std::vector<scene::CutLayer>& layers,
                       double error) {
  nlohmann::json out{
      {"layers", nlohmann::json::array()}, {"file", command.out.string()}, {"error_levels", error}};
  for (const scene::CutLayer& layer : layers)
    out["layers"].push_back({{"name", layer.name},
                             {"share", cv::mean(layer.alpha)[0]},
                             {"filled_px", layer.filled.empty() ? 0 : cv::countNonZero(layer.filled)},
                             {"seconds", {{"matting", layer.matting_s}, {"filling", layer.filling_s}}}});
  return out;
}

void run_layers(LayersCommand& command, const RunContext& context) {
  if (!media::looks_like_openraster(command.out))
    throw Error(ErrorKind::kUsage, command.out.string(), "layers are written as OpenRaster",
                "Name it LAYERS.ora");
  check_output_folder(command.out);
  command.options.alpha = scene::parse_alpha_method(command.edge);
  scene::Scene asked = scene::read_scene(command.file);
  const media::Still still = media::read_still(asked.picture);
  for (const std::string& notice : still.notices) say(asked.picture.string() + ": " + notice);
  std::vector<std::string> notices;
  // How far a tree sways is what it uncovers.
  scene::read_marks(asked, still.bgr.size(), &notices);
  scene::measure_plants(asked, &notices, context.stop);
  if (!asked.cut.empty())
    notices.push_back(command.file.string() + ": its layers are cut anew, and not taken from " +
                      asked.cut.string());
  if (!command.refill.empty())
    command.options.refill = media::read_matte(command.refill, still.bgr.size()).alpha;
  std::vector<scene::LayerMatte> mattes = scene::layer_mattes(asked, still, &notices);
  if (command.uncover_px >= 0)
    for (scene::LayerMatte& matte : mattes) matte.uncover_px = command.uncover_px;
  for (const std::string& notice : notices) say(notice);
  if (mattes.empty())
    throw Error(ErrorKind::kInput, command.file.string(), "no layer of it is cut from the picture",
                "Give one a matte");

  Progress progress;
  const Stopwatch watch;
  const std::vector<scene::CutLayer> layers = scene::cut_layers(
      media::coded_picture(still), mattes, command.options,
      [&](std::size_t layer, const std::string&) { progress.show("cut", layer, mattes.size(), "layers"); },
      context.stop);
  progress.finish();
  const double seconds = watch.seconds();
  const bool deep = command.bits == 16 || (command.bits == 0 && !still.deep.empty());
  const media::OpenRaster paint =
      scene::to_paint(layers, deep ? scene::PaintBits::k16 : scene::PaintBits::k8);
  media::write_openraster(command.out, paint);
  const double error = error_of(paint, media::coded_picture(still), deep ? 65535 : 255);
  say(fmt::format(
      "{} layers of {} x {} px in {:.1f} s; laid over each other they are within {:.2f} levels of the "
      "picture",
      layers.size(), still.bgr.cols, still.bgr.rows, seconds, error));
  if (command.json)
    fmt::print("{}\n", summary(command, layers, error).dump(2));
  else
    fmt::print("{}\n", command.out.string());
}

}  // namespace

void add_layers(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<LayersCommand>();
  CLI::App* sub = synth_command.add_subcommand("layers",
                                               "Cut a scene's layers free and fill in what lies behind them, "
                                               "as OpenRaster, to be looked at and painted over");
  sub->add_option("SCENE", command->file, "The scene file (.toml), as freshet synth scene takes it")
      ->required();
  sub->add_option(
         "-o,--output", command->out,
         "The layers (.ora), for Krita, GIMP or MyPaint, and a hidden one that shows what was filled in. "
         "The scene's cut = \"FILE.ora\" takes them back")
      ->required();
  sub->add_option("--bits", command->bits,
                  "Bits of each channel, 8 or 16 [as many as the picture's, at most 16]")
      ->check(CLI::IsMember({8, 16}));
  const std::string edges = "Edge";
  sub->add_option(
         "--edge", command->edge,
         "How much of a pixel at a layer's edge is the layer: bayesian, information-flow, guided, or hard "
         "(the matte itself, colours as they are)")
      ->check(CLI::IsMember({"bayesian", "information-flow", "guided", "hard"}))
      ->capture_default_str()
      ->group(edges);
  sub->add_option(
         "--edge-width", command->options.band_px,
         "Width, px, of the band along a region's edge in which alpha is found [1.5 % of the picture's "
         "longer side]")
      ->check(CLI::Range(1.0, 10000.0))
      ->group(edges);
  const std::string filling = "What lies behind";
  sub->add_option(
         "--uncover", command->uncover_px,
         "How far, px, a layer's motion can uncover what lies behind it: so wide a stripe is filled with "
         "patches of the picture, what lies deeper smoothly [as far as each layer's motion goes]")
      ->check(CLI::Range(0.0, 10000.0))
      ->group(filling);
  sub->add_option("--search", command->options.fill.search_px,
                  "How far from its place a patch is searched, px")
      ->check(CLI::Range(8, 4096))
      ->capture_default_str()
      ->group(filling);
  sub->add_option(
         "--refill", command->refill,
         "A matte, white where the filling does not please: it is filled again there, from further away")
      ->group(filling);
  sub->add_option("--refill-search", command->options.refill_search_px, "How far, px")
      ->check(CLI::Range(8, 4096))
      ->capture_default_str()
      ->group(filling);
  sub->add_flag("--json", command->json, "Print each layer's share, filled px and seconds as JSON");
  add_overwrite(*sub);
  add_threads(*sub);
  sub->callback([command, &context] { run_layers(*command, context); });
}

}  // namespace freshet::tools
