// tests/synth/tour/ray_caster.h — a scene of known depth, seen from anywhere: a ray for each of many places of a pixel.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/tour/camera.h"

namespace freshet::synth::tour {

/// Space: x right, y down, z ahead; the floor is y = 1.
struct CastScene {
  double back_depth = 8;               // infinite: a sky
  double half_width = 0, ceiling = 0;  // of a room; 0: no walls
  struct Board {
    double depth = 0, left = 0, right = 0, height = 1;  // it stands on the floor
  };
  std::vector<Board> boards{};
  /// Marks: round dots, at whole numbers of floor squares. Nothing else is as bright.
  std::vector<cv::Point2d> floor_marks{}, back_marks{};  // (x, z), (x, y)
  bool marks_alone = false;                              // on black
};

/// CV_32FC3, 0..1: an own texture for each side, of waves that no pixel is too large for.
/// focal_px, vanishing   of a camera that looks straight ahead. place   in the words of a tour's file.
cv::Mat cast(const CastScene& scene, cv::Size size, double focal_px, cv::Point2d vanishing,
             const CameraPlace& place, int samples = 4);
/// Depth along the camera's axis, at pixel centres.
cv::Mat cast_depth(const CastScene& scene, cv::Size size, double focal_px, cv::Point2d vanishing,
                   const CameraPlace& place);
/// Where it sees a point of space.
cv::Point2d projected(const cv::Vec3d& point, cv::Size size, double focal_px, cv::Point2d vanishing,
                      const CameraPlace& place);

}  // namespace freshet::synth::tour
