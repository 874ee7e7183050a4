// synth/scene/motion/tree_sway.h — branches and plants that sway about their roots (Chuang et al. 2005, Sec. 3.2).
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/cycle.h"
#include "synth/scene/motion/leaf_shimmer.h"
#include "synth/scene/motion/motion.h"
#include "synth/scene/scene.h"
#include "synth/scene/wind/gusts.h"

namespace freshet::synth::scene {

/// How far a point of the armature is moved to its side, for 1 at the tip; u from the root (0) to the tip (1) (Eq. 3).
/// Beyond the tip, where leaves are, it goes on straight.
double bend(double u);
/// The same divided by u: finite at the root.
float bend_by_distance(float u);

/// Each point turns about the root of its armature, by the displacement of the armature's point at the same distance.
/// A turn keeps the distance, so that the turn back is the true inverse (Eq. 2). Of several armatures
/// each point follows the near ones, by the inverse fourth power of distances to the lines; of a stand, whose lines
/// sway together, more evenly. Foreshortening scales along the armature with the sway out of the picture.
///
/// Where the wind changes, a branch leans too: the same oscillator under the mean wind's change. Its turns for sway and
/// for lean are added, and either gives way by itself, so that a stem that is bent as far as it goes still swings.
class TreeSway : public Motion {
 public:
  /// region   px in which rows will be asked, at most; the armatures' reach follows from the series.
  /// picture_width   px, for gusts.
  TreeSway(const TreeMotion& tree, const Gusts& gusts, const Cycle& cycle, std::uint64_t seed,
           const cv::Rect& region);

  void go_to(int frame) override;
  float reach() const override { return reach_; }
  void row(int copy, int x, int y, int n, float* dx, float* dy) const override;

  /// The tip's displacement at every frame of the cycle, in lengths of the armature, to the right of the way from
  /// root to tip.
  const std::vector<float>& tip(std::size_t armature) const { return branches_[armature].tip; }

  /// The same of what it leans for the mean wind's change since the still, beside the sway; empty where the wind stays.
  const std::vector<float>& lean(std::size_t armature) const { return branches_[armature].lean; }

  /// Rows are interpolated between displacements at this distance, px.
  static constexpr int kStep = 8;
  static constexpr float kMostLean = 0.25f;  // rad: under a storm's mean wind grass would lie flat

 private:
  struct Branch {
    cv::Point2f root, tip_at, way;  // way: unit, root to tip
    float length = 1;
    std::vector<float> tip, lean, towards;
  };
  cv::Point2f source(const Branch& branch, cv::Point2f p, int frame) const;

  TreeMotion tree_;
  Cycle cycle_;
  cv::Rect region_;
  std::vector<Branch> branches_;
  LeafShimmer shimmer_;
  cv::Mat grid_;     // CV_32FC2, d' at region_.tl() + kStep (column, row)
  cv::Mat weights_;  // CV_32F, rows of the grid x (columns * branches)
  float reach_ = 0;
};

}  // namespace freshet::synth::scene
