#include "ingest/steady.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace freshet::ingest {
namespace {

constexpr double kInset = 1.5;  // px of the source, at the crop's borders: half of what the resampling reads

/// What a frame shows of the scene, as far as it is a rectangle.
struct Bounds {
  double left = -1e9, top = -1e9, right = 1e9, bottom = 1e9;

  /// frame_from_scene   of a frame of that size.
  void cut(const cv::Matx33d& frame_from_scene, cv::Size size) {
    const cv::Matx33d scene_from_frame = frame_from_scene.inv();
    const auto at = [&](double x, double y) { return scene_from_frame * cv::Vec3d(x, y, 1); };
    const double w = size.width - 1, h = size.height - 1;
    const cv::Vec3d a = at(0, 0), b = at(w, 0), c = at(0, h), d = at(w, h);
    left = std::max({left, a[0], c[0]});
    right = std::min({right, b[0], d[0]});
    top = std::max({top, a[1], b[1]});
    bottom = std::min({bottom, c[1], d[1]});
  }
};

/// Of each frame but the last one's last, where the points are that the first frame shows.
std::vector<cv::Matx33d> poses_of(std::span<const CameraWindow> windows) {
  std::vector<cv::Matx33d> poses;
  cv::Matx33d before = cv::Matx33d::eye();
  for (const CameraWindow& window : windows) {
    for (std::size_t t = 0; t + 1 < window.path.size(); ++t) poses.push_back(window.path[t] * before);
    before = window.path.back() * before;
  }
  return poses;
}

}  // namespace

SteadyRun steady_run(std::span<const CameraWindow> windows, cv::Size working, const SteadyLimits& limits) {
  SteadyRun run;
  Bounds bounds;
  const double diagonal = std::hypot(working.width, working.height);
  cv::Matx33d before = cv::Matx33d::eye();
  for (const CameraWindow& window : windows) {
    if (!window.referenced) {
      run.refusal = "it cannot be made steady: too little that is solid is seen";
      break;
    }
    const cv::Vec3d centre(working.width / 2.0, working.height / 2.0, 1);
    double squares = 0;
    for (std::size_t t = 0; t < window.path.size(); ++t) {
      bounds.cut(window.path[t] * before, working);
      if (t > 0) squares += std::pow(cv::norm(window.path[t] * centre - window.path[t - 1] * centre), 2);
    }
    const double step = std::sqrt(squares / static_cast<double>(window.path.size() - 1)) / diagonal;
    if (step > limits.max_step) {
      run.refusal = fmt::format(
          "it cannot be made steady: the camera moves by {:.1f} % of the frame's diagonal from frame to "
          "frame, so that "
          "they are blurred; {:.1f} % is the limit",
          100 * step, 100 * limits.max_step);
      break;
    }
    if (bounds.right - bounds.left < limits.min_kept * working.width ||
        bounds.bottom - bounds.top < limits.min_kept * working.height) {
      run.refusal =
          fmt::format("it cannot be made steady: its frames have less than {:.0f} % of a side in common",
                      100 * limits.min_kept);
      break;
    }
    before = window.path.back() * before;
    ++run.windows;
  }
  return run;
}

SteadyPath steady_path(std::span<const CameraWindow> windows, cv::Size working, cv::Size source) {
  std::vector<cv::Matx33d> poses = poses_of(windows);
  SteadyPath path;
  // The frame in the middle stays where it is. Pixel centres lie at whole numbers.
  const double sx = static_cast<double>(source.width) / working.width,
               sy = static_cast<double>(source.height) / working.height;
  const cv::Matx33d source_from_working(sx, 0, (sx - 1) / 2, 0, sy, (sy - 1) / 2, 0, 0, 1);
  const cv::Matx33d middle = poses[poses.size() / 2].inv();
  Bounds bounds;
  for (cv::Matx33d& pose : poses) {
    pose = source_from_working * pose * middle * source_from_working.inv();
    bounds.cut(pose, source);
  }
  const auto even_up = [](double value) { return 2 * static_cast<int>(std::ceil((value + kInset) / 2)); };
  const auto even_down = [](double value) {
    return 2 * static_cast<int>(std::floor((value + 1 - kInset) / 2));
  };
  // A side that nothing crosses is kept to its last pixel.
  const int left = bounds.left <= 0 ? 0 : even_up(bounds.left),
            top = bounds.top <= 0 ? 0 : even_up(bounds.top);
  const int right = std::max(left + 2, even_down(bounds.right)),
            bottom = std::max(top + 2, even_down(bounds.bottom));
  path.size = {right - left, bottom - top};
  path.kept = static_cast<double>(path.size.area()) / source.area();
  const cv::Matx33d uncropped(1, 0, left, 0, 1, top, 0, 0, 1);
  for (const cv::Matx33d& pose : poses) {
    const cv::Matx33d m = pose * uncropped;
    path.source_from_steady.emplace_back(m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2));
  }
  return path;
}

}  // namespace freshet::ingest
