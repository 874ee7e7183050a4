#include "synth/tour/room.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::synth::tour {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kClearance = 0.02;  // heights of the camera that it keeps from each plane

double radians(double degrees) { return degrees * CV_PI / 180; }

const char* name_of(Room::Side::Kind kind) {
  using Kind = Room::Side::Kind;
  switch (kind) {
    case Kind::kFloor:
      return "below the floor";
    case Kind::kCeiling:
      return "above the ceiling";
    case Kind::kLeft:
      return "beyond the left wall";
    case Kind::kRight:
      return "beyond the right wall";
    case Kind::kBack:
      return "behind the back wall";
    case Kind::kSky:
      break;
  }
  return "";
}

}  // namespace

Room::Room(const Mesh& mesh, const std::string& where) : mesh_(mesh) {
  const double width = mesh.picture.width, height = mesh.picture.height;
  const auto refuse = [&](const std::string& fault, const std::string& remedy) {
    throw Error(ErrorKind::kInput, where, fault, remedy);
  };
  for (const double each : {mesh.vanishing.x, mesh.vanishing.y, mesh.left, mesh.top, mesh.right, mesh.bottom})
    if (!std::isfinite(each)) refuse("the mesh has a number that is not finite", "Give px of the picture");
  if (!(mesh.view_deg >= 1 && mesh.view_deg <= 150))
    refuse(fmt::format("a view of {} degrees", mesh.view_deg), "Give 1 to 150");
  focal_ = 0.5 * width / std::tan(0.5 * radians(mesh.view_deg));
  x_ = mesh.vanishing.x - 0.5;
  y_ = mesh.vanishing.y - 0.5;
  const double horizon = mesh.vanishing.y;
  if (!(horizon > -10 * height && horizon <= height - 1))
    refuse(fmt::format("the horizon lies in row {:.6g}, and the picture has {} rows: nothing of it is floor",
                       horizon, height),
           "Give a row above the picture's lower edge");
  if (mesh.back) {
    if (!(mesh.right - mesh.left >= 1 && mesh.bottom - mesh.top >= 1))
      refuse(
          fmt::format("the back wall is {:.6g} x {:.6g} px", mesh.right - mesh.left, mesh.bottom - mesh.top),
          "Give left, top, right and bottom, at least 1 px apart");
    if (!(mesh.bottom - horizon >= 0.5))
      refuse(fmt::format("the back wall ends in row {:.6g}, not below the horizon, {:.6g}", mesh.bottom,
                         horizon),
             "Give a back wall whose lower edge is below the horizon, or a higher horizon");
    back_depth_ = focal_ / (mesh.bottom - horizon);
  } else {
    back_depth_ = kInfinite;
  }
  const auto add = [&](Side::Kind kind, cv::Vec3d outward, double distance, double nearest) {
    sides_.push_back({kind, outward, distance, nearest});
  };
  // The lower edge of the picture shows the nearest floor.
  const double below = height - horizon;
  add(Side::Kind::kFloor, {0, 1, 0}, 1, focal_ / below);
  if (mesh.back) {
    const auto wall = [&](Side::Kind kind, cv::Vec3d outward, double px, double edge_px, const char* side) {
      if (!(px > 0))
        refuse(fmt::format("the vanishing point ({:.6g}, {:.6g}) is not inside the back wall: it lies beyond "
                           "its {} edge",
                           mesh.vanishing.x, mesh.vanishing.y, side),
               "Move the vanishing point or the wall");
      const double distance = px * back_depth_ / focal_;
      add(kind, outward, distance, focal_ * distance / edge_px);
    };
    if (mesh.top > 0) wall(Side::Kind::kCeiling, {0, -1, 0}, horizon - mesh.top, horizon, "upper");
    if (mesh.left > 0)
      wall(Side::Kind::kLeft, {-1, 0, 0}, mesh.vanishing.x - mesh.left, mesh.vanishing.x, "left");
    if (mesh.right < width)
      wall(Side::Kind::kRight, {1, 0, 0}, mesh.right - mesh.vanishing.x, width - mesh.vanishing.x, "right");
    add(Side::Kind::kBack, {0, 0, 1}, back_depth_, 0);
  } else {
    add(Side::Kind::kSky, {0, 0, 0}, 1, 0);
  }
}

double Room::nearest_floor() const { return sides_.front().nearest; }

double Room::floor_depth(double row) const {
  const double below = row - mesh_.vanishing.y;
  return below > 0 ? focal_ / below : kInfinite;
}

Pinhole Room::own_camera(cv::Size frame) const { return camera({}, frame); }

Pinhole Room::camera(const CameraPlace& place, cv::Size frame, const Narrowing& narrowed) const {
  const double view = place.view_deg > 0 ? place.view_deg : mesh_.view_deg;
  const double wide = 0.5 * frame.width / std::tan(0.5 * radians(view)), focal = wide / narrowed.share;
  // Frames are shifted against the camera's axis as the picture is: looking straight ahead the axis meets the vanishing
  // point, and what the picture's middle shows stays in the frame's, however wide the view; or what its anchor shows.
  const double shift_x = (0.5 * (mesh_.picture.width - 1) - x_) / focal_,
               shift_y = (0.5 * (mesh_.picture.height - 1) - y_) / focal_ +
                         (narrowed.anchor - 0.5) * frame.height * (1 / wide - 1 / focal);
  const cv::Matx33d inverse(1 / focal, 0, shift_x - 0.5 * (frame.width - 1) / focal,   //
                            0, 1 / focal, shift_y - 0.5 * (frame.height - 1) / focal,  //
                            0, 0, 1);
  const double yaw = radians(place.yaw_deg), pitch = radians(place.pitch_deg);
  const cv::Matx33d turned(std::cos(yaw), 0, std::sin(yaw), 0, 1, 0, -std::sin(yaw), 0, std::cos(yaw));
  const cv::Matx33d tilted(1, 0, 0, 0, std::cos(pitch), -std::sin(pitch), 0, std::sin(pitch),
                           std::cos(pitch));
  const cv::Matx33d rotation = turned * tilted;
  return {.frame = frame,
          .centre = {place.position[0], -place.position[1], place.position[2]},
          .ray_of_pixel = rotation * inverse,
          .axis = rotation * cv::Vec3d(0, 0, 1)};
}

std::string Room::fault_of(const cv::Vec3d& position) const {
  for (const Side& side : sides_) {
    if (side.kind == Side::Kind::kSky) continue;
    const double room = side.distance - side.outward.dot({position[0], -position[1], position[2]});
    if (!(room >= kClearance))
      return fmt::format("the camera at [{:.4g}, {:.4g}, {:.4g}] is {} or touches it", position[0],
                         position[1], position[2], name_of(side.kind));
  }
  return "";
}

std::vector<Room::View> Room::seen_by(const Pinhole& camera) const {
  const cv::Matx33d from_space(focal_, 0, x_, 0, focal_, y_, 0, 0, 1);
  std::vector<cv::Vec3d> nearness;  // 1 / depth of each side
  for (const Side& side : sides_)
    nearness.push_back(camera.ray_of_pixel.t() * side.outward *
                       (1 / (side.distance - side.outward.dot(camera.centre))));
  std::vector<View> views;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Side& side = sides_[i];
    const cv::Vec3d& q = nearness[i];
    // A place times 1 / depth.
    cv::Matx33d place = camera.ray_of_pixel;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) place(r, c) += camera.centre[r] * q[c];
    View view{from_space * place, q, {}};
    // Seen is the side that the ray meets first.
    for (std::size_t k = 0; k < sides_.size(); ++k)
      if (k != i) view.limits.push_back(q - nearness[k]);
    if (side.kind == Side::Kind::kBack || side.kind == Side::Kind::kSky) {
      views.push_back(view);
      continue;
    }
    const cv::Vec3d ahead(place(2, 0), place(2, 1), place(2, 2));
    View mirrored = view;
    view.limits.push_back(ahead - side.nearest * q);
    mirrored.limits.push_back(side.nearest * q - ahead);
    cv::Matx33d folded = place;
    for (int c = 0; c < 3; ++c) folded(2, c) = 2 * side.nearest * q[c] - ahead[c];
    mirrored.picture_from_frame = from_space * folded;
    views.push_back(view);
    views.push_back(mirrored);
  }
  return views;
}

Room::View Room::board_seen_by(const Pinhole& camera, double depth) const {
  const cv::Matx33d from_space(focal_, 0, x_, 0, focal_, y_, 0, 0, 1);
  const cv::Vec3d q = camera.ray_of_pixel.t() * cv::Vec3d(0, 0, 1) * (1 / (depth - camera.centre[2]));
  cv::Matx33d place = camera.ray_of_pixel;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) place(r, c) += camera.centre[r] * q[c];
  return {from_space * place, q, {}};
}

Room::Hit Room::hit(const Pinhole& camera, cv::Point2d pixel) const {
  const cv::Vec3d ray = camera.ray_of_pixel * cv::Vec3d(pixel.x, pixel.y, 1);
  double nearness = 0;
  const Side* met = nullptr;
  for (const Side& side : sides_) {
    const double each = side.outward.dot(ray) / (side.distance - side.outward.dot(camera.centre));
    if (each > nearness) nearness = each, met = &side;
  }
  const cv::Vec3d place = met == nullptr ? ray : camera.centre + ray * (1 / nearness);
  const bool shown = place[2] > 0 && (met == nullptr || place[2] >= met->nearest * (1 - 1e-9));
  const double z = place[2] > 1e-9 ? place[2] : 1e-9;
  return {
      {x_ + focal_ * place[0] / z, y_ + focal_ * place[1] / z}, met == nullptr ? kFar : 1 / nearness, shown};
}

}  // namespace freshet::synth::tour
