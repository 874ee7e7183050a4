// steady.h — frames of a moving camera as one that stands would have seen them.
//
// What stands in a take (camera_track.h) tells where each frame looks: a similarity, by least squares over some hundred
// points, from frame to frame of a window, and through the windows of a stretch. Frames are resampled so that the
// middle one stays where it is, and cropped to what all of them show. A stretch ends where nothing solid is seen, or
// where less than kMinKept of a side would be left: a long pan becomes several clips.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "ingest/camera_track.h"

namespace freshet::ingest {

struct SteadyPath {
  std::vector<cv::Matx23d> source_from_steady;  // of each frame, px of the source from px of the result
  cv::Size size;                                // of the result, even
  double kept = 1;                              // of the source's area
};

struct SteadyLimits {
  double min_kept = 0.6;   // of each side
  double max_step = 0.01;  // rms from frame to frame, of the diagonal: beyond it frames are blurred
};

/// Of windows first..last - 1, the longest run from the first on whose frames can be made steady; its windows' number,
/// 0 if there is none, and then the reason.
struct SteadyRun {
  std::size_t windows = 0;
  std::string refusal;
};
SteadyRun steady_run(std::span<const CameraWindow> windows, cv::Size working,
                     const SteadyLimits& limits = {});

/// Of all frames of these windows, the last one's last left out.
/// working   size in which they were tracked. source   size of the frames.
SteadyPath steady_path(std::span<const CameraWindow> windows, cv::Size working, cv::Size source);

}  // namespace freshet::ingest
