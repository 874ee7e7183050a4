// Boats in three dimensions, against a pinhole camera that knows nothing of homographies.
#include "synth/scene/motion/floating_sheet.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "synth/scene/wind/gusts.h"

namespace freshet::synth::scene {
namespace {

const Cycle kSailing{.frames = 60, .fps = 20};
const cv::Size kSeen(320, 240);
constexpr double kSeenFocal = 384, kSeenFrom = 0.8;

/// World: m right, away and up from the camera, which is pitched by `pitch` and rolled by `roll`.
class PlainCamera {
 public:
  PlainCamera(double roll, double pitch) : roll_(roll), pitch_(pitch) {}
  cv::Point2d project(const cv::Vec3d& p) const {
    const double down = -p[2], below = down * std::cos(pitch_) - p[1] * std::sin(pitch_),
                 depth = down * std::sin(pitch_) + p[1] * std::cos(pitch_);
    const double x = kSeenFocal * p[0] / depth, y = kSeenFocal * below / depth;
    return {x * std::cos(roll_) - y * std::sin(roll_) + kSeen.width / 2.0,
            x * std::sin(roll_) + y * std::cos(roll_) + kSeen.height / 2.0};
  }
  Line horizon() const { return {project({-1e6, 1e6, 0}), project({1e6, 1e6, 0})}; }

 private:
  double roll_, pitch_;
};

cv::Vec3d turned(const cv::Vec3d& v, const cv::Vec3d& axis, double angle) {
  const double c = std::cos(angle);
  return v * c + axis.cross(v) * std::sin(angle) + axis * (axis.dot(v) * (1 - c));
}

/// Of a point of the sheet, m along and up from the hull's middle, where it has gone to.
cv::Vec3d gone(const Waterplane& plane, const Attitude& attitude, double along, double up) {
  cv::Vec3d p = plane.along * along + cv::Vec3d(0, 0, up);
  p = turned(p, plane.along, attitude.roll);
  p = turned(p, plane.across, -attitude.pitch);
  p = turned(p, {0, 0, 1}, attitude.yaw);
  return plane.middle + p + cv::Vec3d(0, 0, attitude.heave_m);
}

TEST(FloatingSheet, GoesWhereAPinholeCameraSeesItsPoints) {
  for (const double roll : {0.0, 0.15}) {
    const PlainCamera pinhole(roll, 0.1);
    const WaterCamera camera(pinhole.horizon(), kSeenFocal, kSeenFrom, kSeen);
    const Attitude attitude{.heave_m = 0.04, .pitch = 0.1, .roll = -0.2, .yaw = 0.15};
    for (const Line& hull : {Line{{90, 190}, {200, 190}}, Line{{260, 200}, {180, 192}}}) {
      const Waterplane plane = waterplane_of(hull, camera);
      for (const bool mirrored : {false, true}) {
        const cv::Matx33d back = still_from_moved(camera, plane, attitude, mirrored);
        const auto in_mirror = [&](cv::Vec3d p) {
          if (mirrored) p[2] = -2 * kSeenFrom - p[2];
          return p;
        };
        for (double along = -0.3; along < 0.31; along += 0.15)
          for (double up = -0.05; up < 0.5; up += 0.1) {
            const cv::Point2d still = pinhole.project(in_mirror(gone(plane, {}, along, up))),
                              moved = pinhole.project(in_mirror(gone(plane, attitude, along, up)));
            const cv::Vec3d found = back * cv::Vec3d(moved.x, moved.y, 1);
            EXPECT_NEAR(found[0] / found[2], still.x, 1e-6);
            EXPECT_NEAR(found[1] / found[2], still.y, 1e-6);
            EXPECT_GT(std::hypot(still.x - moved.x, still.y - moved.y), 0.5);
          }
      }
    }
  }
}

TEST(FloatingSheet, StandsOnTheWaterBelowItsHullLine) {
  const PlainCamera pinhole(0.15, 0.1);
  const WaterCamera camera(pinhole.horizon(), kSeenFocal, kSeenFrom, kSeen);
  const cv::Vec3d from(-0.2, 2.0, -kSeenFrom), to(0.4, 2.1, -kSeenFrom);
  const Line hull{pinhole.project(to), pinhole.project(from)};  // drawn from right to left
  const Waterplane plane = waterplane_of(hull, camera);
  // The line's ends lie where its length says, to the first order of its depth.
  EXPECT_LT(cv::norm(plane.middle - (from + to) * 0.5), 0.01);
  EXPECT_LT(cv::norm(plane.along - cv::normalize(to - from)), 0.03);
  EXPECT_NEAR(plane.length_m, cv::norm(to - from), 0.01);
  EXPECT_NEAR(plane.across.dot(plane.along), 0, 1e-9);
  EXPECT_GT(plane.across[1], 0);
  // However steeply it is drawn, it turns by 45 degrees at most.
  const Waterplane steep = waterplane_of({{160, 180}, {170, 230}}, camera);
  EXPECT_NEAR(std::abs(steep.along[0]), std::abs(steep.along[1]), 1e-9);
}

/// On a surface over m along and across.
Attitude on_surface(double length, double beam, const std::function<double(double, double)>& height) {
  const HullStations stations(64);
  std::vector<double> heights;
  for (std::size_t i = 0; i < stations.count(); ++i)
    for (int j = 0; j < HullStations::kAcross; ++j) {
      const cv::Point2d at = stations.at(i, j);
      heights.push_back(height(at.x * length / 2, at.y * beam / 2));
    }
  return stations.on(heights, length, beam);
}

TEST(HullStations, LieAsTheSurfaceDoes) {
  const Attitude found =
      on_surface(6, 2, [](double u, double v) { return 0.3 + 0.1 * u - 0.2 * v + 0.05 * u * v; });
  EXPECT_NEAR(found.heave_m, 0.3, 1e-9);
  EXPECT_NEAR(std::tan(found.pitch), 0.1, 1e-9);
  EXPECT_NEAR(std::tan(found.roll), -0.2, 1e-9);
  EXPECT_GT(found.yaw, 0.05);
}

TEST(HullStations, ShortWavesMoveNoBoatAndLongOnesCarryIt) {
  const double length = 6, beam = 2;
  const auto waves = [&](double wavelength) {
    const double k = 2 * std::numbers::pi / wavelength;
    return on_surface(length, beam, [&](double u, double) { return std::cos(k * u) + std::sin(k * u); });
  };
  const Attitude in_short = waves(length / 2), in_long = waves(20 * length);
  EXPECT_LT(std::abs(in_short.heave_m), 0.12);
  EXPECT_LT(std::abs(std::tan(in_short.pitch)),
            0.12 * 4 * std::numbers::pi / length);  // of the slope's amplitude
  EXPECT_NEAR(in_long.heave_m, 1, 0.02);
  EXPECT_NEAR(std::tan(in_long.pitch), 2 * std::numbers::pi / (20 * length), 0.002);
}

TEST(HullStations, YawAsTheWaterGoesAtBothEnds) {
  // Waves of two lengths at 45 degrees: where the crest is, water has gone along slope / k at each place.
  const double length = 6, beam = 0.6, k = std::numbers::pi / length, across = k * std::sqrt(0.5);
  const double height = 0.05;
  const auto surface = [&](double u, double v) { return -height * std::cos(across * (u + v)); };
  const Attitude found = on_surface(length, beam, surface);
  // To the side: d height / d v / k. The line through it along the hull, weighed by the breadth.
  double sum = 0, square = 0;
  for (double u = -0.4995; u < 0.5; u += 0.001) {
    const double weight = 1 - 4 * u * u, at = u * length;
    sum += std::pow(weight, 3) * at * height * across / k * std::sin(across * at);
    square += std::pow(weight, 3) * at * at;
  }
  EXPECT_NEAR(std::tan(found.yaw), sum / square, 0.02 * sum / square);
  EXPECT_GT(found.yaw, 0.005);
}

WaterMotion open_water(double roughness) {
  return {.horizon = Line{{0, 60}, {320, 60}},
          .focal_px = kSeenFocal,
          .camera_height_m = kSeenFrom,
          .tile = 64,
          .roughness = roughness,
          .amplitude = 2};
}

TEST(FloatingSheet, RidesOnTheHeightsBelowItAndStaysWithinItsReach) {
  const Gusts gusts({}, kSailing, kSeen.width);
  const BoatMotion boat{.hull = Line{{110, 150}, {190, 152}}, .in_3d = true};
  const cv::Rect region(90, 60, 120, 100);
  for (const WaterMapping mapping : {WaterMapping::kDisplacement, WaterMapping::kNormals}) {
    WaterMotion water = open_water(4);
    water.mapping = mapping;
    const WaterCamera camera(*water.horizon, kSeenFocal, kSeenFrom, kSeen);
    const Waterplane plane = waterplane_of(*boat.hull, camera);
    WaterSurface surface(water, gusts, kSailing, 3, {0, 61, 320, 179}, kSeen, waterplane_box(plane, camera));
    FloatingSheet sheet(boat, surface, false, region), mirror(boat, surface, true, region);
    double heaves = 0, most = 0;
    std::vector<float> dx(120), dy(120);
    for (int frame = 0; frame < kSailing.frames; frame += 6) {
      surface.go_to(frame);
      sheet.go_to(frame);
      // The mean height of what lies below it, asked anew.
      double sum = 0, count = 0;
      for (double u = -0.95; u < 1; u += 0.1)
        for (double v = -0.9; v < 1; v += 0.3) {
          const cv::Vec3d p = plane.middle + plane.along * (u * plane.length_m / 2) +
                              plane.across * (v * (1 - u * u) * plane.beam_m / 2);
          const cv::Vec3d px = camera.picture_from_world() * p;
          sum += (1 - u * u) * surface.height(px[0] / px[2] - 0.5, px[1] / px[2] - 0.5), count += 1 - u * u;
        }
      EXPECT_NEAR(sheet.attitude().heave_m, sum / count, 0.2 * std::abs(sum / count) + 1e-4);
      heaves = std::max(heaves, std::abs(sum / count));
      for (int y = region.y; y < region.br().y; y += 9) {
        sheet.row(0, region.x, y, region.width, dx.data(), dy.data());
        for (std::size_t i = 0; i < dx.size(); ++i) {
          ASSERT_LE(std::max(std::abs(dx[i]), std::abs(dy[i])), sheet.reach());
          most = std::max({most, 1.0 * std::abs(dx[i]), 1.0 * std::abs(dy[i])});
        }
      }
    }
    EXPECT_GT(heaves, 0.002);
    EXPECT_GT(most, 1);
    // Its mirror image is that of the boat, moved by the waves besides.
    mirror.go_to(54);
    const auto at = [](const Motion& motion, int x, int y) {
      float u = 0, v = 0;
      motion.row(0, x, y, 1, &u, &v);
      return cv::Point2d(u, v);
    };
    const cv::Point2d down = at(mirror, 150, 156) - at(surface, 150, 156);
    const cv::Vec3d shown =
        still_from_moved(camera, plane, sheet.attitude(), true) * cv::Vec3d(150.5, 156.5, 1);
    EXPECT_NEAR(down.x, shown[0] / shown[2] - 150.5, 1e-4);
    EXPECT_NEAR(down.y, shown[1] / shown[2] - 156.5, 1e-4);
    EXPECT_LT(down.y * at(sheet, 150, 146).y, 0);
  }
}

TEST(FloatingSheet, TurnsNoFurtherThanTheCameraSeesItsSide) {
  const PlainCamera pinhole(0, 0.1);
  const WaterCamera camera(pinhole.horizon(), kSeenFocal, kSeenFrom, kSeen);
  // Turned by 45 degrees, and 21 degrees aside: a yaw of 24 more shows its edge.
  const BoatMotion boat{.hull = Line{{300, 236}, {312, 180}}, .roll = 100, .in_3d = true};
  const Waterplane plane = waterplane_of(*boat.hull, camera);
  EXPECT_GT(breadth_seen(plane, {.yaw = 0.3}), kLeastBreadth);
  EXPECT_LT(breadth_seen(plane, {.yaw = 0.5}), 0);
  EXPECT_EQ(held_broad(plane, {.pitch = 0.1, .yaw = 0.3}).yaw, 0.3);
  double before = 0;
  for (double yaw = 0.01; yaw < 0.5; yaw += 0.01) {
    const Attitude held = held_broad(plane, {.heave_m = 0.02, .pitch = 0.2 * yaw, .roll = -yaw, .yaw = yaw});
    EXPECT_GE(held.yaw, before - 1e-6);
    EXPECT_LE(held.yaw, before + 0.0101);
    EXPECT_NEAR(held.roll, -held.yaw, 1e-12);
    EXPECT_EQ(held.heave_m, 0.02);
    before = held.yaw;
    for (const bool mirrored : {false, true})
      EXPECT_GT(std::abs(cv::determinant(still_from_moved(camera, plane, held, mirrored))), 1e-3);
  }
  EXPECT_LT(before, 0.42);
  WaterMotion water = open_water(4);
  water.horizon = pinhole.horizon();
  water.mapping = WaterMapping::kDisplacement;
  WaterSurface surface(water, Gusts({}, kSailing, kSeen.width), kSailing, 3, {0, 90, 320, 150}, kSeen,
                       waterplane_box(plane, camera));
  FloatingSheet sheet(boat, surface, false, {280, 100, 40, 140});
  int held = 0;
  for (int frame = 0; frame < kSailing.frames; frame += 2) {
    surface.go_to(frame), sheet.go_to(frame);
    const double breadth = breadth_seen(plane, sheet.attitude());
    EXPECT_GE(breadth, kLeastBreadth);
    held += breadth < kLeastBreadth + 1e-3;
  }
  EXPECT_GT(held, 3);
}

TEST(FloatingSheet, IsStillOnCalmWater) {
  const Gusts gusts({.speed_m_per_s = 0}, kSailing, kSeen.width);
  const BoatMotion boat{.hull = Line{{110, 150}, {190, 152}}, .in_3d = true};
  WaterMotion water = open_water(4);
  water.mapping = WaterMapping::kDisplacement;
  WaterSurface surface(water, gusts, kSailing, 3, {0, 61, 320, 179}, kSeen);
  FloatingSheet sheet(boat, surface, false, {90, 60, 120, 100});
  surface.go_to(5), sheet.go_to(5);
  std::vector<float> dx(120), dy(120);
  sheet.row(0, 90, 100, 120, dx.data(), dy.data());
  for (std::size_t i = 0; i < dx.size(); ++i) EXPECT_LT(std::max(std::abs(dx[i]), std::abs(dy[i])), 1e-6);
}

}  // namespace
}  // namespace freshet::synth::scene
