// synth/judging/film_motion.h — how a film moves, as far as its frames tell: some runs of flow, one in each span of
// time.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/judging/evidence.h"

namespace freshet::synth::judging {

inline constexpr int kRunPairs = 6;  // of neighbouring frames, in a run

/// Neighbouring pairs around the middle of one span.
struct MotionRun {
  int first = 0;              // frame
  std::vector<cv::Mat> flow;  // CV_32FC2, px of the evidence per frame, as vision::optical_flow
};
struct FilmMotion {
  std::vector<MotionRun> runs;
  cv::Mat mean;   // CV_32FC2, px of the evidence per second
  cv::Mat speed;  // CV_32F, mean |flow|, px of the evidence per second: eddies count
};

/// At least kFewestFrames. All threads; the same for any number.
/// Cost   24 flows: 0.25 CPU seconds at 320 x 240.
FilmMotion film_motion(const Evidence& film);

}  // namespace freshet::synth::judging
