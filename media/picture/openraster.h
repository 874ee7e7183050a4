// media/picture/openraster.h — OpenRaster files (.ora): a picture as layers of paint, as Krita, GIMP and MyPaint have
// it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::media {

struct RasterLayer {
  std::string name;
  cv::Mat pixels;     // CV_8UC4 or CV_16UC4: B, G, R, alpha, sRGB code, straight; of any size
  cv::Point at;       // px of the canvas: where its upper left corner lies, maybe outside
  float opacity = 1;  // 0..1
  bool visible = true;
  std::string composite = "svg:src-over";  // how it lies over what is below
};

struct OpenRaster {
  cv::Size canvas;
  std::vector<RasterLayer> layers;   // the uppermost first, as in the file
  std::vector<std::string> notices;  // for a person, of what was read
};

/// By the name's ending, in any case.
bool looks_like_openraster(const std::filesystem::path& path);

/// Reads all layers, also those that are hidden. Groups are dissolved: their layers get their opacity and visibility.
/// What no scene can show (other composite operations, text) is told in the notices.
///
/// Throws Error{kInput} naming the file, what in it is at fault and the remedy: missing, cut short, not a zip or of
/// another mimetype, no stack.xml, a layer whose picture is missing, damaged, no PNG, or named outside of the file;
/// above 2^28 px on the canvas or in a layer, 2^29 in all layers, 1000 layers or 100 groups in each other. Sizes are
/// checked before anything of theirs is allocated, and what a part unpacks to against what it says.
/// Source   OpenRaster 0.0.5 (freedesktop.org); libzip and pugixml, which expands no entities.
OpenRaster read_openraster(const std::filesystem::path& path);

/// Writes the layers cropped to what is in them, what they give together, and a thumbnail. The same layers give the
/// same bytes. Throws Error{kUsage}: no layer, no canvas, pixels of another type; Error{kIo} as write_picture.
void write_openraster(const std::filesystem::path& path, const OpenRaster& raster);

/// A layer on the whole canvas, with its opacity in its alpha: of its own type, transparent where it does not reach.
cv::Mat on_canvas(const RasterLayer& layer, cv::Size canvas);

/// What is seen: visible layers over each other. CV_16UC4.
cv::Mat merged(const OpenRaster& raster);

}  // namespace freshet::media
