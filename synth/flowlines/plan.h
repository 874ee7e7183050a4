// synth/flowlines/plan.h — how a clip's frames are shared between the entries that repeat and their particles' ways.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "freshet/job.h"
#include "synth/flowlines/arrival.h"
#include "synth/flowlines/ladder.h"
#include "synth/flowlines/moments.h"

namespace freshet::synth::flowlines {

struct PlanOptions {
  StrandOptions strands{};
  int entries = 0;       // K of every stream; 0: chosen
  int loop_frames = 0;   // > 0: the order closes after so many frames
  bool in_turn = false;  // RepeatOptions
  std::uint64_t seed = 1;
};

struct Plan {
  Arrivals arrivals;
  std::vector<Ladder> ladders;  // by stream
  float floor = 0;              // px a frame: what is slower is passed over at once
  double cut_share = 0;         // of the lines' places: where that is so
  int margin = 0;               // frames that a jump may show before its run's first entry and after its last
};

/// Particles' ways and K share the clip's frames: some divisions are tried, and the cheapest is taken. Streams whose
/// particles are through sooner repeat more entries.
///
/// ladders   of the clip's working frames, of size `picture`.
/// frames    of the clip.
/// Throws    Error{kUsage} when there is no room for so many entries, or for a loop of more than 10000 frames;
///           Error{kCancelled}.
Plan plan_repeats(const Ladders& ladders, const std::vector<FlowLine>& lines, const Rides& rides,
                  cv::Size picture, int frames, const PlanOptions& options, const Job& job);

/// The order in which each stream's runs follow each other.
/// time     0: as the clip begins; others are as good, begin elsewhere in it, and go their own way.
/// Throws   Error{kUsage} when there is no loop of that length.
std::vector<Order> orders_of(const Plan& plan, const PlanOptions& options, int time = 0);

}  // namespace freshet::synth::flowlines
