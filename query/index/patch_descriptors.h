// query/index/patch_descriptors.h — the descriptors under a clip's patches, each computed once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "stored/patch_table.h"
#include "vision/codebook.h"
#include "vision/dense_sift.h"
#include "vision/settings.h"

namespace freshet::query {

/// Which grid points of a clip's unflipped variants lie under its patches. A flipped patch has the points of
/// its mirror image in the unflipped twin.
class PatchPoints {
 public:
  /// Throws Error{kDamaged} when a patch does not lie on its variant's grid.
  PatchPoints(const store::ClipRecord& clip, const vision::Settings& settings,
              std::span<const vision::Variant> variants, const stored::ClipPatches& patches);

  /// One unflipped variant that has patches, or whose twin has.
  struct Sheet {
    vision::Variant variant;
    cv::Point origin;                   // px, of its grid, in the unflipped frame
    int columns = 0, rows = 0;          // of its grid
    std::vector<std::uint32_t> points;  // row * columns + column, ascending
  };
  const std::vector<Sheet>& sheets() const { return sheets_; }
  std::size_t points() const;
  /// Descriptors of a sheet's points, in their order. average   the clip's average image.
  std::vector<vision::Descriptor> describe(const Sheet& sheet, const cv::Mat& average) const {
    return describe(sheet, average, sheet.points);
  }
  /// Of some points of its grid, ascending.
  std::vector<vision::Descriptor> describe(const Sheet& sheet, const cv::Mat& average,
                                           std::span<const std::uint32_t> points) const;
  /// Words of all patches, given the descriptors of each sheet's points.
  vision::OwnWordMaps words(const vision::Codebook& codebook,
                            std::span<const std::vector<vision::Descriptor>> descriptors) const;

 private:
  struct Place {
    std::uint32_t sheet = 0;
    bool flipped = false;
    int column = 0, row = 0;  // of the patch's upper left point, in the sheet's grid
  };
  int step_ = 6;    // px between grid points
  int spread_ = 1;  // grid points from one of a patch's points to the next
  int word_bytes_ = 1;
  std::vector<Sheet> sheets_;
  std::vector<Place> places_;  // a patch each
};

/// px between the points of a grid that all patches of a stride share, and how many of its steps a patch's
/// own points are apart: 6 and 1 for patches of 48 px every 24.
struct SharedGrid {
  int step = 6, spread = 1;
};
SharedGrid shared_grid(const vision::PatchGrid& grid);

}  // namespace freshet::query
