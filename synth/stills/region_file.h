// synth/stills/region_file.h — regions that a person drew: a picture of masks, an SVG, or scribbles.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/stills/region.h"

namespace freshet::synth::stills {

/// An SVG (by its ending) or a picture of masks.
///
/// SVG      each closed outline is a region, named after its element's id; an id that begins with "slow" or
///          "standing"
///          says its kind. Drawn over a still, as strokes are (hints/strokes.h).
/// picture  of the stills' proportions. Black stands still. A middle grey (64 to 191) is slow. A colour is
///          one region,
///          wherever it lies; of white each area that hangs together is one.
///
/// full     px of the stills, which an SVG is drawn over. work   px of the masks that are returned.
/// Throws   Error{kInput} naming the file: unreadable, other proportions, no region in it, more than 32.
std::vector<Region> read_regions(const std::filesystem::path& path, cv::Size full, cv::Size work,
                                 std::vector<std::string>& notices);

/// Regions grown from scribbles (synth/matte/marks.h: white or green on what moves, black or red on what
/// stands): each stroke that moves gets what varies around it, up to the valleys between strokes and to what
/// stands.
/// small       the stills at work size. still   at the scribbles' size: what they may be painted over.
/// Throws      Error{kInput} as read_scribbles, and when no stroke marks what moves.
std::vector<Region> scribbled_regions(const std::filesystem::path& path, const cv::Mat& still,
                                      const std::vector<cv::Mat>& small, std::vector<std::string>& notices);

}  // namespace freshet::synth::stills
