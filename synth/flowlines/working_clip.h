// synth/flowlines/working_clip.h — a clip reduced to where it is looked at, and whether it can be used.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "synth/flowlines/clip_motion.h"
#include "synth/flowlines/footage.h"

namespace freshet::synth::flowlines {

/// Longer pictures than 480 px are looked at reduced.
struct WorkingClip {
  double scale = 1;             // px of the working picture for one of the clip's
  std::vector<cv::Mat> frames;  // CV_8UC3
  std::vector<cv::Mat> luma;    // CV_8U, their local contrast evened out
  ClipMotion motion;

  cv::Size size() const { return luma.front().size(); }
};

/// Throws    Error{kInput} naming the clip: fewer than 16 frames; Error{kCancelled}.
WorkingClip working_clip(const Footage& footage, const Job& job);

/// Throws    Error{kInput} naming the clip: its camera moves.
/// notices   gains a warning where nothing says whether it does.
void judge_camera(const WorkingClip& clip, const std::string& name, std::vector<std::string>& notices);

}  // namespace freshet::synth::flowlines
