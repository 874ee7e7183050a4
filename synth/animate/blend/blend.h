// synth/animate/blend/blend.h — the differences of all pieces merged into one moving field, band by band.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/placement/placement.h"

namespace freshet::synth::animate {

enum class BlendWeights {
  kPaper,     // weights sum to one: two unrelated differences average, and lose contrast
  kVariance,  // weights' squares sum to one, as far as the pieces are unrelated: contrast is kept
};

/// What becomes of a piece's mean level over time, the lowest band of its difference.
enum class LowBand {
  kKeep,    // as it is: neighbouring pieces of different clips beat against each other
  kRemove,  // gone: right for water, but a fire no longer breathes
  kShared,  // averaged over a wide neighbourhood: only what neighbours do together stays
};

struct BlendOptions {
  BlendWeights weights = BlendWeights::kVariance;
  LowBand low_band = LowBand::kShared;
  /// Band-pass levels; fewer where side and stride are no multiples of 2^levels px. The rest of a 48 px piece
  /// is then 6 x 6.
  int levels = 3;
  double low_band_reach = 3;  // kShared: sigma of the neighbourhood, in pieces
};

/// Collects the pieces' differences frame by frame, and gives the merged field.
///
/// A piece owns the square of one stride at its middle. At each level the owner's weight falls off over a
/// width in proportion to the level's wavelength. Fine detail changes hands within a few pixels, so that two
/// unrelated textures are never shown on top of each other; coarse detail over the whole overlap.
///
/// Weights are divided by the root of w' C w, C the correlation of the pieces (1 for coherent neighbours,
/// else 0). That keeps the variance: with plain averages two unrelated pieces lose 3 dB at their border.
///
/// Source   Okabe et al. 2011, Sec. 6; Burt and Adelson 1983.
class Blender {
 public:
  /// Memory: frames x canvas x 4/3 floats.
  Blender(const Placement& placement, int frames, const BlendOptions& options);
  ~Blender();

  /// Adds one piece's difference in one frame: CV_32F, side x side, luma.
  /// Different frames may be added from different threads; the pieces of one frame in a fixed order, for results
  /// that do not depend on threads.
  void add(int frame, std::size_t patch, const cv::Mat& difference);

  /// How much of each band of a piece is taken from now on; 1 by default. gains: levels() values, finest first.
  void scale(std::size_t patch, std::span<const float> gains);
  /// Mean squares of a window's bands, levels() values, finest first. Safe from many threads.
  std::vector<double> band_power(const cv::Mat& window);
  int levels() const;

  /// The merged detail of one frame on the canvas (canvas_of), and what LowBand makes of the pieces' levels:
  /// CV_32F. Each once; they free the frame's memory. After all adds. kKeep: levels are part of the detail.
  cv::Mat take_detail(int frame);
  cv::Mat take_level(int frame);
  /// Frees the frame's memory without merging what is left of it.
  void drop(int frame);
  /// Both together.
  cv::Mat take(int frame) { return take_detail(frame) + take_level(frame); }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::synth::animate
