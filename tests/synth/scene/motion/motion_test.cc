// Trees, boats and clouds, each against what it is defined by.
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "synth/scene/motion/boat_ride.h"
#include "synth/scene/motion/cloud_drift.h"
#include "synth/scene/motion/tree_sway.h"
#include "synth/scene/motion/water_surface.h"
#include "synth/scene/water/camera.h"

namespace freshet::synth::scene {
namespace {

const Cycle kCycle{.frames = 60, .fps = 20};
const cv::Rect kBox(0, 0, 200, 240);

TreeMotion one_tree() {
  return {.armatures = {{{100, 220}, {100, 40}}}, .frequency_hz = 0.7, .damping_per_s = 0.6, .mass = 4};
}

cv::Point2f moved(const Motion& motion, int x, int y) {
  float dx = 0, dy = 0;
  motion.row(0, x, y, 1, &dx, &dy);
  return {dx, dy};
}

TEST(TreeSway, BendsAsEquation3Says) {
  EXPECT_EQ(bend(0), 0);
  EXPECT_DOUBLE_EQ(bend(1), 1);
  for (double u = 0.05; u < 2; u += 0.05)
    EXPECT_NEAR(bend_by_distance(static_cast<float>(u)), bend(u) / u, 1e-6);
  const double u = 0.3;
  EXPECT_DOUBLE_EQ(bend(u), u * u * u * u / 3 - 4 * u * u * u / 3 + 2 * u * u);
  // It goes on straight beyond the tip.
  EXPECT_NEAR(bend(1 + 1e-6) - bend(1), bend(1) - bend(1 - 1e-6), 1e-10);
}

TEST(TreeSway, TurnsEachPointAboutTheRootAndBackAgain) {
  const Gusts gusts({.speed_m_per_s = 8}, kCycle, 200);
  TreeSway sway(one_tree(), gusts, kCycle, 1, kBox);
  const cv::Point2d root(100, 220);
  double most = 0;
  for (int frame = 0; frame < kCycle.frames; frame += 7) {
    sway.go_to(frame);
    const double tip = sway.tip(0)[static_cast<std::size_t>(frame)];
    for (int y = 8; y < 200; y += 16) {
      for (int x = 56; x < 150; x += 16) {
        // The source that the row gives, turned by its own angle, comes back to the pixel.
        const cv::Point2d p(x + 0.5, y + 0.5), source = p + cv::Point2d(moved(sway, x, y));
        const cv::Point2d from = source - root;
        const double distance = std::hypot(from.x, from.y),
                     angle = bend(distance / 180) / (distance / 180) * tip;
        const cv::Point2d forward(from.x * std::cos(angle) - from.y * std::sin(angle),
                                  from.x * std::sin(angle) + from.y * std::cos(angle));
        EXPECT_NEAR(root.x + forward.x, p.x, 0.03);
        EXPECT_NEAR(root.y + forward.y, p.y, 0.03);
        EXPECT_NEAR(distance, std::hypot(p.x - root.x, p.y - root.y), 0.03);
        most = std::max({most, std::abs(source.x - p.x), std::abs(source.y - p.y)});
        EXPECT_LE(std::max(std::abs(source.x - p.x), std::abs(source.y - p.y)), sway.reach() + 1e-3);
      }
    }
  }
  EXPECT_GT(most, 2);
}

TEST(TreeSway, AStandSwaysTogetherAndNothingTurnsTooFar) {
  TreeMotion grass = one_tree();
  grass.armatures.push_back({{130, 220}, {130, 40}});
  grass.mass = 0.02;
  const Gusts gusts({.speed_m_per_s = 8}, kCycle, 200);
  TreeSway apart(grass, gusts, kCycle, 1, kBox);
  EXPECT_NE(apart.tip(0), apart.tip(1));
  grass.stand = true;
  TreeSway stand(grass, gusts, kCycle, 1, kBox);
  EXPECT_EQ(stand.tip(0), stand.tip(1));
  double most = 0;
  for (int frame = 0; frame < kCycle.frames; frame += 3) {
    stand.go_to(frame);
    const cv::Point2f to = moved(stand, 100, 42);
    most = std::max(most, 2 * std::asin(std::hypot(to.x, to.y) / (2 * 177.5)));
  }
  EXPECT_GT(most, 0.35);
  EXPECT_LT(most, 0.41);
  grass.armatures[1] = grass.armatures[0];  // twice the same
  TreeSway one_place(grass, gusts, kCycle, 1, kBox);
  one_place.go_to(3);
  for (int x = 90; x < 110; ++x)
    for (int y = 40; y < 220; ++y) ASSERT_LT(std::abs(moved(one_place, x, y).x), 100) << x << ", " << y;
}

TEST(TreeSway, TipGoesToItsSideByItsDisplacement) {
  const Gusts gusts({.speed_m_per_s = 3}, kCycle, 200);
  TreeSway sway(one_tree(), gusts, kCycle, 1, kBox);
  sway.go_to(11);
  // The armature points up: to the right of its way is to the right in the picture.
  const double tip = 180 * sway.tip(0)[11];
  EXPECT_GT(std::abs(tip), 0.3);
  EXPECT_NEAR(-moved(sway, 100, 40).x, tip, 0.03 * std::abs(tip) + 0.05);
}

TEST(TreeSway, SeveralArmaturesEachMoveWhatIsNear) {
  TreeMotion tree = one_tree();
  tree.armatures = {{{40, 220}, {40, 60}}, {{160, 220}, {160, 60}}};
  const Gusts gusts({.speed_m_per_s = 8}, kCycle, 200);
  TreeSway both(tree, gusts, kCycle, 1, kBox);
  both.go_to(5);
  EXPECT_NE(both.tip(0)[5], both.tip(1)[5]);
  EXPECT_NEAR(-moved(both, 40, 60).x, 160 * both.tip(0)[5], 0.4);
  EXPECT_NEAR(-moved(both, 160, 60).x, 160 * both.tip(1)[5], 0.4);
}

TEST(TreeSway, ShimmerMovesWhatTheWindAloneWouldNot) {
  TreeMotion tree = one_tree();
  tree.mass = 1e5;
  tree.shimmer_px = 1.5;
  const Gusts gusts({}, kCycle, 200);
  TreeSway sway(tree, gusts, kCycle, 1, kBox);
  double square = 0;
  int count = 0;
  for (int frame = 0; frame < kCycle.frames; frame += 5) {
    sway.go_to(frame);
    for (int y = 10; y < 220; y += 10)
      for (int x = 10; x < 190; x += 10) {
        const cv::Point2f d = moved(sway, x, y);
        square += d.x * d.x, ++count;
        EXPECT_LE(std::abs(d.x), sway.reach());
      }
  }
  // A spline through independent nodes keeps less than their own deviation.
  EXPECT_GT(std::sqrt(square / count), 0.4);
  EXPECT_LT(std::sqrt(square / count), 1.5);
}

TEST(BoatRide, IsTheLeastSquaresLine) {
  std::vector<cv::Point2d> hull, displaced;
  for (int i = 0; i < 30; ++i) {
    hull.emplace_back(100 + 5 * i, 300);
    displaced.emplace_back(100 + 5 * i + 0.2 * std::sin(i), 297 + 0.1 * i + std::cos(1.7 * i));
  }
  const Ride ride = ride_of(hull, displaced);
  cv::Mat a(30, 2, CV_64F), b(30, 1, CV_64F), x;
  for (int i = 0; i < 30; ++i) {
    a.at<double>(i, 0) = 1, a.at<double>(i, 1) = displaced[static_cast<std::size_t>(i)].x;
    b.at<double>(i) = displaced[static_cast<std::size_t>(i)].y;
  }
  cv::solve(a, b, x, cv::DECOMP_SVD);
  EXPECT_NEAR(std::tan(ride.roll), x.at<double>(1), 1e-9);
  double mean = 0;
  for (const cv::Point2d& p : displaced) mean += p.y / 30;
  EXPECT_NEAR(ride.heave.y, mean - 300, 1e-9);
}

TEST(BoatRide, FindsARigidMotionWhateverTheHullsAngle) {
  for (const double angle : {0.0, 0.7, 2.6}) {
    std::vector<cv::Point2d> hull, displaced;
    const double roll = 0.05;
    const cv::Point2d way(std::cos(angle), std::sin(angle)),
        turned(std::cos(angle + roll), std::sin(angle + roll));
    for (int i = -20; i <= 20; ++i) {
      hull.push_back(cv::Point2d(50, 60) + way * i);
      displaced.push_back(cv::Point2d(50, 57) + turned * i);
    }
    const Ride ride = ride_of(hull, displaced);
    EXPECT_NEAR(ride.roll, roll, 1e-9);
    EXPECT_NEAR(ride.heave.y, -3, 1e-9);
    EXPECT_NEAR(ride.heave.x, 0, 1e-9);
  }
}

WaterMotion lake() {
  return {.horizon = Line{{0, 40}, {200, 40}}, .focal_px = 240.0, .tile = 64, .roughness = 8, .amplitude = 2};
}

TEST(WaterSurface, RowsAreMinusTheDisplacementOfTheirPoints) {
  for (const double tilt : {0.0, 12.0}) {
    WaterMotion water = lake();
    water.horizon->to.y += tilt;
    const Gusts gusts({.gustiness = 0.5}, kCycle, 200);
    WaterSurface surface(water, gusts, kCycle, 3, {0, 41, 200, 199}, {200, 240});
    surface.go_to(9);
    std::vector<float> dx(200), dy(200);
    double most = 0;
    for (int y = 60; y < 240; y += 20) {
      surface.row(0, 0, y, 200, dx.data(), dy.data());
      for (int x = 0; x < 200; x += 9) {
        const cv::Point2d d = surface.displacement(x, y);
        EXPECT_NEAR(dx[static_cast<std::size_t>(x)], -d.x, 2e-3);
        EXPECT_NEAR(dy[static_cast<std::size_t>(x)], -d.y, 2e-3);
        EXPECT_LE(std::max(std::abs(d.x), std::abs(d.y)), surface.reach());
        most = std::max(most, std::abs(d.y));
      }
    }
    EXPECT_GT(most, 0.2);
  }
}

TEST(WaterSurface, SteepWavesAreMadeLowerBeforeTheyFoldThePicture) {
  WaterMotion water = lake();
  water.amplitude = 60;
  const Gusts gusts({.speed_m_per_s = 12}, kCycle, 200);
  WaterSurface surface(water, gusts, kCycle, 3, {0, 41, 200, 199}, {200, 240});
  std::vector<float> dx(200), above(200), below(200);
  double square = 0, most = 0;
  int folds = 0, count = 0;
  for (int frame = 0; frame < kCycle.frames; frame += 7) {
    surface.go_to(frame);
    for (int y = 50; y < 238; ++y) {
      surface.row(0, 0, y, 200, dx.data(), above.data());
      surface.row(0, 0, y + 1, 200, dx.data(), below.data());
      for (std::size_t x = 0; x < 200; ++x) {
        const double step = below[x] - above[x];
        square += step * step, ++count;
        // The row below would show what lies above that of the row above.
        if (step < -1) ++folds;
        most = std::max(most, std::abs(static_cast<double>(above[x])));
      }
    }
  }
  EXPECT_LT(std::sqrt(square / count), 0.4);
  EXPECT_LT(folds, 0.01 * count);
  EXPECT_GT(most, 4);
}

TEST(WaterSurface, MirrorImagesMoveByTheSlopesOfTheHeightsThatBoatsRide) {
  WaterMotion water = lake();
  water.mapping = WaterMapping::kNormals;
  water.amplitude = 0.4;
  water.roughness = 2;  // waves that pixels do not blur
  const Gusts gusts({}, kCycle, 200);
  const cv::Rect all(0, 41, 200, 199);
  WaterSurface surface(water, gusts, kCycle, 3, all, {200, 240}, all);
  surface.go_to(9);
  const WaterCamera camera(*water.horizon, *water.focal_px, water.camera_height_m, {200, 240});
  // Eq. 10 the other way: the height that lifts a pixel's point so far.
  const auto height = [&](double x, double y) {
    const WaterCamera::Row row = camera.row(camera.rolled(x, y).y);
    const double lift = surface.displacement(x, y).y / row.down;
    return lift * row.depth / (1 + lift * row.lean);
  };
  double square = 0, off = 0;
  for (int y = 150; y < 236; y += 5) {
    const WaterCamera::Row row = camera.row(camera.rolled(0, y).y);
    const double grazing = water.camera_height_m / std::hypot(row.forward, water.camera_height_m);
    for (int x = 10; x < 190; x += 9) {
      const double right = (height(x + 1, y) - height(x - 1, y)) / (2 * row.scale);
      const double away = -(height(x, y + 1) - height(x, y - 1)) / (2 * row.deep);
      const cv::Point2d shown(moved(surface, x, y)), expected(-480 * right * grazing, -480 * away);
      square += expected.dot(expected), off += (shown - expected).dot(shown - expected);
    }
  }
  EXPECT_GT(square, 100);
  EXPECT_LT(off, 0.3 * square);  // heights are linear between samples, and so are slopes
}

TEST(WaterSurface, APictureOfThriceTheSizeMovesThriceAsFar) {
  for (const WaterMapping mapping : {WaterMapping::kDisplacement, WaterMapping::kNormals}) {
    const auto surface = [&](int times) {
      const cv::Size picture(320 * times, 180 * times);
      const WaterMotion water{.horizon = Line{{0, 70.0 * times}, {320.0 * times, 70.0 * times}},
                              .focal_px = 384.0 * times,
                              .amplitude = mapping == WaterMapping::kNormals ? 0.3 : 3,
                              .mapping = mapping};
      const Gusts gusts({}, kCycle, picture.width);
      const cv::Rect region(0, 71 * times, picture.width, picture.height - 71 * times);
      auto made = std::make_unique<WaterSurface>(water, gusts, kCycle, 3, region, picture);
      made->go_to(9);
      return made;
    };
    const auto small = surface(1), large = surface(3);
    double off = 0, all = 0;
    for (int y = 85; y < 178; y += 3)
      for (int x = 5; x < 315; x += 7) {
        const cv::Point2f d = moved(*small, x, y), same = moved(*large, 3 * x + 1, 3 * y + 1) / 3;
        off += (d - same).dot(d - same), all += d.dot(d);
      }
    EXPECT_GT(all, 100);
    EXPECT_LT(off, 0.03 * all);
  }
}

TEST(WaterSurface, MirrorsWhereItIsSeenAtGrazingAnglesAlone) {
  const WaterMotion water{.horizon = Line{{0, 70}, {320, 70}}, .focal_px = 384.0};
  const auto seen = [&](int bottom) { return mapping_seen(water, {0, 72, 320, bottom - 72}, {320, 180}); };
  EXPECT_EQ(seen(120), WaterMapping::kNormals);
  // 17 degrees below the horizon, which lies 20 px above the middle.
  const double angle = 17 * std::numbers::pi / 180 - std::atan(20 / 384.0);
  const int row = static_cast<int>(90 + 384 * std::tan(angle));
  EXPECT_EQ(seen(row - 1), WaterMapping::kNormals);
  EXPECT_EQ(seen(row + 2), WaterMapping::kDisplacement);
  // From straight above, and with the horizon far out of the picture.
  const WaterMotion deep{.horizon = Line{{0, -2000}, {320, -2000}}, .focal_px = 384.0};
  EXPECT_EQ(mapping_seen(deep, {0, 0, 320, 180}, {320, 180}), WaterMapping::kDisplacement);
}

TEST(WaterSurface, IsStillAtTheHorizonAndAbove) {
  const Gusts gusts({}, kCycle, 200);
  WaterSurface surface(lake(), gusts, kCycle, 3, {0, 20, 200, 220}, {200, 240});
  surface.go_to(4);
  std::vector<float> dx(200), dy(200);
  for (const int y : {20, 39, 41}) {
    surface.row(0, 0, y, 200, dx.data(), dy.data());
    for (int x = 0; x < 200; ++x) EXPECT_LT(std::abs(dy[static_cast<std::size_t>(x)]), 0.05) << y;
  }
}

TEST(WaterSurface, GustsCrossThePictureWithTheWind) {
  // A picture of 40 m under 8 m/s: what is at the left comes to the right five seconds later.
  const Cycle cycle{.frames = 400, .fps = 20};
  const Gusts gusts({.speed_m_per_s = 8, .gustiness = 1, .width_m = 40}, cycle, 200);
  for (int frame = 0; frame < 300; frame += 30)
    EXPECT_NEAR(gusts.strength(0, frame), gusts.strength(200, frame + 100), 1e-4);
  const Gusts none({.speed_m_per_s = 8, .gustiness = 0}, cycle, 200);
  EXPECT_EQ(none.strength(0, 50), 0);
}

TEST(BoatRide, ReflectionRollsTheOtherWay) {
  const Gusts gusts({}, kCycle, 200);
  WaterSurface surface(lake(), gusts, kCycle, 3, {0, 41, 200, 199}, {200, 240});
  surface.go_to(9);
  BoatMotion boat{.hull = Line{{60, 150}, {140, 150}}};
  BoatRide ride(boat, surface, false, kBox), reflection(boat, surface, true, kBox);
  ride.go_to(9), reflection.go_to(9);
  const cv::Point2f up = moved(ride, 60, 149), down = moved(reflection, 60, 149);
  // What the water itself does to the reflection, taken away.
  const cv::Point2f wave(-surface.displacement(60, 149));
  EXPECT_GT(std::abs(up.y), 0.02);
  EXPECT_NEAR(down.y - wave.y, -up.y, 0.02);
}

CloudDrift drifting(const CloudMotion& clouds, CloudCourse& course) {
  course = course_of(clouds, {}, kCycle, true, 200, 200);
  return CloudDrift(course, clouds, kCycle, {0, 0, 200, 100}, 3);
}

TEST(CloudDrift, InAShortLoopEachPlaceDissolvesAtATimeOfItsOwn) {
  CloudCourse course;
  CloudDrift drift = drifting({.speed_px_per_s = 10.0}, course);
  EXPECT_TRUE(course.dissolves);
  EXPECT_DOUBLE_EQ(course.speed_px_per_s, 10);
  std::vector<float> part(200), dx(200), dy(200);
  drift.go_to(0);
  drift.row(0, 0, 5, 200, dx.data(), dy.data());
  EXPECT_EQ(dx[5], 0);
  EXPECT_FALSE(drift.second(0, 5, 200, part.data()));
  double halves = 0, alone = 0, count = 0;
  for (int frame = 1; frame < kCycle.frames; ++frame) {
    drift.go_to(frame);
    double mean = 0;
    for (int y = 0; y < 100; y += 10) {
      ASSERT_TRUE(drift.second(0, y, 200, part.data()));
      for (const float p : part) {
        ASSERT_GE(p, 0);
        ASSERT_LE(p, 1);
        mean += p / 2000;
        alone += p == 0 || p == 1, halves += p > 0.25 && p < 0.75, ++count;
      }
    }
    if (frame == 1) {
      EXPECT_LT(mean, 0.01);
    }
    if (frame == kCycle.frames - 1) {
      EXPECT_GT(mean, 0.99);
    }
  }
  EXPECT_GT(alone / count, 0.55);
  EXPECT_LT(halves / count, 0.2);
  drift.row(1, 0, 5, 200, dx.data(), dy.data());
  EXPECT_NEAR(dx[5], 10.0 / 20, 1e-5);  // one frame before its place
}

TEST(CloudDrift, WhenACloudDissolvesGoesAlongWithIt) {
  CloudCourse course;
  CloudDrift drift = drifting({.speed_px_per_s = 20.0}, course);
  std::vector<float> before(200), after(200);
  drift.go_to(20);
  drift.second(0, 50, 200, before.data());
  drift.go_to(30);
  drift.second(10, 50, 200, after.data());  // it went 10 px in these frames
  for (std::size_t i = 0; i < 190; ++i) EXPECT_GE(after[i], before[i] - 1e-5f);
}

TEST(CloudDrift, ComesRoundAWholeNumberOfTimesWhereItCan) {
  for (const double asked : {-60.0, 70.0, 110.0, 300.0}) {
    CloudCourse course;
    CloudDrift drift = drifting({.speed_px_per_s = asked}, course);
    EXPECT_FALSE(course.dissolves);
    const double rounds = course.speed_px_per_s * kCycle.seconds() / course.period_px;
    EXPECT_NEAR(rounds, std::round(rounds), 1e-9);
    EXPECT_GE(std::abs(rounds), 1);
    EXPECT_GT(course.period_px, 200);
    EXPECT_NEAR(course.speed_px_per_s, asked, 0.25 * std::abs(asked));
    std::vector<float> part(200);
    drift.go_to(7);
    EXPECT_FALSE(drift.second(0, 5, 200, part.data()));
  }
}

TEST(TreeSway, ForeshorteningScalesAlongTheArmature) {
  const Gusts gusts({.speed_m_per_s = 8}, kCycle, 200);
  const auto with = [&](double share) {
    TreeMotion tree = one_tree();
    tree.foreshortening = share;
    return TreeSway(tree, gusts, kCycle, 1, kBox);
  };
  TreeSway none = with(0), some = with(0.1), more = with(0.2);
  const cv::Point2f root(100, 220);
  // How much longer the armature is shown than it is, from where a pixel on the row of its middle comes from.
  const auto grown = [&](TreeSway& sway, int frame, int y) {
    sway.go_to(frame);
    const cv::Point2f p(100.5f, static_cast<float>(y) + 0.5f);
    return cv::norm(p - root) / cv::norm(p + moved(sway, 100, y) - root) - 1;
  };
  double most = 0, least = 0;
  for (int frame = 0; frame < kCycle.frames; frame += 5) {
    EXPECT_NEAR(grown(none, frame, 80), 0, 2e-3) << "a turn keeps lengths";
    const double once = grown(some, frame, 80);
    EXPECT_NEAR(grown(more, frame, 80), 2 * once, 3e-3);
    EXPECT_NEAR(grown(some, frame, 160), once, 3e-3) << "all of it is scaled alike";
    most = std::max(most, once);
    least = std::min(least, once);
  }
  EXPECT_GT(most, 0.005);
  EXPECT_LT(least, -0.003);
}

}  // namespace
}  // namespace freshet::synth::scene
