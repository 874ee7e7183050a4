// synth/scene/water/camera.h — a plane of water as a camera sees it, from its horizon and focal length.
#pragma once

#include <opencv2/core.hpp>

#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// A pinhole above a plane. Pixels are told in a frame that is rolled with the horizon, its origin at the picture's
/// middle: `along` to the right along the horizon, `below` away from the sky. A row of equal `below` lies at one
/// distance.
///
/// Eq. 10 writes M for a 3 x 3 matrix from picture to plane and M^-1 for the way back of a point above the plane.
/// No such matrix has a third dimension to lift a point in: here the lifted point is projected by the camera itself.
class WaterCamera {
 public:
  /// horizon    px of the picture; no two ends alike.
  WaterCamera(const Line& horizon, double focal_px, double height_m, cv::Size picture);

  /// From the middle of pixel (x, y), which may lie between pixels.
  cv::Point2d rolled(double x, double y) const {
    const double u = x + 0.5 - middle_.x, v = y + 0.5 - middle_.y;
    return {u * cos_roll_ + v * sin_roll_, v * cos_roll_ - u * sin_roll_};
  }
  /// A vector of the rolled frame in the picture's.
  cv::Point2d upright(cv::Point2d rolled) const {
    return {rolled.x * cos_roll_ - rolled.y * sin_roll_, rolled.x * sin_roll_ + rolled.y * cos_roll_};
  }

  /// Of a vector from the camera, m right, away from the viewer and up, the homogeneous px of the picture ((0, 0) its
  /// corner); the third is greater than 0 before the camera.
  cv::Matx33d picture_from_world() const;
  double height_m() const { return height_; }

  /// `below` of the horizon itself.
  double horizon() const { return horizon_; }
  double roll_cos() const { return cos_roll_; }
  double roll_sin() const { return sin_roll_; }

  /// One row of the rolled frame below the horizon.
  struct Row {
    double scale = 0;    // m to the side for each px along
    double forward = 0;  // m from the camera's foot, along the ground
    double deep = 0;     // m of ground that one px covers away from the viewer
    // A height of h m above the plane moves what is there by h * down / (depth - h * lean) px below and, at `along`, by
    // along * h * lean / (depth - h * lean) px along.
    double down = 0, depth = 0, lean = 0;
  };
  /// below   greater than horizon().
  Row row(double below) const;

 private:
  cv::Point2d middle_;
  double cos_roll_, sin_roll_, focal_, height_, horizon_;
  double cos_pitch_, sin_pitch_;
};

}  // namespace freshet::synth::scene
