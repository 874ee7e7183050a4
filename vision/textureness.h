// vision/textureness.h — how much contrast a place has at each of four sizes of detail, over all frames.
#pragma once

#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "vision/motion_cells.h"

namespace freshet::vision {

inline constexpr int kTextureLevels = 4;

/// Accumulates |Laplacian| by level over a clip's frames at one scale of the clip.
/// The four-level scale-space Laplacian of Okabe et al. 2011, Sec. 5: differences of Gaussians, not decimated,
/// sigma 1, 2, 4, 8 px of the variant's scale; magnitudes are averaged over frames (the paper sums: the average
/// lets clips of different length be compared). Values are in 0..1 (luma in 0..1).
class TexturenessAccumulator {
 public:
  /// cell   px of the scaled frame, side of a cell.
  TexturenessAccumulator(cv::Size source, float scale, int cell);
  ~TexturenessAccumulator();
  void add(const cv::Mat& luma);  // CV_8U, source size; all threads
  /// cells in source px (CellMap::cell = cell / scale), channels = kTextureLevels.
  CellMap finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::vision
