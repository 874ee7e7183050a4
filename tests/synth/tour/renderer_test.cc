// A moved camera's frames against a slow ray caster that knows the scene.

#include "synth/tour/renderer.h"

#include <cmath>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "tests/synth/tour/ray_caster.h"

namespace freshet::synth::tour {
namespace {

const cv::Size kSize(240, 160);
const cv::Point2d kVanishing(110, 60);
constexpr double kFocal = 240;  // px: the usual view

Mesh outdoors() {
  return {.picture = kSize,
          .vanishing = kVanishing,
          .view_deg = 2 * std::atan(0.5 * kSize.width / kFocal) * 180 / CV_PI,
          .left = 0,
          .top = 0,
          .right = 240,
          .bottom = 0,
          .back = false};
}
/// With a wall across at this depth.
Mesh walled(double depth) {
  Mesh mesh = outdoors();
  mesh.back = true;
  mesh.bottom = kVanishing.y + kFocal / depth;
  return mesh;
}

cv::Mat rendered(const Room& room, const cv::Mat& picture, const CameraPlace& place,
                 std::vector<Upright> things = {}, cv::Mat* depth = nullptr, cv::Size size = kSize) {
  const Scenery scenery(picture, std::move(things));
  cv::Mat out(size, CV_32FC4), colours;
  Renderer(room, scenery, size).render(room.camera(place, size), out, depth);
  cv::cvtColor(out, colours, cv::COLOR_BGRA2BGR);
  return colours;
}

/// CV_8U: what the picture shows of what the camera sees, `margin` px around it left out.
cv::Mat known(const Room& room, const CameraPlace& place, double margin = 2) {
  cv::Mat mask(kSize, CV_8U, cv::Scalar(0));
  const Pinhole camera = room.camera(place, kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const Room::Hit hit = room.hit(camera, {static_cast<double>(x), static_cast<double>(y)});
      const cv::Rect2d inside(margin, margin, kSize.width - 2 * margin, kSize.height - 2 * margin);
      mask.at<std::uint8_t>(y, x) = hit.shown && inside.contains(hit.sample) ? 255 : 0;
    }
  return mask;
}

double correlation(const cv::Mat& a, const cv::Mat& b, const cv::Mat& mask) {
  cv::Scalar mean_a, mean_b, deviation_a, deviation_b;
  cv::meanStdDev(a, mean_a, deviation_a, mask);
  cv::meanStdDev(b, mean_b, deviation_b, mask);
  const cv::Scalar product = cv::mean((a - mean_a).mul(b - mean_b), mask);
  double least = 1;
  for (int c = 0; c < 3; ++c) least = std::min(least, product[c] / (deviation_a[c] * deviation_b[c]));
  return least;
}

/// Middle of what is light around a place.
cv::Point2d mark_near(const cv::Mat& picture, cv::Point2d at) {
  const cv::Rect around =
      cv::Rect(cvRound(at.x) - 9, cvRound(at.y) - 7, 19, 15) & cv::Rect({}, picture.size());
  double sum = 0;
  cv::Point2d middle(0, 0);
  for (int y = around.y; y < around.br().y; ++y)
    for (int x = around.x; x < around.br().x; ++x) {
      const double light = picture.at<cv::Vec3f>(y, x)[1];
      sum += light;
      middle += cv::Point2d(x, y) * light;
    }
  return sum > 0.5 ? middle * (1 / sum) : cv::Point2d(-1e3, -1e3);
}

const std::vector<CameraPlace> kPlaces{{.position = {0, 0, 1}},
                                       {.position = {0.4, 0, 0.3}},
                                       {.position = {-0.3, 0.5, 0.5}},
                                       {.position = {0, -0.4, 0}},
                                       {.position = {0.1, 0.1, 0.4}, .yaw_deg = 6, .pitch_deg = -4},
                                       {.position = {0.3, 0.2, 0.8}, .yaw_deg = -7, .pitch_deg = 3}};

TEST(TourRenderer, TheOwnCameraGivesTheFrame) {
  cv::Mat noise(kSize, CV_8UC3), first;
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 256);
  noise.convertTo(first, CV_32F, 1 / 255.0);
  Mesh box = walled(6);
  box.left = 60, box.top = 20, box.right = 190;
  for (const Mesh& mesh : {outdoors(), walled(5), box}) {
    const Room room(mesh, "test");
    const Scenery scenery(first, {});
    cv::Mat out(kSize, CV_8UC3);
    Renderer(room, scenery, kSize).render(room.own_camera(kSize), out);
    EXPECT_EQ(cv::norm(out, noise, cv::NORM_INF), 0);
  }
}

TEST(TourRenderer, MarksLieWhereTheCameraSeesThem) {
  CastScene scene{.back_depth = 7, .marks_alone = true};
  for (const int z : {3, 5})
    for (int x = -1; x <= 1; ++x) scene.floor_marks.emplace_back(x, z);
  for (int x = -2; x <= 2; ++x)
    for (int y = -1; y <= 0; ++y) scene.back_marks.emplace_back(x, y);
  const Room room(walled(7), "test");
  const cv::Mat picture = cast(scene, kSize, kFocal, kVanishing, {}, 6);
  int seen = 0;
  for (const CameraPlace& place : kPlaces) {
    const cv::Mat out = rendered(room, picture, place),
                  truth = cast(scene, kSize, kFocal, kVanishing, place, 6);
    std::vector<cv::Vec3d> points;
    for (const auto& mark : scene.floor_marks) points.emplace_back(mark.x, 1, mark.y);
    for (const auto& mark : scene.back_marks) points.emplace_back(mark.x, mark.y, 7);
    for (const cv::Vec3d& point : points) {
      const cv::Point2d at = projected(point, kSize, kFocal, kVanishing, place),
                        own = projected(point, kSize, kFocal, kVanishing, {});
      const cv::Rect2d inside(10, 8, kSize.width - 20, kSize.height - 16);
      if (!inside.contains(at) || !inside.contains(own)) continue;
      ++seen;
      EXPECT_LT(cv::norm(mark_near(out, at) - mark_near(truth, at)), 0.25)
          << "mark (" << point[0] << ", " << point[1] << ", " << point[2] << ") from z " << place.position[2];
      EXPECT_LT(cv::norm(mark_near(out, at) - at), 1) << at;
    }
  }
  EXPECT_GT(seen, 50);
}

TEST(TourRenderer, FloorAndSkyLookAsTheRayCasterSeesThem) {
  const CastScene scene{.back_depth = INFINITY};
  const Room room(outdoors(), "test");
  const cv::Mat picture = cast(scene, kSize, kFocal, kVanishing, {});
  for (const CameraPlace& place : kPlaces) {
    // Near the horizon the picture has a pixel where the caster has many waves.
    cv::Mat mask = known(room, place);
    const Pinhole camera = room.camera(place, kSize);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const Room::Hit hit = room.hit(camera, {static_cast<double>(x), static_cast<double>(y)});
        if (hit.depth < kFar && hit.sample.y < kVanishing.y + kFocal / 10) mask.at<std::uint8_t>(y, x) = 0;
      }
    ASSERT_GT(cv::countNonZero(mask), 15000);
    EXPECT_GT(
        correlation(rendered(room, picture, place), cast(scene, kSize, kFocal, kVanishing, place), mask),
        0.99)
        << "from " << place.position << " yaw " << place.yaw_deg;
  }
}

TEST(TourRenderer, ARoomLooksAsTheRayCasterSeesIt) {
  const CastScene scene{.back_depth = 6, .half_width = 1.5, .ceiling = 1.2};
  Mesh mesh = walled(6);
  mesh.left = kVanishing.x - 1.5 * kFocal / 6, mesh.right = kVanishing.x + 1.5 * kFocal / 6;
  mesh.top = kVanishing.y - 1.2 * kFocal / 6;
  const Room room(mesh, "test");
  const cv::Mat picture = cast(scene, kSize, kFocal, kVanishing, {});
  for (const CameraPlace& place : kPlaces) {
    const cv::Mat mask = known(room, place);
    ASSERT_GT(cv::countNonZero(mask), 15000);
    const cv::Mat out = rendered(room, picture, place), truth = cast(scene, kSize, kFocal, kVanishing, place);
    EXPECT_GT(correlation(out, truth, mask), 0.985) << "from " << place.position << " yaw " << place.yaw_deg;
  }
}

TEST(TourRenderer, DepthIsTheRayCasters) {
  const CastScene scene{.back_depth = 6, .half_width = 1.5, .ceiling = 1.2};
  Mesh mesh = walled(6);
  mesh.left = kVanishing.x - 1.5 * kFocal / 6, mesh.right = kVanishing.x + 1.5 * kFocal / 6;
  mesh.top = kVanishing.y - 1.2 * kFocal / 6;
  const Room room(mesh, "test");
  const Room open(outdoors(), "test");
  const cv::Mat grey(kSize, CV_32FC3, cv::Scalar::all(0.5));
  for (const CameraPlace& place : kPlaces) {
    cv::Mat depth;
    rendered(room, grey, place, {}, &depth);
    EXPECT_LT(cv::norm(depth, cast_depth(scene, kSize, kFocal, kVanishing, place), cv::NORM_INF), 1e-4);
    rendered(open, grey, place, {}, &depth);
    EXPECT_LT(cv::norm(depth, cast_depth({.back_depth = INFINITY}, kSize, kFocal, kVanishing, place),
                       cv::NORM_RELATIVE | cv::NORM_L2),
              1e-4);
  }
}

TEST(TourRenderer, ABoardStandsBeforeTheFloorAndMovesMore) {
  CastScene scene{.back_depth = 7, .boards = {{.depth = 3, .left = -0.4, .right = 0.2, .height = 1.1}}};
  const Room room(walled(7), "test");
  const cv::Mat picture = cast(scene, kSize, kFocal, kVanishing, {});
  // The board alone is where its depth is seen.
  const cv::Mat matte = cast_depth(scene, kSize, kFocal, kVanishing, {}) == 3;
  const cv::Rect box = cv::boundingRect(matte);
  EXPECT_NEAR(room.floor_depth(box.br().y), 3, 0.05);  // its foot says how far away it stands
  for (const CameraPlace& place : {kPlaces[0], kPlaces[1], kPlaces[4]}) {
    cv::Mat depth;
    const cv::Mat out = rendered(room, picture, place, {{"board", matte, 3}}, &depth);
    const cv::Mat truth = cast(scene, kSize, kFocal, kVanishing, place),
                  true_depth = cast_depth(scene, kSize, kFocal, kVanishing, place);
    const cv::Rect seen = cv::boundingRect(cv::abs(depth - (3 - place.position[2])) < 1e-3);
    const cv::Mat true_board =
        place.yaw_deg == 0 ? cv::Mat(cv::abs(true_depth - (3 - place.position[2])) < 1e-3) : cv::Mat();
    if (!true_board.empty()) {
      const cv::Rect expected = cv::boundingRect(true_board);
      EXPECT_NEAR(seen.x, expected.x, 1.01);
      EXPECT_NEAR(seen.y, expected.y, 1.01);
      EXPECT_NEAR(seen.br().x, expected.br().x, 1.01);
      EXPECT_NEAR(seen.br().y, expected.br().y, 1.01);
    }
    // What was behind the board is a guess; all else is known.
    cv::Mat mask = known(room, place), near_board;
    const Pinhole camera = room.camera(place, kSize);
    cv::dilate(matte, near_board, cv::Mat::ones(9, 9, CV_8U));
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const Room::Hit hit = room.hit(camera, {static_cast<double>(x), static_cast<double>(y)});
        const cv::Point from(cvRound(hit.sample.x), cvRound(hit.sample.y));
        if (cv::Rect({}, kSize).contains(from) && near_board.at<std::uint8_t>(from) > 0)
          mask.at<std::uint8_t>(y, x) = 0;
      }
    EXPECT_GT(correlation(out, truth, mask), 0.98);
    // And the board itself, but for its rim.
    cv::Mat inner = cv::abs(true_depth - depth) < 0.02;
    inner &= true_depth < 3.2;
    inner &= true_depth > 1.5;
    cv::erode(inner, inner, cv::Mat::ones(7, 7, CV_8U));
    if (place.yaw_deg == 0) {
      EXPECT_GT(correlation(out, truth, inner), 0.98);
    }
  }
}

TEST(TourRenderer, LaidOverEachOtherAgainAFilmIsItself) {
  cv::Mat coarse(20, 30, CV_8UC3), first8, second8, first;
  cv::RNG random(8);
  random.fill(coarse, cv::RNG::UNIFORM, 40, 200);
  cv::resize(coarse, first8, kSize, 0, 0, cv::INTER_CUBIC);
  random.fill(coarse, cv::RNG::UNIFORM, 40, 200);
  cv::resize(coarse, second8, kSize, 0, 0, cv::INTER_CUBIC);
  second8 = 0.8 * first8 + 0.2 * second8;
  first8.convertTo(first, CV_32F, 1 / 255.0);
  cv::Mat matte(kSize, CV_8U, cv::Scalar(0)), beside(kSize, CV_8U, cv::Scalar(0));
  cv::ellipse(matte, {100, 90}, {20, 35}, 0, 0, 360, 255, -1);
  cv::ellipse(beside, {115, 80}, {25, 20}, 0, 0, 360, 255, -1);  // behind it
  const Room room(outdoors(), "test");
  Scenery scenery(first, {{"far", beside, 6}, {"near", matte, 3}});
  cv::Mat out(kSize, CV_8UC3);
  const Renderer renderer(room, scenery, kSize);
  renderer.render(room.own_camera(kSize), out);
  EXPECT_LE(cv::norm(out, first8, cv::NORM_INF), 1);
  scenery.show(second8);
  renderer.render(room.own_camera(kSize), out);
  cv::Mat off;
  cv::absdiff(out, second8, off);
  cv::Mat wrong = off.reshape(1) > 1;
  EXPECT_LT(cv::countNonZero(wrong), 0.02 * static_cast<double>(wrong.total()));
  EXPECT_LE(cv::norm(off, cv::NORM_INF), 40);  // where a colour would have been none
}

TEST(TourRenderer, WhatLiesBehindMovesAsItsCopyDoes) {
  // Left half still, right half blinks; behind a thing in the right half it blinks too.
  cv::Mat first8(kSize, CV_8UC3, cv::Scalar::all(100)), second8 = first8.clone(), first;
  second8.colRange(kSize.width / 2, kSize.width).setTo(cv::Scalar::all(160));
  cv::Mat matte(kSize, CV_8U, cv::Scalar(0));
  cv::rectangle(matte, cv::Rect(170, 70, 20, 30), 255, -1);
  for (cv::Mat* each : {&first8, &second8}) each->setTo(cv::Scalar::all(20), matte);
  first8.convertTo(first, CV_32F, 1 / 255.0);
  Scenery scenery(first, {{"thing", matte, 4}});
  scenery.show(second8);
  const Room room(outdoors(), "test");
  // From beside it.
  cv::Mat out(kSize, CV_8UC3), depth;
  Renderer(room, scenery, kSize).render(room.camera({.position = {1, 0, 0}}, kSize), out, &depth);
  const Pinhole camera = room.camera({.position = {1, 0, 0}}, kSize);
  int behind = 0;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const Room::Hit hit = room.hit(camera, {static_cast<double>(x), static_cast<double>(y)});
      if (!cv::Rect(173, 73, 14, 24).contains(hit.sample) || depth.at<float>(y, x) == 4) continue;
      ++behind;
      EXPECT_NEAR(out.at<cv::Vec3b>(y, x)[1], 160, 3) << x << ", " << y;
    }
  EXPECT_GT(behind, 100);
}

TEST(TourRenderer, NoCameraSeesHoles) {
  const cv::Vec3b colour(40, 120, 200);
  const cv::Mat picture = cv::Mat(kSize, CV_32FC3, cv::Scalar(40, 120, 200) / 255);
  Mesh box = walled(6);
  box.left = 70, box.top = 30, box.right = 170;
  cv::RNG random(11);
  for (const Mesh& mesh : {outdoors(), walled(5), box}) {
    const Room room(mesh, "test");
    const Scenery scenery(picture, {});
    const Renderer renderer(room, scenery, kSize);
    cv::Mat out(kSize, CV_8UC3);
    for (int i = 0; i < 40; ++i) {
      const CameraPlace place{
          .position = {random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.6), random.uniform(-4.0, 3.0)},
          .yaw_deg = random.uniform(-40.0, 40.0),
          .pitch_deg = random.uniform(-25.0, 25.0),
          .view_deg = random.uniform(20.0, 70.0)};
      ASSERT_EQ(room.fault_of(place.position), "");
      out.setTo(cv::Scalar(0, 0, 0));
      renderer.render(room.camera(place, kSize), out);
      EXPECT_EQ(cv::norm(out, cv::Mat(kSize, CV_8UC3, cv::Scalar(colour)), cv::NORM_INF), 0)
          << place.position << " " << place.yaw_deg << " " << place.pitch_deg;
    }
  }
}

TEST(TourRenderer, ThreadsChangeNothing) {
  cv::Mat noise(kSize, CV_32FC3), one(kSize, CV_8UC3), all(kSize, CV_8UC3), one_depth, all_depth;
  cv::RNG(5).fill(noise, cv::RNG::UNIFORM, 0, 1);
  cv::Mat matte(kSize, CV_8U, cv::Scalar(0));
  cv::rectangle(matte, cv::Rect(100, 50, 30, 50), 255, -1);
  const Room room(walled(6), "test");
  const Scenery scenery(noise, {{"thing", matte, 4}});
  const Renderer renderer(room, scenery, kSize);
  const Pinhole camera = room.camera({.position = {0.2, 0.3, 0.5}, .yaw_deg = 3, .pitch_deg = 2}, kSize);
  {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    renderer.render(camera, one, &one_depth);
  }
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, 5);
  renderer.render(camera, all, &all_depth);
  EXPECT_EQ(cv::norm(one, all, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(one_depth, all_depth, cv::NORM_INF), 0);
}

TEST(TourRoom, RefusesMeshesThatAreNoBox) {
  const auto refused = [](const Mesh& mesh, const std::string& fault) {
    try {
      const Room room(mesh, "tour.toml");
      ADD_FAILURE() << "taken, though " << fault;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(fault), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("tour.toml"), std::string::npos);
    }
  };
  Mesh mesh = walled(6);
  mesh.left = mesh.right = 50;
  refused(mesh, "0 x 100 px");
  mesh = walled(6);
  mesh.bottom = kVanishing.y;
  refused(mesh, "not below the horizon");
  mesh = walled(6);
  mesh.left = kVanishing.x + 10;
  refused(mesh, "left edge");
  mesh = outdoors();
  mesh.vanishing.y = kSize.height;
  refused(mesh, "nothing of it is floor");
  mesh.vanishing.y = NAN;
  refused(mesh, "not finite");
}

}  // namespace
}  // namespace freshet::synth::tour
