// synth/flowlines/ladder.h — what each jump between repeats would cost, and how many entries are repeated.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "synth/flowlines/arrival.h"
#include "synth/flowlines/repeats.h"

namespace freshet::synth::flowlines {

struct LadderOptions {
  int margin = 6;   // frames before the first entry and after the last, which feathering shows; at least 1
  int entries = 0;  // K, how many frames' particles are repeated; 0: chosen
  int min_entries = 12;  // of a choice
  RepeatOptions repeats{};
};

/// The repeats of one stream.
struct Ladder {
  int first = 0;  // frame of the clip that entry 0 is
  cv::Mat cost;   // (K + 1) x K, for Repeats: 1 is what unrelated moments of the stream differ by
  double hastened =
      1;  // what arrivals are multiplied by, below 1 when the clip is too short for its particles to
          // go all the way between two rungs
  double per_frame = 0;  // cost of the jumps that such an order makes, by frame
  int min_run = 6;
  int entries() const { return cost.cols; }
};

/// Sheared by the arrivals, a clip's frame e shows each particle that entered in frame e wherever it goes; what is
/// left is Video Textures (Schoedl et al. 2000) on sheared frames: they are compared in windows of time, so that what
/// comes before and after a jump is alike too.
///
/// K and how long particles go (the clip's frames are shared between the two) are tried out: that with the least
/// cost by frame is taken, where a front that outruns the fluid, and so cuts particles, costs more.
///
/// frames    CV_8UC3, the working picture's size.
/// stream    its arrivals; not yet hastened.
/// where     CV_8U, not 0 where the stream is.
/// name      of the clip, for errors.
/// Throws    Error{kInput} when the clip has too few frames for any repeat; Error{kUsage} for entries that it has no
///           room for; Error{kCancelled}.
/// Cost      K^2 comparisons of frames reduced by 4, a few times. The same for any number of threads.
Ladder plan_ladder(const std::vector<cv::Mat>& frames, const Stream& stream, const cv::Mat& where,
                   const std::string& name, const LadderOptions& options, const Job& job = {});

}  // namespace freshet::synth::flowlines
