// synth/animate/placement/placement.h — which patch lies where: all that rendering needs of an assignment.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "vision/variant.h"

namespace freshet::synth::animate {

/// One piece of the picture and the patch laid on it.
struct PlacedPatch {
  cv::Point piece;  // px, top-left corner in the picture; may lie outside it
  store::ClipId clip{};
  vision::Variant variant;  // the patch's coordinates are in this variant's frame
  cv::Point patch;          // px, top-left corner
  double speed = 1;         // at which its clip plays, of its own
};

/// Pieces on one regular lattice: every piece.x differs from another's by a multiple of `stride`; so does y.
struct Placement {
  int side = 48;    // px, of a piece
  int stride = 24;  // px
  /// Pieces lie on the picture reduced by this, and are shown enlarged by it: all px here are of the reduced
  /// picture (query/search/picture_scale.h).
  double piece_scale = 1;
  std::vector<PlacedPatch> patches;
};

/// Throws Error{kInput} when there is no piece, when side or stride is no multiple of 4 px, or when more than
/// four pieces overlap across: an assignment file can say so.
void check(const Placement& placement);

/// The same on the picture at half the size, from clips at half the size: to half a pixel.
Placement halved(const Placement& placement);

/// The largest power of two, at most `max_step`, that divides side and stride: in steps of
/// it pieces and canvas coincide.
int common_step(const Placement& placement, int max_step);

/// True when b's patch continues a's in its own clip and variant, at the same speed: laid beside each other
/// they show what the clip showed there, without a seam.
bool coherent(const PlacedPatch& a, const PlacedPatch& b);

/// The smallest rectangle of whole strides that holds all pieces: the canvas on which they are blended. Its
/// corner lies on the lattice.
cv::Rect canvas_of(const Placement& placement);

/// From pixels of the picture to squares of `square` px, middles on middles.
/// corner   of the first square, on the reduced picture.
cv::Matx23d squares_from_picture(const Placement& placement, cv::Point corner, int square, cv::Size picture);

/// How fast its patches play in the mean; 1: as filmed, or none.
double mean_speed(const Placement& placement);

}  // namespace freshet::synth::animate
