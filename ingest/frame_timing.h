// ingest/frame_timing.h — when a clip's frames come: at a steady rate, or each in its own time.
#pragma once

#include <span>

namespace freshet::ingest {

/// What a clip's stamps say.
struct FrameTiming {
  double fps = 0;            // mean; 0: fewer than two stamps
  double slowest_fps = 0;    // of the longest interval between two frames
  double fastest_fps = 0;    // of the shortest
  bool steady = true;        // each pair's rate is that of the clip
  double longest_gap_s = 0;  // between two frames
  double gap_after_s = 0;    // where it begins, from the first frame on
};
/// times_s   of the frames, ascending.
FrameTiming timing_of(std::span<const double> times_s);

/// Of two frames one after another so many lie in a second: of a clip of this rate, unless their interval is another by
/// more than a tenth and 2 ms. Less is how containers round stamps (Matroska to 1 ms, phones to 1/600 s).
double pair_rate(double interval_s, double clip_fps);

}  // namespace freshet::ingest
