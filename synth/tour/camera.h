// synth/tour/camera.h — a camera that moves: where it is, how it looks, what it makes of a point.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::tour {

/// A picture's own view, degrees from its left to its right edge, where nobody says it: as far away as it is wide.
inline constexpr double kUsualView_deg = 53.13;

/// As a person says it. 0 everywhere is the picture's own camera.
struct CameraPlace {
  cv::Vec3d position{
      0, 0, 0};  // x right, y up, z into the picture, in heights of the picture's camera above the floor
  double yaw_deg = 0, pitch_deg = 0;  // right, up
  double view_deg = 0;                // from the left to the right edge; 0: the picture's own
};

/// A view made narrower, to keep within the picture.
struct Narrowing {
  double share = 1;     // tangents of half the view are multiplied by it
  double anchor = 0.5;  // the part of the frame, from above, that shows what it did: 1 its lower edge
};

/// What lies infinitely far, as compositors have it.
inline constexpr double kFar = 1e10;

/// Space as Room has it: x right, y down, z ahead.
struct Pinhole {
  cv::Size frame;
  cv::Vec3d centre{0, 0, 0};
  cv::Matx33d ray_of_pixel =
      cv::Matx33d::eye();  // (x, y, 1) to a direction whose part along the camera's axis is 1
  cv::Vec3d axis{0, 0, 1};
};

}  // namespace freshet::synth::tour
