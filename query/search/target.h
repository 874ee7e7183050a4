// query/search/target.h — a still picture cut into the pieces that are to be animated.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "query/index/candidate_index.h"
#include "vision/codebook.h"
#include "vision/patch_grid.h"

namespace freshet::query {

struct TargetOptions {
  /// A piece is kept when the matte covers this fraction of its area inside the picture.
  double min_matte = 0.25;
};

/// The pieces of a picture, in row-major order of one regular lattice: piece and patch have the same size,
/// and their grid points and cells coincide where neighbours overlap.
struct Target {
  cv::Size picture;
  int side = 48, stride = 24;  // px
  /// px, upper left corner of the lattice; may be negative: pieces at the border overhang, evenly on both
  /// sides, and see the picture reflected there.
  cv::Point origin;
  int columns = 0, rows = 0;       // of the lattice
  std::vector<cv::Point> places;   // column and row of each piece
  std::vector<cv::Point> corners;  // px, upper left corner of each piece
  std::vector<PieceQuery> queries;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;  // right and lower neighbours, p < q

  std::size_t size() const { return corners.size(); }
};

/// The lattice and its pieces, without words: queries stay empty.
/// Pieces that the matte covers well are kept; then the piece that covers most of what is left is added,
/// until every pixel with a matte above 0 lies in one. Throws Error{kInput} when the matte is 0 everywhere.
Target lay_out(const cv::Mat& matte, const vision::PatchGrid& grid, const TargetOptions& options = {});

/// Pieces with their words, by the code that patches go through.
/// picture   CV_8UC3, BGR; its luma is BT.601's, as media::to_luma has it.
/// matte     CV_8U, same size; 255 where the fluid is. A grid point counts when the matte is above 127 there,
///           and all inside the picture when that leaves fewer than 9.
Target make_target(const cv::Mat& picture, const cv::Mat& matte, const vision::PatchGrid& grid,
                   const vision::Codebook& codebook, const TargetOptions& options = {});

}  // namespace freshet::query
