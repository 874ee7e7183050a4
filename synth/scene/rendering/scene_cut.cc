#include "synth/scene/rendering/scene_cut.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/picture/openraster.h"
#include "synth/matte/marks.h"
#include "synth/matte/matte.h"
#include "synth/scene/cycle.h"
#include "synth/scene/layers/layer_paint.h"
#include "synth/scene/motion/cloud_drift.h"
#include "synth/scene/motion/tree_sway.h"

namespace freshet::synth::scene {
namespace {

constexpr double kUnmoved = 2;  // px of a stripe behind what stays where it is: its soft rim
constexpr double kSafety = 1.5;
constexpr double kFurthestMoved = 0.25;  // of the picture's width
constexpr double kWaves =
    0.015;  // of the picture's longer side: waves bring out what lies so far behind an edge

/// How far the layer's own motion can uncover what lies behind it, px; negative: as usual.
double uncovers(const Scene& scene, const SceneLayer& layer, cv::Size picture) {
  const auto* water = layer.as<WaterMotion>();
  const auto* tree = layer.as<TreeMotion>();
  if (layer.as<StillMotion>() || layer.as<CloudMotion>() || layer.as<PatchesMotion>() ||
      (water != nullptr && !water->edge_moves))
    return kUnmoved;
  if (tree == nullptr || tree->armatures.empty()) return -1;
  const Cycle cycle = cycle_of(scene);
  const Gusts gusts(scene.wind, cycle, picture.width);
  const TreeSway sway(*tree, gusts, cycle, layer.seed, cv::Rect(0, 0, 8, 8));
  double furthest = kUnmoved;
  for (std::size_t i = 0; i < tree->armatures.size(); ++i) {
    const cv::Point2d way = tree->armatures[i].to - tree->armatures[i].from;
    float most = 0;
    for (const float tip : sway.tip(i)) most = std::max(most, std::abs(tip));
    float leans = 0;
    for (const float lean : sway.lean(i)) leans = std::max(leans, std::abs(lean));
    most += std::min(leans, TreeSway::kMostLean);
    furthest = std::max(furthest, kSafety * most * std::hypot(way.x, way.y));
  }
  return std::min(furthest + 4 * tree->shimmer_px, kFurthestMoved * picture.width);
}

/// How far what moves behind the layer at `at` comes out from behind it, px.
double comes_out(const Scene& scene, std::size_t at, cv::Size picture) {
  double furthest = 0;
  for (std::size_t i = at + 1; i < scene.layers.size(); ++i) {
    const SceneLayer& layer = scene.layers[i];
    if (layer.as<WaterMotion>() != nullptr)
      furthest = std::max(furthest, kWaves * std::max(picture.width, picture.height));
    const auto* clouds = layer.as<CloudMotion>();
    if (clouds == nullptr) continue;
    const CloudCourse course =
        course_of(*clouds, scene.wind, cycle_of(scene), scene.loop, picture.width, picture.width);
    furthest = std::max(furthest, course.furthest_px(scene.frames, scene.fps) + kUnmoved);
  }
  return std::min(furthest, kFurthestMoved * picture.width);
}

cv::Mat read_trimap(const std::filesystem::path& path, cv::Size size) {
  const cv::Mat bgr = media::read_picture(path).bgr;
  if (bgr.size() != size)
    throw Error(
        ErrorKind::kInput, path.string(),
        fmt::format("it has {} x {} px, the picture {} x {}", bgr.cols, bgr.rows, size.width, size.height),
        "Give a trimap of the picture's size");
  cv::Mat grey;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  // Black and white as they come out of programs that blur edges.
  grey.setTo(0, grey < 8);
  grey.setTo(255, grey > 247);
  grey.setTo(128, (grey > 0) & (grey < 255));
  return grey;
}

}  // namespace

std::vector<LayerMatte> layer_mattes(const Scene& scene, const media::Still& still,
                                     std::vector<std::string>* notices) {
  std::vector<LayerMatte> mattes;
  std::optional<media::OpenRaster> paint;
  const auto tell = [&](const std::filesystem::path& file, const std::vector<std::string>& said) {
    for (const std::string& notice : said)
      if (notices != nullptr) notices->push_back(file.string() + ": " + notice);
  };
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    const SceneLayer& layer = scene.layers[i];
    if (!layer.is_cut()) continue;
    LayerMatte matte{.name = layer.name};
    matte.uncover_px = uncovers(scene, layer, still.bgr.size());
    if (matte.uncover_px >= 0)
      matte.uncover_px = std::max(matte.uncover_px, comes_out(scene, i, still.bgr.size()));
    switch (layer.matte.kind) {
      case MatteFrom::Kind::kRest:
        matte.kind = MatteKind::kRest;
        break;
      case MatteFrom::Kind::kFile: {
        const media::Matte read = media::read_matte(layer.matte.file, still.bgr.size());
        tell(layer.matte.file, read.notices);
        matte.matte = read.alpha;
        matte.kind = kind_of_matte(read.alpha);
        break;
      }
      case MatteFrom::Kind::kScribbles: {
        std::vector<std::string> said;
        const matte::Marks marks = matte::read_scribbles(layer.matte.file, still.bgr, &said);
        tell(layer.matte.file, said);
        matte.matte =
            matte::make_matte(still.bgr, marks, {.region = {}, .edge = {.edge = matte::Edge::kNone}},
                              layer.matte.file.string())
                .alpha;
        matte.kind = MatteKind::kRegion;
        break;
      }
      case MatteFrom::Kind::kTrimap:
        matte.matte = read_trimap(layer.matte.file, still.bgr.size());
        matte.kind = MatteKind::kTrimap;
        break;
      case MatteFrom::Kind::kPaint: {
        if (!paint) {
          paint = media::read_openraster(scene.paint);
          tell(scene.paint, paint->notices);
        }
        const std::vector<CutLayer> painted =
            from_paint(*paint, std::vector<std::string>{layer.name}, still.bgr.size(), scene.paint.string());
        painted[0].alpha.convertTo(matte.matte, CV_8U, 255);
        matte.kind = layer.matte.painted ? MatteKind::kAlpha : kind_of_matte(matte.matte);
        if (layer.matte.painted) matte.paint = painted[0].colour;
        break;
      }
    }
    mattes.push_back(std::move(matte));
  }
  return mattes;
}

std::vector<LayerPixels> cut_scene(const Scene& scene, const media::Still& still, const CutOptions& options,
                                   const CutProgress& progress, std::vector<std::string>* notices,
                                   std::stop_token stop) {
  std::vector<CutLayer> cut;
  if (!scene.cut.empty()) {
    std::vector<std::string> names;
    for (const SceneLayer& layer : scene.layers)
      if (layer.is_cut()) names.push_back(layer.name);
    const media::OpenRaster paint = media::read_openraster(scene.cut);
    if (notices != nullptr)
      for (const std::string& notice : paint.notices) notices->push_back(scene.cut.string() + ": " + notice);
    cut = from_paint(paint, names, still.bgr.size(), scene.cut.string(), notices);
  } else {
    cut =
        cut_layers(media::coded_picture(still), layer_mattes(scene, still, notices), options, progress, stop);
  }
  std::vector<LayerPixels> pixels;
  std::size_t next = 0;
  for (const SceneLayer& layer : scene.layers) {
    pixels.emplace_back();
    if (!layer.is_cut()) continue;
    pixels.back() = {.colour = cut[next].colour, .alpha = cut[next].alpha};
    ++next;
  }
  return pixels;
}

}  // namespace freshet::synth::scene
