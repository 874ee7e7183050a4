// synth/stills/timeline.h — when a region shows which still, and what lies between.
#pragma once

#include <vector>

#include "synth/stills/still_graph.h"

namespace freshet::synth::stills {

/// Between two stills that follow each other.
struct Instant {
  int from = 0, to = 0;
  double phase = 0;  // 0: from, towards 1: to
};

struct TimingOptions {
  double step_s = 0.5;  // of the mean step, s
  double speed = 1;     // a region's own
  /// A step takes as long as its stills are unlike beside the mean step, within these limits: what moves,
  /// moves evenly.
  double shortest = 0.6, longest = 1.6;
  bool slow_turns = true;  // slows down before a turn, and gathers speed after it (Lin et al. 2007, Sec. 5.2)
  double exactly_s = 0;    // above 0: all steps together take so long, of a loop
};

/// A sequence of stills laid out in time. The last moment goes on where time does.
class Timeline {
 public:
  /// sequence   at least one still. rms   the unlikeness of stills.
  Timeline(const std::vector<int>& sequence, const Square<double>& rms, const TimingOptions& options = {});

  Instant at(double seconds) const;
  double seconds() const { return at_.back(); }
  const std::vector<int>& sequence() const { return still_; }
  const std::vector<double>& times() const { return at_; }  // s, of each still

 private:
  std::vector<int> still_;
  std::vector<double> at_;  // s, of each still
  std::vector<char> rest_;  // 1: motion turns at this still
};

}  // namespace freshet::synth::stills
