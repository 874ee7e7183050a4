#include "tests/synth/tour/ray_caster.h"

#include <cmath>
#include <limits>

namespace freshet::synth::tour {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kMark = 0.06;  // radius, heights of the camera

struct Ray {
  cv::Vec3d from, way;
};

// Written anew, with no matrix of the engine's: turned about x, then about y.
cv::Vec3d turned(cv::Vec3d v, const CameraPlace& place) {
  const double pitch = place.pitch_deg * CV_PI / 180, yaw = place.yaw_deg * CV_PI / 180;
  v = {v[0], v[1] * std::cos(pitch) - v[2] * std::sin(pitch),
       v[1] * std::sin(pitch) + v[2] * std::cos(pitch)};
  return {v[0] * std::cos(yaw) + v[2] * std::sin(yaw), v[1], -v[0] * std::sin(yaw) + v[2] * std::cos(yaw)};
}
cv::Vec3d turned_back(cv::Vec3d v, const CameraPlace& place) {
  const double pitch = place.pitch_deg * CV_PI / 180, yaw = place.yaw_deg * CV_PI / 180;
  v = {v[0] * std::cos(yaw) - v[2] * std::sin(yaw), v[1], v[0] * std::sin(yaw) + v[2] * std::cos(yaw)};
  return {v[0], v[1] * std::cos(pitch) + v[2] * std::sin(pitch),
          -v[1] * std::sin(pitch) + v[2] * std::cos(pitch)};
}

Ray ray_of(double x, double y, double focal_px, cv::Point2d vanishing, const CameraPlace& place) {
  return {{place.position[0], -place.position[1], place.position[2]},
          turned({(x - (vanishing.x - 0.5)) / focal_px, (y - (vanishing.y - 0.5)) / focal_px, 1}, place)};
}

cv::Vec3f waves(double a, double b, double c) {
  const auto wave = [](double t) { return static_cast<float>(0.5 + 0.3 * std::sin(t)); };
  return {wave(a), wave(b), wave(c)};
}

struct Met {
  double t = kInfinite;
  cv::Vec3f colour{0.2f, 0.2f, 0.2f};
};

Met met_by(const CastScene& scene, const Ray& ray) {
  Met met;
  const auto meet = [&](double t, auto&& colour) {
    if (!(t > 0) || t >= met.t) return;
    const cv::Vec3d p = ray.from + ray.way * t;
    const auto found = colour(p);
    if (found[0] < 0) return;
    met = {t, found};
  };
  const auto marked = [&](const std::vector<cv::Point2d>& marks, double u, double v, cv::Vec3f otherwise) {
    for (const cv::Point2d& mark : marks)
      if (std::hypot(u - mark.x, v - mark.y) < kMark) return cv::Vec3f(1, 1, 1);
    return scene.marks_alone ? cv::Vec3f(0, 0, 0) : otherwise;
  };
  meet((1 - ray.from[1]) / ray.way[1], [&](const cv::Vec3d& p) {
    return marked(scene.floor_marks, p[0], p[2], waves(5 * p[0], 4 * p[2], 3 * (p[0] + p[2])));
  });
  if (std::isfinite(scene.back_depth))
    meet((scene.back_depth - ray.from[2]) / ray.way[2], [&](const cv::Vec3d& p) {
      return marked(scene.back_marks, p[0], p[1], waves(4 * p[0], 3 * p[1], 3 * (p[1] - p[0])));
    });
  else if (met.t == kInfinite) {  // the sky has directions alone
    const cv::Vec3d way = ray.way / ray.way[2];
    met.colour = waves(20 * way[0], 15 * way[1], 12 * (way[0] + way[1]));
  }
  if (scene.half_width > 0)
    for (const double side : {-1.0, 1.0})
      meet((side * scene.half_width - ray.from[0]) / ray.way[0],
           [&](const cv::Vec3d& p) { return waves(3 * p[2], 4 * p[1], 2 * p[2] + p[1]); });
  if (scene.ceiling > 0)
    meet((-scene.ceiling - ray.from[1]) / ray.way[1],
         [&](const cv::Vec3d& p) { return waves(3 * p[0], 3 * p[2], 2 * p[0] - p[2]); });
  for (const CastScene::Board& board : scene.boards)
    meet((board.depth - ray.from[2]) / ray.way[2], [&](const cv::Vec3d& p) {
      const bool on = p[0] > board.left && p[0] < board.right && p[1] < 1 && p[1] > 1 - board.height;
      const cv::Vec3f wave = waves(9 * p[0], 9 * p[1], 6 * (p[0] - p[1]));
      return on ? cv::Vec3f(0.5f * wave[0], 0.2f * wave[1], wave[2]) : cv::Vec3f(-1, 0, 0);
    });
  return met;
}

}  // namespace

cv::Mat cast(const CastScene& scene, cv::Size size, double focal_px, cv::Point2d vanishing,
             const CameraPlace& place, int samples) {
  cv::Mat out(size, CV_32FC3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      cv::Vec3f sum{0, 0, 0};
      for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i)
          sum += met_by(scene, ray_of(x + (i + 0.5) / samples - 0.5, y + (j + 0.5) / samples - 0.5, focal_px,
                                      vanishing, place))
                     .colour;
      out.at<cv::Vec3f>(y, x) = sum / static_cast<float>(samples * samples);
    }
  return out;
}

cv::Mat cast_depth(const CastScene& scene, cv::Size size, double focal_px, cv::Point2d vanishing,
                   const CameraPlace& place) {
  cv::Mat out(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double t = met_by(scene, ray_of(x, y, focal_px, vanishing, place)).t;
      out.at<float>(y, x) = static_cast<float>(std::isfinite(t) ? t : kFar);
    }
  return out;
}

cv::Point2d projected(const cv::Vec3d& point, cv::Size, double focal_px, cv::Point2d vanishing,
                      const CameraPlace& place) {
  const cv::Vec3d v =
      turned_back(point - cv::Vec3d(place.position[0], -place.position[1], place.position[2]), place);
  return {vanishing.x - 0.5 + focal_px * v[0] / v[2], vanishing.y - 0.5 + focal_px * v[1] / v[2]};
}

}  // namespace freshet::synth::tour
