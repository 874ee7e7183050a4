// synth/animate/staging.h — what leads from an assignment to its animation, the same for every program.
#pragma once

#include <opencv2/core.hpp>

#include "query/labelling/assignment.h"
#include "query/search/motion_guide.h"
#include "store/store.h"
#include "synth/animate/animate.h"
#include "synth/animate/placement/placement.h"

namespace freshet::synth::animate {

/// How fast an animation plays: `factor` times what the map says (retiming.h).
struct Playing {
  double factor = 1;
  cv::Mat map{};  // CV_8UC3 BGR of the picture's size; empty: the same everywhere
};

/// What animate() is given.
struct Staging {
  Placement placement;
  AnimateOptions options;
};

/// The assignment's patches, retimed, and options with the motion that was asked.
/// picture   px. asked   of the motion, as a person asked it and not as it was guessed; may be empty. Its
///           speeds are released where a patch is retimed: they are asked of the clips as they were filmed,
///           and a retimed piece is carried as fast as it plays.
/// options   without guide.
/// Throws    as placement_from and retime.
Staging stage(const store::Snapshot& snapshot, const query::Assignment& assignment, cv::Size picture,
              const query::MotionGuide& asked, const Playing& playing, const AnimateOptions& options);

}  // namespace freshet::synth::animate
