#include "synth/scene/layers/layer_paint.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"

namespace freshet::synth::scene {
namespace {

media::RasterLayer painted(const CutLayer& layer, PaintBits bits) {
  std::vector<cv::Mat> channels;
  cv::split(layer.colour, channels);
  channels.push_back(layer.alpha);
  cv::Mat whole, pixels;
  cv::merge(channels, whole);
  const bool deep = bits == PaintBits::k16;
  whole.convertTo(pixels, deep ? CV_16U : CV_8U, deep ? 65535 : 255);
  return {.name = layer.name, .pixels = pixels, .at = {}};
}

}  // namespace

media::OpenRaster to_paint(std::span<const CutLayer> nearest_first, PaintBits bits) {
  media::OpenRaster out;
  if (nearest_first.empty()) return out;
  out.canvas = nearest_first.front().alpha.size();
  cv::Mat filled = cv::Mat::zeros(out.canvas, CV_8U);
  for (const CutLayer& layer : nearest_first)
    if (!layer.filled.empty()) filled |= layer.filled;
  if (cv::countNonZero(filled) > 0) {
    cv::Mat shown = cv::Mat::zeros(out.canvas, CV_8UC4);
    shown.setTo(cv::Scalar(255, 0, 255, 128), filled);
    out.layers.push_back({.name = kFilledName, .pixels = shown, .at = {}, .visible = false});
  }
  for (const CutLayer& layer : nearest_first) out.layers.push_back(painted(layer, bits));
  return out;
}

CutLayer from_paint(const media::RasterLayer& paint, cv::Size canvas) {
  CutLayer layer{.name = paint.name, .colour = {}, .alpha = {}, .filled = {}};
  const cv::Mat placed = media::on_canvas(paint, canvas);
  cv::Mat whole;
  placed.convertTo(whole, CV_32F, placed.depth() == CV_8U ? 1 / 255.0 : 1 / 65535.0);
  std::vector<cv::Mat> channels;
  cv::split(whole, channels);
  layer.alpha = channels.back();
  channels.pop_back();
  cv::merge(channels, layer.colour);
  layer.colour.setTo(cv::Scalar::all(0), layer.alpha <= 0);
  return layer;
}

std::vector<CutLayer> from_paint(const media::OpenRaster& paint, std::span<const std::string> names,
                                 cv::Size picture, const std::string& where,
                                 std::vector<std::string>* notices) {
  if (paint.canvas != picture)
    throw Error(ErrorKind::kInput, where,
                fmt::format("its canvas is {} x {} px, the picture {} x {}", paint.canvas.width,
                            paint.canvas.height, picture.width, picture.height),
                "Paint on a canvas of the picture's size");
  std::vector<std::string> there;
  for (const media::RasterLayer& layer : paint.layers) {
    there.push_back(layer.name);
    if (notices != nullptr && layer.name != kFilledName &&
        std::find(names.begin(), names.end(), layer.name) == names.end())
      notices->push_back(fmt::format("no layer of the scene is called \"{}\": it is left out", layer.name));
  }
  std::vector<CutLayer> layers;
  for (const std::string& name : names) {
    const auto found = std::count(there.begin(), there.end(), name);
    if (found != 1)
      throw Error(ErrorKind::kInput, where,
                  fmt::format("{} of its layers {} called \"{}\"",
                              found == 0 ? "none" : std::to_string(found), found == 0 ? "is" : "are", name),
                  found == 0 ? fmt::format("Give one that name; there are {}", fmt::join(there, ", "))
                             : "Merge them, or rename one");
    const auto at = std::find(there.begin(), there.end(), name) - there.begin();
    layers.push_back(from_paint(paint.layers[static_cast<std::size_t>(at)], paint.canvas));
    if (cv::countNonZero(layers.back().alpha) == 0)
      throw Error(ErrorKind::kInput, where, fmt::format("nothing is painted on its layer \"{}\"", name),
                  "Paint on it");
  }
  return layers;
}

}  // namespace freshet::synth::scene
