#include "synth/scene/motion/boat_ride.h"

#include <algorithm>
#include <cmath>

namespace freshet::synth::scene {
namespace {

constexpr int kRun = 256;

}  // namespace

int points_along(const Line& hull) {
  constexpr double kPointsApart = 3;  // px; shorter waves lift no boat
  constexpr int kFewest = 8, kMost = 512;
  const cv::Point2d way = hull.to - hull.from;
  return std::clamp(static_cast<int>(std::hypot(way.x, way.y) / kPointsApart), kFewest, kMost);
}

Ride ride_of(std::span<const cv::Point2d> points, std::span<const cv::Point2d> displaced) {
  const auto count = static_cast<double>(points.size());
  cv::Point2d middle{}, moved{};
  for (const cv::Point2d& p : points) middle += p * (1 / count);
  for (const cv::Point2d& p : displaced) moved += p * (1 / count);
  const cv::Point2d ends = points.back() - points.front();
  const cv::Point2d way = ends * (1 / std::hypot(ends.x, ends.y)), across(-way.y, way.x);
  double covariance = 0, variance = 0;
  for (const cv::Point2d& p : displaced) {
    const cv::Point2d off = p - moved;
    covariance += off.dot(way) * off.dot(across);
    variance += off.dot(way) * off.dot(way);
  }
  return {.heave = moved - middle, .roll = variance > 0 ? std::atan2(covariance, variance) : 0};
}

void add_waves(const WaterSurface& water, int copy, int x, int y, int n, float* dx, float* dy) {
  float wave_x[kRun], wave_y[kRun];
  for (int first = 0; first < n; first += kRun) {
    const int count = std::min(kRun, n - first);
    water.row(copy, x + first, y, count, wave_x, wave_y);
    for (int i = 0; i < count; ++i) {
      dx[first + i] += wave_x[i];
      dy[first + i] += wave_y[i];
    }
  }
}

BoatRide::BoatRide(const BoatMotion& boat, const WaterSurface& water, bool reflection, const cv::Rect& region)
    : boat_(boat), water_(&water), reflection_(reflection), region_(region) {
  const cv::Point2d from = boat.hull->from, way = boat.hull->to - from;
  const int count = points_along(*boat.hull);
  for (int i = 0; i < count; ++i) points_.push_back(from + way * (i / (count - 1.0)));
  displaced_ = points_;
  middle_ = from + way * 0.5;
}

void BoatRide::go_to(int) {
  for (std::size_t i = 0; i < points_.size(); ++i)
    displaced_[i] = points_[i] + water_->displacement(points_[i].x - 0.5, points_[i].y - 0.5);
  ride_ = ride_of(points_, displaced_);
  const double mirrored = reflection_ ? -1 : 1;
  ride_.heave *= boat_.heave * mirrored;
  ride_.roll *= boat_.roll * mirrored;
}

float BoatRide::reach() const {
  const cv::Point2d corners[] = {region_.tl(),
                                 region_.br(),
                                 {1.0 * region_.x, 1.0 * region_.br().y},
                                 {1.0 * region_.br().x, 1.0 * region_.y}};
  double furthest = 0;
  for (const cv::Point2d& corner : corners)
    furthest = std::max(furthest, std::hypot(corner.x - middle_.x, corner.y - middle_.y));
  const double own = std::hypot(ride_.heave.x, ride_.heave.y) + furthest * std::abs(ride_.roll);
  return static_cast<float>(own) + (reflection_ ? water_->reach() : 0) + 1;
}

void BoatRide::row(int copy, int x, int y, int n, float* dx, float* dy) const {
  const auto c = static_cast<float>(std::cos(ride_.roll)), s = static_cast<float>(std::sin(ride_.roll));
  const cv::Point2f from(cv::Point2d(x + 0.5, y + 0.5) - middle_ - ride_.heave);
  const cv::Point2f heave(ride_.heave);
  for (int i = 0; i < n; ++i) {
    const float u = from.x + static_cast<float>(i), v = from.y;
    dx[i] = u * c + v * s - u - heave.x;
    dy[i] = v * c - u * s - v - heave.y;
  }
  if (reflection_) add_waves(*water_, copy, x, y, n, dx, dy);
}

}  // namespace freshet::synth::scene
