// synth/stills/plan.h — an animation as it was decided: regions, their orders, and when each shows which
// still.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "freshet/job.h"
#include "synth/stills/edits.h"
#include "synth/stills/parted_stills.h"
#include "synth/stills/partial_order.h"
#include "synth/stills/region.h"
#include "synth/stills/sampling.h"
#include "synth/stills/still_graph.h"
#include "synth/stills/timeline.h"

namespace freshet::synth::stills {

struct PlanOptions {
  double seconds = 8;  // of the animation
  bool loop = false;   // its end goes over into its beginning, exactly
  GraphOptions graph{};
  SamplingOptions sampling{};  // steps and loop are the plan's own
  TimingOptions timing{};
  double slow_step_s = 2.5;  // of slow regions
  int side = 200;            // px, longer side of the copies whose distances are taken
  double blur_px = 0;        // of those; 0: the six of still_distances
  int split = 1;             // parts of each independent region
  double follow = 0.05;      // lambda of Eq. 3, of the graph's mean edge weight
  std::vector<RegionEdits> edits{};
};

/// One region's part of the animation.
struct PlannedRegion {
  Region region;
  Square<double> rms;  // how unlike the stills are in it
  StillGraph graph;
  std::vector<Path> paths;
  std::vector<int> sequence;
  Timeline timeline;
  std::string reference;                              // the part that it goes by (Eq. 3); empty: none
  std::shared_ptr<const FrontThing> front = nullptr;  // of a thing in front, which goes over all regions
};

struct Plan {
  std::vector<PlannedRegion> regions;  // none that stands; things in front last, nearest first
  int standing = 0;                    // the still that is shown where nothing moves
  std::vector<std::string> notices;    // for a person
};

/// small     the stills at work size, CV_8UC3. names   of their files.
/// regions   with masks of that size. What the edits say of them is heeded: kinds and splits too.
/// Throws    Error{kInput} when a region's stills have no path, and for edits that name what is not there;
///           Error{kCancelled}.
Plan make_plan(const std::vector<cv::Mat>& small, const std::vector<std::string>& names,
               const std::vector<Region>& regions, const PlanOptions& options, const Job& job = {});

}  // namespace freshet::synth::stills
