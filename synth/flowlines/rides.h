// synth/flowlines/rides.h — particles followed along their lines: how long each takes to reach each place.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "synth/flowlines/clip_motion.h"
#include "synth/flowlines/lines/flow_line.h"

namespace freshet::synth::flowlines {

enum class Dynamics {
  kMeasured,       // whichever foretells the clip better
  kStationary,     // one speed for a place of a line, whatever particle comes by
  kNonStationary,  // a speed for a particle
};

struct RideOptions {
  Dynamics dynamics = Dynamics::kMeasured;
  double patch_px = 24;    // side of a particle's texture
  double search_px = 3;    // to either side of the flow's guess, along the line
  double min_speed = 0.1;  // px a frame: a particle never stands still for ever
  /// Of a particle's speed by the place's: what departs further is a lost track.
  double max_ratio = 3;
  /// By how much less of the squared difference must be left, as a share, for speeds of their own to be taken.
  double min_gain = 0.05;
};

/// How a line is ridden.
struct Ride {
  std::vector<float> speed;  // by sample: px a frame, > 0, all particles together
  std::vector<float> age;    // by sample: frames from the first sample, growing
  /// By the frame in which a particle enters, then by sample; empty when the dynamics are stationary.
  std::vector<std::vector<float>> age_of_entry{};
  double against = 0;  // of the samples, the share where the clip's flow goes backwards along the line
};

struct Rides {
  std::vector<Ride> lines;
  bool stationary = true;
  /// Of the squared difference that one speed a place leaves, the share that speeds of particles explain: measured
  /// across the lines, from one half of the ribbon to the other, so that noise gains nothing.
  double gain = 0;
};

/// luma     CV_8U, of the lines' picture. What stands still in a line's ribbon (its mean over time) is taken off
///          first: else a stream is followed by the gravel on its ground.
/// Returns  rides in the order of the lines. The same for any number of threads.
/// Cost     samples x patch / 2 x shifts a frame; scratch of two ribbons a thread.
/// Source   Bhat et al. 2004, Sec. 3, "Particle Dynamics" (the search along the line, their footnote 1: constrained
///          optical flow) and "Generality" (non-stationary). Sub-pixel by a parabola through the three best shifts.
Rides follow(const std::vector<cv::Mat>& luma, const std::vector<FlowLine>& lines, const ClipMotion& motion,
             const RideOptions& options = {}, const Job& job = {});

}  // namespace freshet::synth::flowlines
