#include "synth/scene/water/camera.h"

#include <cmath>

namespace freshet::synth::scene {

WaterCamera::WaterCamera(const Line& horizon, double focal_px, double height_m, cv::Size picture)
    : middle_(0.5 * picture.width, 0.5 * picture.height), focal_(focal_px), height_(height_m) {
  // From left to right, whichever way it was drawn: sky above.
  cv::Point2d from = horizon.from, to = horizon.to;
  if (from.x > to.x) std::swap(from, to);
  const cv::Point2d way = to - from;
  const double length = std::hypot(way.x, way.y);
  cos_roll_ = way.x / length;
  sin_roll_ = way.y / length;
  const cv::Point2d at = from - middle_;
  horizon_ = at.y * cos_roll_ - at.x * sin_roll_;
  const double ray = std::hypot(focal_, horizon_);
  sin_pitch_ = -horizon_ / ray;
  cos_pitch_ = focal_ / ray;
}

cv::Matx33d WaterCamera::picture_from_world() const {
  const cv::Matx33d camera_from_world(1, 0, 0, 0, -sin_pitch_, -cos_pitch_, 0, cos_pitch_, -sin_pitch_);
  return cv::Matx33d(cos_roll_, -sin_roll_, middle_.x, sin_roll_, cos_roll_, middle_.y, 0, 0, 1) *
         cv::Matx33d(focal_, 0, 0, 0, focal_, 0, 0, 0, 1) * camera_from_world;
}

WaterCamera::Row WaterCamera::row(double below) const {
  const double fall = below * cos_pitch_ + focal_ * sin_pitch_;  // of a ray, for each focal length of depth
  Row row;
  row.scale = height_ / fall;
  row.forward = row.scale * (focal_ * cos_pitch_ - below * sin_pitch_);
  row.deep = height_ * focal_ / (fall * fall);
  row.down = below * sin_pitch_ - focal_ * cos_pitch_;
  row.depth = row.scale * focal_;
  row.lean = sin_pitch_;
  return row;
}

}  // namespace freshet::synth::scene
