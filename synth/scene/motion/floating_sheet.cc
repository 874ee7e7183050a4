#include "synth/scene/motion/floating_sheet.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "synth/scene/motion/boat_ride.h"

namespace freshet::synth::scene {
namespace {

constexpr double kBeam = 1.0 / 3;      // of the length
constexpr double kMostTilt = 0.5;      // rad
constexpr double kFurthestSide = 1e6;  // px
constexpr double kNearest = 0.05;      // depth in the still over that in the frame, at least

cv::Point2d seen(const cv::Matx33d& picture_from_world, const cv::Vec3d& at) {
  const cv::Vec3d p = picture_from_world * at;
  return {p[0] / p[2], p[1] / p[2]};
}

/// px of a point of the waterplane, in half lengths along and half beams across.
cv::Point2d seen(const WaterCamera& camera, const Waterplane& plane, cv::Point2d at) {
  return seen(camera.picture_from_world(), plane.middle + plane.along * (at.x * plane.length_m / 2) +
                                               plane.across * (at.y * plane.beam_m / 2));
}

cv::Matx33d columns(const cv::Vec3d& a, const cv::Vec3d& b, const cv::Vec3d& c) {
  return {a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]};
}

/// A plane along the hull as it lies: its length, up, and its middle, as columns.
cv::Matx33d standing(const Waterplane& plane, const Attitude& attitude, bool mirrored) {
  const double cp = std::cos(attitude.pitch), sp = std::sin(attitude.pitch), cr = std::cos(attitude.roll),
               sr = std::sin(attitude.roll), cy = std::cos(attitude.yaw), sy = std::sin(attitude.yaw);
  // Rolled about its length, then pitched about its breadth, then turned: in the boat's own frame.
  const cv::Vec3d along(cy * cp, sy * cp, sp), up(sy * sr - cy * sp * cr, -cy * sr - sy * sp * cr, cp * cr);
  const auto in_world = [&](const cv::Vec3d& v) {
    return plane.along * v[0] + plane.across * v[1] + cv::Vec3d(0, 0, mirrored ? -v[2] : v[2]);
  };
  return columns(in_world(along), in_world(up), plane.middle + in_world({0, 0, attitude.heave_m}));
}

}  // namespace

Waterplane waterplane_of(const Line& hull, const WaterCamera& camera) {
  const cv::Point2d middle = (hull.from + hull.to) * 0.5 - cv::Point2d(0.5, 0.5);
  const cv::Point2d at = camera.rolled(middle.x, middle.y);
  const WaterCamera::Row row = camera.row(at.y);
  cv::Point2d way = hull.to - hull.from;
  // In the rolled frame, to the right.
  way = {way.x * camera.roll_cos() + way.y * camera.roll_sin(),
         way.y * camera.roll_cos() - way.x * camera.roll_sin()};
  if (way.x < 0) way = -way;
  const double right = row.scale * std::max(way.x, std::hypot(way.x, way.y) / 2);
  const double away = std::clamp(-row.deep * way.y, -right, right);
  Waterplane plane{.middle = {at.x * row.scale, row.forward, -camera.height_m()},
                   .along = {right, away, 0},
                   .across = {-away, right, 0},
                   .length_m = std::hypot(right, away),
                   .beam_m = kBeam * std::hypot(right, away)};
  plane.along *= 1 / plane.length_m;
  plane.across *= 1 / plane.length_m;
  return plane;
}

HullStations::HullStations(int count) {
  for (int i = 0; i < count; ++i) along_.push_back((2 * i + 1.0) / count - 1);
}

cv::Point2d HullStations::at(std::size_t station, int point) const {
  return {along_[station], breadth(station) * (2.0 * point / (kAcross - 1) - 1)};
}

Attitude HullStations::on(std::span<const double> heights, double length_m, double beam_m) const {
  // Sides and ends are alike: the four terms are orthogonal.
  struct Term {
    double sum = 0, square = 0;
    void add(double term, double weight, double height) {
      sum += weight * term * height;
      square += weight * term * term;
    }
    double slope() const { return sum / square; }
  } heave, pitch, roll, twist;
  for (std::size_t i = 0; i < along_.size(); ++i)
    for (int j = 0; j < kAcross; ++j) {
      const double h = heights[i * kAcross + static_cast<std::size_t>(j)], weight = breadth(i);
      const cv::Point2d p(at(i, j).x * length_m / 2, at(i, j).y * beam_m / 2);
      heave.add(1, weight, h);
      pitch.add(p.x, weight, h);
      roll.add(p.y, weight, h);
      twist.add(p.x * p.y, weight, h);
    }
  const double longest = std::numbers::pi / length_m;  // 1/m, of waves of two lengths
  return {.heave_m = heave.slope(),
          .pitch = std::atan(pitch.slope()),
          .roll = std::atan(roll.slope()),
          .yaw = std::atan(twist.slope() / longest)};
}

bool sees_side(const Waterplane& plane) {
  constexpr double kLeast = 0.01;  // sine
  return std::abs(plane.across.dot(plane.middle)) > kLeast * cv::norm(plane.middle);
}

double breadth_seen(const Waterplane& plane, const Attitude& attitude) {
  double least = 1;
  for (const bool mirrored : {false, true})
    least = std::min(least, cv::determinant(standing(plane, attitude, mirrored)) /
                                cv::determinant(standing(plane, {}, mirrored)));
  return least;
}

Attitude held_broad(const Waterplane& plane, const Attitude& attitude) {
  const auto turned = [&](double share) {
    return Attitude{.heave_m = attitude.heave_m,
                    .pitch = share * attitude.pitch,
                    .roll = share * attitude.roll,
                    .yaw = share * attitude.yaw};
  };
  if (breadth_seen(plane, attitude) >= kLeastBreadth) return attitude;
  double low = 0, high = 1;
  for (int i = 0; i < 24; ++i) {
    const double middle = (low + high) / 2;
    (breadth_seen(plane, turned(middle)) >= kLeastBreadth ? low : high) = middle;
  }
  return turned(low);
}

cv::Matx33d still_from_moved(const WaterCamera& camera, const Waterplane& plane, const Attitude& attitude,
                             bool mirrored) {
  const cv::Matx33d picture_from_world = camera.picture_from_world();
  return picture_from_world * standing(plane, {}, mirrored) *
         (picture_from_world * standing(plane, attitude, mirrored)).inv();
}

cv::Rect waterplane_box(const Waterplane& plane, const WaterCamera& camera) {
  std::vector<cv::Point2f> corners;
  for (const double along : {-1.0, 1.0})
    for (const double across : {-1.0, 1.0}) {
      const cv::Point2d px = seen(camera, plane, {along, across});
      corners.emplace_back(std::clamp(px.x, -kFurthestSide, kFurthestSide),
                           std::clamp(px.y, -kFurthestSide, kFurthestSide));
    }
  const auto [left, right] = std::ranges::minmax(corners, {}, &cv::Point2f::x);
  const auto [top, bottom] = std::ranges::minmax(corners, {}, &cv::Point2f::y);
  const cv::Point first(cvFloor(left.x), cvFloor(top.y)), last(cvCeil(right.x), cvCeil(bottom.y));
  return {first, last + cv::Point(1, 1)};
}

FloatingSheet::FloatingSheet(const BoatMotion& boat, const WaterSurface& water, bool reflection,
                             const cv::Rect& region)
    : boat_(boat),
      water_(&water),
      reflection_(reflection),
      region_(region),
      plane_(waterplane_of(*boat.hull, water.camera())),
      stations_(points_along(*boat.hull)) {
  for (std::size_t i = 0; i < stations_.count(); ++i)
    for (int j = 0; j < HullStations::kAcross; ++j)
      points_.push_back(seen(water.camera(), plane_, stations_.at(i, j)) - cv::Point2d(0.5, 0.5));
  heights_.resize(points_.size());
}

void FloatingSheet::go_to(int) {
  for (std::size_t i = 0; i < points_.size(); ++i) heights_[i] = water_->height(points_[i].x, points_[i].y);
  attitude_ = stations_.on(heights_, plane_.length_m, plane_.beam_m);
  attitude_.heave_m *= boat_.heave;
  for (double* const turn : {&attitude_.pitch, &attitude_.roll, &attitude_.yaw})
    *turn = std::clamp(*turn * boat_.roll, -kMostTilt, kMostTilt);
  attitude_ = held_broad(plane_, attitude_);
  back_ = still_from_moved(water_->camera(), plane_, attitude_, reflection_);
}

float FloatingSheet::reach() const {
  const cv::Point corners[] = {
      region_.tl(), region_.br(), {region_.x, region_.br().y}, {region_.br().x, region_.y}};
  double furthest = 0;
  for (const cv::Point& corner : corners) {
    const cv::Vec3d p = back_ * cv::Vec3d(corner.x, corner.y, 1);
    const double depth = std::max(kNearest, p[2]);
    furthest = std::max({furthest, std::abs(p[0] / depth - corner.x), std::abs(p[1] / depth - corner.y)});
  }
  return static_cast<float>(furthest) + (reflection_ ? water_->reach() : 0) + 1;
}

void FloatingSheet::row(int copy, int x, int y, int n, float* dx, float* dy) const {
  const cv::Vec3d first = back_ * cv::Vec3d(x + 0.5, y + 0.5, 1), step(back_(0, 0), back_(1, 0), back_(2, 0));
  for (int i = 0; i < n; ++i) {
    const double depth = 1 / std::max(kNearest, first[2] + i * step[2]);
    dx[i] = static_cast<float>((first[0] + i * step[0]) * depth - (x + i + 0.5));
    dy[i] = static_cast<float>((first[1] + i * step[1]) * depth - (y + 0.5));
  }
  if (reflection_) add_waves(*water_, copy, x, y, n, dx, dy);
}

}  // namespace freshet::synth::scene
