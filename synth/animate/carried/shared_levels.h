// synth/animate/carried/shared_levels.h — how light places are over time, as the patches there and around them are.
#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/placement/piece_values.h"
#include "synth/animate/placement/placement.h"

namespace freshet::synth::animate {

/// The patches' mean luma over time, shared by neighbours, so that pieces of different clips do not beat against each
/// other: means over a Gaussian neighbourhood. What neighbours do together stays.
class SharedLevels {
 public:
  /// What means of patches that are not in step have lost is given back to liveliest() up to this.
  static constexpr double kMostGain = 2;

  /// reach  pieces: sigma of the neighbourhood.
  SharedLevels(const Placement& placement, int frames, double reach);

  /// How much lighter than on average a patch is in an output frame, luma. Each patch and frame once, patches from many
  /// threads.
  void set(std::size_t patch, int output, float level);
  /// After all of them, before liveliest(); the others need none.
  void settle();

  /// The canvas (canvas_of), CV_32F. Safe from many threads.
  cv::Mat at(int output) const;
  /// The same, shared by a piece and those beside it alone: what a patch does by itself stays.
  cv::Mat here(int output) const;
  /// The same of those patches whose levels change most: weights are variances over time. So the ground around flames
  /// is lit by them, also where its own patches stand. It varies as much as these patches do (their weighted
  /// deviation), and nowhere more than by `deviation`: in proportion, so that it does not switch between two levels.
  cv::Mat liveliest(int output, double deviation) const;

 private:
  cv::Mat weighed_mean(const cv::Mat& values) const;

  PieceValues lattice_;
  double reach_;
  std::vector<cv::Mat> levels_;  // by output frame, on the lattice
  cv::Mat weights_;              // on the lattice
  cv::Mat all_weights_, found_,
      wanted_;  // on the canvas: their sum; deviation of their mean, and their mean deviation
};

}  // namespace freshet::synth::animate
