#include "synth/scene/water/camera.h"

#include <cmath>

#include <gtest/gtest.h>

namespace freshet::synth::scene {
namespace {

const cv::Size kPicture(900, 675);

/// A pinhole camera by its matrix, in the picture's frame: x right, y down, z into the picture; the plane lies `height`
/// below it. Slow and obvious: it turns the world, and knows nothing of rows.
class Pinhole {
 public:
  Pinhole(double roll, double pitch, double focal) : focal_(focal) {
    const cv::Matx33d tilt(1, 0, 0, 0, std::cos(pitch), -std::sin(pitch), 0, std::sin(pitch),
                           std::cos(pitch));
    const cv::Matx33d turn(std::cos(roll), -std::sin(roll), 0, std::sin(roll), std::cos(roll), 0, 0, 0, 1);
    camera_from_world_ = turn * tilt;
  }
  cv::Point2d project(const cv::Vec3d& world) const {
    const cv::Vec3d c = camera_from_world_ * world;
    return {focal_ * c[0] / c[2] + 0.5 * kPicture.width, focal_ * c[1] / c[2] + 0.5 * kPicture.height};
  }
  /// Where the ray of a point of the picture meets the plane y = height.
  cv::Vec3d on_plane(cv::Point2d p, double height) const {
    const cv::Vec3d ray = camera_from_world_.t() * cv::Vec3d((p.x - 0.5 * kPicture.width) / focal_,
                                                             (p.y - 0.5 * kPicture.height) / focal_, 1);
    return ray * (height / ray[1]);
  }
  Line horizon() const {
    const cv::Point2d left = project({-1e7, 0, 1e7}), right = project({1e7, 0, 1e7});
    return {left, right};
  }

 private:
  double focal_;
  cv::Matx33d camera_from_world_;
};

TEST(WaterCamera, LiftsPointsAsAPinholeCameraDoes) {
  for (const double roll : {0.0, 0.1, -0.25}) {
    for (const double pitch : {0.0, 0.15, -0.1}) {
      const double focal = 1000, height = 2.5;
      const Pinhole pinhole(roll, pitch, focal);
      const WaterCamera camera(pinhole.horizon(), focal, height, kPicture);
      int seen = 0;
      for (int y = 20; y < kPicture.height; y += 40) {
        for (int x = 10; x < kPicture.width; x += 80) {
          const cv::Point2d rolled = camera.rolled(x, y);
          if (rolled.y < camera.horizon() + 5) continue;
          ++seen;
          const WaterCamera::Row row = camera.row(rolled.y);
          for (const double h : {0.05, -0.1, 0.4}) {
            const cv::Point2d p(x + 0.5, y + 0.5);
            cv::Vec3d world = pinhole.on_plane(p, height);
            EXPECT_NEAR(world[2], row.forward, 1e-5 * std::abs(row.forward));
            EXPECT_NEAR(world[0], row.scale * rolled.x, 1e-5 * std::abs(row.forward));
            world[1] -= h;
            const cv::Point2d expected = pinhole.project(world) - p;
            const double over = h / (row.depth - h * row.lean);
            const cv::Point2d found = camera.upright({rolled.x * over * row.lean, over * row.down});
            EXPECT_NEAR(found.x, expected.x, 1e-3 + 1e-4 * std::abs(expected.x));
            EXPECT_NEAR(found.y, expected.y, 1e-3 + 1e-4 * std::abs(expected.y));
          }
        }
      }
      EXPECT_GT(seen, 20);
    }
  }
}

TEST(WaterCamera, TellsHowMuchWaterAPixelCovers) {
  const WaterCamera camera({{0, 200}, {900, 200}}, 1000, 2, kPicture);
  for (const double below : {camera.horizon() + 5, camera.horizon() + 50, camera.horizon() + 400}) {
    const double step = 1e-3;
    const double covers = (camera.row(below - step).forward - camera.row(below + step).forward) / (2 * step);
    EXPECT_NEAR(camera.row(below).deep, covers, 1e-4 * covers);
  }
}

TEST(WaterCamera, DoesNotMindWhichWayTheHorizonWasDrawn) {
  const WaterCamera forth({{0, 200}, {900, 260}}, 1000, 2, kPicture),
      back({{900, 260}, {0, 200}}, 1000, 2, kPicture);
  EXPECT_DOUBLE_EQ(forth.horizon(), back.horizon());
  EXPECT_DOUBLE_EQ(forth.rolled(10, 500).y, back.rolled(10, 500).y);
}

}  // namespace
}  // namespace freshet::synth::scene
