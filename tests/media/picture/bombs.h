// tests/media/picture/bombs.h — pictures of few bytes that ask a reader for far more memory or time than their pixels
// are worth.
#pragma once

#include <string>
#include <vector>

namespace freshet::media {

struct Bomb {
  std::string name;  // of a file, with its ending
  std::string bytes;
};

/// PNG, APNG, JPEG, TIFF, EXR, WebP, PNM, Radiance, Sun raster, JPEG 2000 and motion: each at most some megabytes, and
/// at most 65,536 pixels unless it claims more than a reader may take.
std::vector<Bomb> picture_bombs();
/// OpenRaster whose layers are such.
std::vector<Bomb> openraster_bombs();

/// A whole PNG of noise. ancillary   chunks before its pixels.
std::string png_of(int width, int height, const std::string& ancillary = {}, const std::string& excess = {});

}  // namespace freshet::media
