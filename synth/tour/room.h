// synth/tour/room.h — a picture as the inside of a box of planes: the spidery mesh of a tour into the picture.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/tour/camera.h"

namespace freshet::synth::tour {

/// Where the planes meet, px of the picture, (0, 0) its upper left corner.
struct Mesh {
  cv::Size picture;
  cv::Point2d vanishing;             // of all lines that lead straight away from the viewer
  double view_deg = kUsualView_deg;  // how wide the picture's own camera sees, to the side
  /// The back wall. An edge at or beyond the picture's is no edge: that wall is not there, and the planes beside it go
  /// on.
  double left = 0, top = 0, right = 0, bottom = 0;
  bool back = true;  // false: the floor goes on to the horizon, above it everything is infinitely far
};

/// Space: x right, y down, z ahead, from the place of the picture's own camera, in units of its height above the floor.
/// The floor is y = 1.
class Room {
 public:
  /// Throws Error{kInput, where}: a vanishing point outside the back wall, a wall without extent, nothing below the
  /// horizon.
  Room(const Mesh& mesh, const std::string& where);

  /// A plane, or the part of it that the picture does not show because it lies too near, continued by its mirror image.
  struct Side {
    enum class Kind { kFloor, kCeiling, kLeft, kRight, kBack, kSky } kind;
    cv::Vec3d outward{0, 0, 0};  // normal; 0 for the sky
    double distance = 0;         // outward . place of what lies in it
    double nearest = 0;          // z of the nearest of it that the picture shows
  };
  const std::vector<Side>& sides() const { return sides_; }

  /// A side as a camera sees it. Pixels are (x, y, 1), centres at whole numbers.
  struct View {
    cv::Matx33d picture_from_frame;  // homography; its third row is above 0 where the side is seen
    cv::Vec3d inverse_depth;         // . pixel: 1 / depth along the camera's axis; 0 for the sky
    std::vector<cv::Vec3d> limits;   // seen where each . pixel >= 0
  };
  /// Two for each side but the sky and the back: what the picture shows of it, and what is mirrored nearer than that.
  std::vector<View> seen_by(const Pinhole& camera) const;
  /// An upright plane that faces the viewer, at z = depth. It has no limits.
  View board_seen_by(const Pinhole& camera, double depth) const;

  /// The place of the picture that a pixel of the camera shows, in samples (pixel centres at whole numbers), not
  /// mirrored: it may lie outside the picture, and nearer than it shows.
  struct Hit {
    cv::Point2d sample;
    double depth = 0;   // along the camera's axis; kFar: the sky
    bool shown = true;  // by the picture
  };
  Hit hit(const Pinhole& camera, cv::Point2d pixel) const;

  /// Depth of the floor below a row of the picture. infinite: at the horizon and above.
  double floor_depth(double row) const;
  /// px of the picture, of a thing of height 1 at depth 1.
  double focal_px() const { return focal_; }
  cv::Size picture() const { return mesh_.picture; }
  const Mesh& mesh() const { return mesh_; }
  /// Depth of the nearest floor that the picture shows, and of the back wall (infinite where there is none).
  double nearest_floor() const;
  double back_depth() const { return back_depth_; }
  /// The picture's own camera, for frames of a size; frame (0, 0) shows what the picture's (0, 0) does when it has its
  /// size.
  Pinhole own_camera(cv::Size frame) const;
  /// A camera elsewhere.
  Pinhole camera(const CameraPlace& place, cv::Size frame, const Narrowing& narrowed = {}) const;
  /// Nothing where it is inside the box, else the fault, for a person.
  std::string fault_of(const cv::Vec3d& position) const;

 private:
  Mesh mesh_;
  double focal_ = 1, x_ = 0, y_ = 0;  // px; the vanishing point in samples
  double back_depth_ = 1;
  std::vector<Side> sides_;
};

}  // namespace freshet::synth::tour
