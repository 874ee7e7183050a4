// Shadows of layers and of clouds, against what casts them.
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/sampling/bilinear.h"
#include "synth/scene/motion/cloud_drift.h"
#include "synth/scene/rendering/cloud_shade.h"
#include "synth/scene/rendering/layer_shadow.h"
#include "tests/synth/scene/made_scene.h"

namespace freshet::synth::scene {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const cv::Size kGround(300, 200);

/// A layer whose foot stands at (100, 120), 60 px tall, its shadow 40 px to the right and 20 px down.
SceneLayer standing(bool in_still, double softness = 0) {
  SceneLayer layer;
  layer.shadow = Line{{100, 120}, {140, 140}};
  layer.shadow_darkness = 0.6;
  layer.shadow_softness_px = softness;
  layer.shadow_in_still = in_still;
  return layer;
}
const cv::Rect kStands(90, 60, 20, 60);

cv::Mat alpha_at(const cv::Rect& box) {
  cv::Mat alpha(kGround, CV_32F, cv::Scalar(0));
  alpha(box).setTo(1);
  return alpha;
}
cv::Mat pixels_of(const cv::Mat& alpha) {
  cv::Mat out;
  cv::merge(std::vector<cv::Mat>{alpha, alpha, alpha, alpha}, out);
  return out;
}
/// What casts a shadow on a place, told by the shadow's own geometry.
bool in_shadow(const cv::Rect& box, double x, double y) {
  const double up = (y - 120) / 20;
  return cv::Rect2d(box).contains({x - up * 40, 120 - up * 60});
}

TEST(LayerShadow, FallsWhereTheLineLaysTheLayer) {
  for (const int aside : {0, 7}) {
    const cv::Rect box = kStands + cv::Point(aside, 0);
    LayerShadow shadow(standing(false), {}, kStands, kGround);
    cv::Mat light(kGround, CV_32F, cv::Scalar(0.5));
    shadow.cast(pixels_of(alpha_at(box)), light);
    int dark = 0;
    for (int y = 0; y < kGround.height; ++y)
      for (int x = 0; x < kGround.width; ++x) {
        // Half a pixel from its edge it is one or the other.
        bool all = true, some = false;
        for (const double dy : {-0.9, 0.0, 0.9})
          for (const double dx : {-2.5, 0.0, 2.5}) {
            const bool in = in_shadow(box, x + 0.5 + dx, y + 0.5 + dy);
            all = all && in, some = some || in;
          }
        if (all) {
          ASSERT_NEAR(light.at<float>(y, x), 0.5 * 0.4, 1e-5) << x << " " << y;
        }
        if (!some) {
          ASSERT_NEAR(light.at<float>(y, x), 0.5, 1e-5) << x << " " << y;
        }
        dark += all ? 1 : 0;
      }
    EXPECT_GT(dark, 200);
  }
}

TEST(LayerShadow, OfTheStillIsDividedOutWhereItWas) {
  LayerShadow shadow(standing(true), alpha_at(kStands), kStands, kGround);
  cv::Mat light(kGround, CV_32F, cv::Scalar(1));
  shadow.cast(pixels_of(alpha_at(kStands)), light);
  double low = 0, high = 0;
  cv::minMaxLoc(light, &low, &high);
  EXPECT_NEAR(low, 1, 1e-5);
  EXPECT_NEAR(high, 1, 1e-5);
  // Its top goes aside by its whole breadth and more: (144, 130) lies in the shadow now, (120, 130) no longer.
  light.setTo(1);
  shadow.cast(pixels_of(alpha_at(kStands + cv::Point(24, 0))), light);
  EXPECT_NEAR(light.at<float>(130, 144), 0.4, 1e-4);
  EXPECT_NEAR(light.at<float>(130, 120), 2.5, 1e-4);
  EXPECT_NEAR(light.at<float>(130, 60), 1, 1e-4);
}

TEST(LayerShadow, IsBlurredByItsSoftness) {
  for (const double softness : {3.0, 9.0}) {
    // So broad that only its left edge counts, so tall that its ends do not.
    SceneLayer layer = standing(false, softness);
    layer.shadow = Line{{150, 40}, {150, 200}};
    const cv::Rect broad(150, 10, 150, 30);
    LayerShadow shadow(layer, {}, broad, kGround);
    cv::Mat light(kGround, CV_32F, cv::Scalar(1));
    shadow.cast(pixels_of(alpha_at(broad)), light);
    for (int x = 150 - 2 * static_cast<int>(softness); x < 150 + 2 * softness; ++x) {
      const double expected = 0.5 * (1 + std::erf((x + 0.5 - 150) / softness / std::sqrt(2.0)));
      EXPECT_NEAR((1 - light.at<float>(110, x)) / 0.6, expected, 0.04) << x << " " << softness;
    }
  }
}

const Cycle kUnseenEnd{.frames = 1500, .fps = 25};
const cv::Size kLand(400, 300);
const Line kFarLand{{0, 100}, {400, 100}};

/// The light at every pixel of a frame.
cv::Mat lit(CloudShade& shade, int frame) {
  cv::Mat light;
  shade.go_to(frame);
  shade.light(light);
  return light;
}

TEST(CloudShade, GoesWithTheWindInTheForegroundAsFastAsTheClouds) {
  CloudMotion clouds;
  clouds.shade = 0.5;
  clouds.shade_size = 0.3;
  const Weather along({.speed_m_per_s = 5}, kUnseenEnd),
      away({.speed_m_per_s = 5, .direction_deg = 90}, kUnseenEnd);
  CloudShade shade(clouds, kFarLand, along, kUnseenEnd, false, 3, kLand);
  // .6 % of 400 px times 5 m/s: 12 px/s; in 120 frames 57.6 px at the lower edge, half as many half way up.
  const int frame = 120;
  const double gone = 0.006 * 400 * 5 * frame / 25;
  shade.go_to(0);
  std::vector<float> before;
  for (const double row : {300.0, 200.0})
    for (int x = 40; x < 300; x += 10) before.push_back(shade.light_at({1.0 * x, row}));
  shade.go_to(frame);
  std::size_t i = 0;
  double change = 0;
  for (const double row : {300.0, 200.0})
    for (int x = 40; x < 300; x += 10, ++i) {
      EXPECT_NEAR(shade.light_at({x + gone * (row - 100) / 200, row}), before[i], 2e-3);
      change = std::max(change, 1.0 * std::abs(shade.light_at({1.0 * x, row}) - before[i]));
    }
  EXPECT_GT(change, 0.3);
  // Away from the viewer: what was in the foreground is further on the ground, straight behind.
  CloudShade going(clouds, kFarLand, away, kUnseenEnd, false, 3, kLand);
  const WaterCamera camera(kFarLand, 480, 1, kLand);
  const double per_m = 1 / camera.row(camera.rolled(0, 299.5).y).scale;
  const auto forward = [&](double y) { return camera.row(camera.rolled(0, y - 0.5).y).forward * per_m; };
  const float was = going.light_at({200, 280});
  going.go_to(frame);
  double y = 280;
  while (forward(y) < forward(280) + gone) y -= 0.01;
  EXPECT_NEAR(going.light_at({200, y}), was, 2e-3);
}

TEST(CloudShade, CoversTwoFifthsAndFadesTowardsTheHorizon) {
  CloudMotion clouds;
  clouds.shade = 0.5;
  clouds.shade_size = 0.2;
  double mean = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    CloudShade shade(clouds, kFarLand, Weather({}, kUnseenEnd), kUnseenEnd, false, seed, kLand);
    const cv::Mat light = lit(shade, 0);
    EXPECT_EQ(cv::countNonZero(light.rowRange(0, 104) != 1), 0);
    double low = 0, high = 0;
    cv::minMaxLoc(light, &low, &high);
    EXPECT_GE(low, 0.5 - 1e-5);
    EXPECT_LE(high, 1);
    EXPECT_NEAR(shade.light_at({200.5, 280.5}), light.at<float>(280, 200), 0.02);
    for (int frame = 0; frame < 1500; frame += 150) {
      shade.go_to(frame);
      for (int x = 0; x < 400; x += 20) mean += shade.light_at({1.0 * x, 295}) / (40 * 10 * 20);
    }
  }
  EXPECT_NEAR(mean, 1 - 0.5 * 0.4, 0.03);
}

TEST(CloudShade, ALoopComesBackWithItsContrastKept) {
  CloudMotion clouds;
  clouds.shade = 0.5;
  clouds.shade_size = 0.12;
  const Cycle cycle{.frames = 100, .fps = 25};
  double ends = 0, middle = 0, step = 0, last = 0;
  for (std::uint64_t seed = 0; seed < 48; ++seed) {
    CloudShade shade(clouds, kFarLand, Weather({}, cycle), cycle, true, seed, kLand);
    const cv::Rect near(0, 250, 400, 50);
    const auto deviation = [&](int frame) {
      cv::Scalar mean, of;
      cv::meanStdDev(lit(shade, frame)(near), mean, of);
      return of[0];
    };
    ends += deviation(0), middle += deviation(50);
    const cv::Mat first = lit(shade, 0).clone();
    EXPECT_EQ(cv::norm(first, lit(shade, 100), cv::NORM_INF), 0);
    step = std::max(step, cv::norm(first(near), lit(shade, 1)(near), cv::NORM_L1) / near.area());
    last = std::max(last, cv::norm(first(near), lit(shade, 99)(near), cv::NORM_L1) / near.area());
  }
  EXPECT_NEAR(middle / ends, 1, 0.03);
  EXPECT_LT(last, 1.5 * step + 1e-3) << "no jump where the loop begins anew";
}

TEST(CloudShade, UnderAChangingWindGoesTheWayOfTheAir) {
  CloudMotion clouds;
  Wind wind{.speed_m_per_s = 2, .direction_deg = 90};
  wind.at = {{.time_s = 2, .speed_m_per_s = 10}};
  const Weather weather(wind, kUnseenEnd);
  const std::vector<cv::Point2d> way = way_over_ground(clouds, weather, kUnseenEnd, 1000);
  ASSERT_EQ(way.size(), 1501u);
  double metres = 0;
  for (int i = 0; i < 5000; ++i) metres += weather.at((i + 0.5) * 2 / 5000).speed_m_per_s * 2 / 5000;
  EXPECT_NEAR(way[50].y, 6 * metres, 0.01 * 6 * metres);
  EXPECT_NEAR(way[50].x, 0, 1e-6);
}

std::string with(std::string text, const std::string& after, const std::string& keys) {
  return text.insert(text.find(after) + after.size(), keys);
}

cv::Mat frame_of(const std::string& text, int frame) {
  MadeScene made(text);
  cv::Mat out(kMadeSize, CV_32FC4);
  made.animation().render(frame, out);
  return out;
}

const std::string kShaded =
    with(made_scene_text("speed = 0"), "motion = \"clouds\"\n", "shade = 0.5\nshade_size = 0.4\n");

TEST(Shadows, OfCloudsFallOnTheGroundAndOnWhatStandsThereWhole) {
  const cv::Mat plain = frame_of(made_scene_text("speed = 0"), 0), shaded = frame_of(kShaded, 0);
  const auto factor = [&](int x, int y) {
    return shaded.at<cv::Vec4f>(y, x)[1] / plain.at<cv::Vec4f>(y, x)[1];
  };
  for (int x = 60; x < 160; x += 7) EXPECT_EQ(factor(x, 20), 1) << "the sky";
  for (int y = 16; y < 80; y += 5) EXPECT_NEAR(factor(25, y), factor(35, 70), 1e-4) << "the tree";
  for (int y = 71; y < 90; y += 4) EXPECT_NEAR(factor(85, y), factor(110, 80), 1e-4) << "the boat";
  double low = 1, high = 0;
  for (int x = 0; x < 160; ++x)
    low = std::min<double>(low, factor(x, 118)), high = std::max<double>(high, factor(x, 118));
  EXPECT_LT(low, 0.7);
  EXPECT_GT(high, 0.95);
}

TEST(Shadows, OfALayerFallOnThoseBehindItAlone) {
  const std::string boat = "hull = [80, 90, 120, 90]\n";
  const std::string keys = "shadow = [100, 90, 60, 105]\nshadow_in_still = false\nshadow_softness = 0\n";
  const cv::Mat plain = frame_of(made_scene_text("speed = 0"), 0),
                cast = frame_of(with(made_scene_text("speed = 0"), boat, keys), 0);
  const auto factor = [&](int x, int y) {
    return cast.at<cv::Vec4f>(y, x)[1] / plain.at<cv::Vec4f>(y, x)[1];
  };
  EXPECT_NEAR(factor(80, 97), 0.6, 1e-4) << "the lake";
  EXPECT_NEAR(factor(150, 100), 1, 1e-4);
  EXPECT_EQ(factor(100, 80), 1) << "the boat itself";
  // The layers alone hold the light that falls on them, and their composite is the film.
  MadeScene made(with(made_scene_text("speed = 5"), boat, keys));
  cv::Mat whole(kMadeSize, CV_32FC4), layer;
  made.animation().render(7, whole);
  cv::Mat sum(kMadeSize, CV_32FC4, cv::Scalar::all(0));
  for (std::size_t i = 5; i-- > 0;) {
    made.animation().layer(i, layer);
    for (int y = 0; y < kMadeSize.height; ++y)
      for (int x = 0; x < kMadeSize.width; ++x) {
        cv::Vec4f& to = sum.at<cv::Vec4f>(y, x);
        to = layer.at<cv::Vec4f>(y, x) + to * (1 - layer.at<cv::Vec4f>(y, x)[3]);
      }
  }
  cv::Mat colours, expected;
  cv::cvtColor(sum, colours, cv::COLOR_BGRA2BGR), cv::cvtColor(whole, expected, cv::COLOR_BGRA2BGR);
  EXPECT_LT(cv::norm(colours, expected, cv::NORM_INF), 1e-4);
}

/// A boat that waves do not move casts on a lake that they do.
TEST(Shadows, OnWaterMoveAsItsColoursDo) {
  const std::string boat = "hull = [80, 90, 120, 90]\n", keeps = "heave = 0\nroll = 0\n",
                    casts = "shadow = [100, 90, 60, 115]\nshadow_in_still = false\nshadow_softness = 1\n";
  constexpr std::size_t kLake = 2;
  const auto light_of = [&](const std::string& wind, MadeScene& cast) {
    const cv::Mat plain = frame_of(with(made_scene_text(wind), boat, keeps), 7);
    cv::Mat shaded(kMadeSize, CV_32FC4), light;
    cast.animation().render(7, shaded);
    cv::divide(shaded, plain, light);
    cv::extractChannel(light, light, 1);
    return light;
  };
  MadeScene unmoved(with(made_scene_text("speed = 0"), boat, keeps + casts)),
      moved(with(made_scene_text("speed = 5"), boat, keeps + casts));
  const cv::Mat calm = light_of("speed = 0", unmoved), waves = light_of("speed = 5", moved);
  std::vector<float> dx(160), dy(160);
  int elsewhere = 0;
  for (int y = 98; y < 112; ++y) {
    moved.animation().motion(kLake).row(0, 0, y, 160, dx.data(), dy.data());
    for (int x = 0; x < 160; ++x) {
      const auto i = static_cast<std::size_t>(x);
      const float from_x = static_cast<float>(x) + dx[i], from_y = static_cast<float>(y) + dy[i];
      if (from_y < 94 || from_y > 118) continue;  // under the boat, or beyond the picture
      ASSERT_NEAR(waves.at<float>(y, x), sampling::bilinear<float>(calm, from_x, from_y), 1e-3)
          << x << " " << y;
      elsewhere += std::abs(waves.at<float>(y, x) - calm.at<float>(y, x)) > 0.05 ? 1 : 0;
    }
  }
  EXPECT_GT(elsewhere, 30);
}

TEST(Shadows, OfSeveralLayersAndOfCloudsMultiply) {
  // The tree's falls down to (60, 115), and crosses the boat's, both on the lake.
  const std::string tree = "armature = [30, 80, 30, 20]\n", boat = "hull = [80, 90, 120, 90]\n",
                    sky = "motion = \"clouds\"\n", more = "shadow_in_still = false\nshadow_softness = 0\n",
                    of_tree = "shadow = [30, 80, 80, 118]\nmass = 1e5\n" + more,
                    of_boat = "shadow = [100, 90, 60, 115]\n" + more, of_clouds = "shade = 0.5\n";
  for (const std::string blend : {"blend = \"over\"\n", "blend = \"add\"\n"}) {
    std::string text = with(made_scene_text("speed = 0"), boat, blend);
    text.replace(text.find("mass = 2\n"), 9, "");
    const cv::Mat plain = frame_of(text, 0);
    const auto lit = [&](bool trees, bool boats, bool clouds) {
      std::string shaded = text;
      if (trees) shaded = with(shaded, tree, of_tree);
      if (boats) shaded = with(shaded, boat, of_boat);
      if (clouds) shaded = with(shaded, sky, of_clouds);
      cv::Mat light;
      cv::divide(frame_of(shaded, 0), plain, light);
      return light;
    };
    const cv::Mat of_all = lit(true, true, true),
                  expected =
                      lit(true, false, false).mul(lit(false, true, false)).mul(lit(false, false, true));
    // Where the boat adds its light, only what lies beside it is told.
    const cv::Rect beside(0, 93, 160, 27);
    EXPECT_LT(cv::norm(of_all(beside), expected(beside), cv::NORM_INF), 1e-4);
    const cv::Mat both = lit(true, true, false);
    int in_both = 0;
    for (int y = 92; y < 118; ++y)
      for (int x = 0; x < 160; ++x) in_both += std::abs(both.at<cv::Vec4f>(y, x)[1] - 0.36) < 1e-3 ? 1 : 0;
    EXPECT_GT(in_both, 10);
  }
}

TEST(Shadows, AreTheSameForAnyNumberOfThreadsAndLoop) {
  const std::string text = with(with(made_scene_text("speed = 5"), "motion = \"clouds\"\n", "shade = 0.5\n"),
                                "hull = [80, 90, 120, 90]\n", "in_3d = true\nshadow = [100, 90, 60, 105]\n");
  const auto frames = [&](std::size_t threads) {
    const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    return frame_of(text, 7);
  };
  EXPECT_EQ(cv::norm(frames(1), frames(4), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(frame_of(text, 0), frame_of(text, 20), cv::NORM_INF), 0);
}

TEST(Shadows, AreRefusedByNameWhereTheyCannotFall) {
  const std::string text = made_scene_text("speed = 5");
  const auto fault = [&](const std::string& after, const std::string& keys) {
    try {
      frame_of(with(text, after, keys), 0);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("no fault");
  };
  const std::string boat = "hull = [80, 90, 120, 90]\n", lake = "motion = \"water\"\n",
                    sky = "motion = \"clouds\"\n";
  // Nearly all that lies far away or outside of the picture is none's fault.
  for (const char* fits : {"shadow = [100, 90, 60, 105]\n", "shadow = [100, 130, 100, 300]\n",
                           "shadow = [100, 90, 900000, 91]\n", "shadow = [100, 90, 100, -900000]\n"})
    EXPECT_EQ(fault(boat, fits), "no fault") << fits;
  EXPECT_THAT(fault(boat, "shadow = [100, 90, 60, 90]\n"),
              AllOf(HasSubstr("made.toml:"), HasSubstr("shadow"), HasSubstr("ends in the row")));
  EXPECT_THAT(
      fault(boat, "shadow = [100, 60, 60, 90]\n"),
      AllOf(HasSubstr("layer boat: its shadow begins at row 60"), HasSubstr("where the layer stands")));
  EXPECT_THAT(fault(lake, "shadow = [100, 60, 60, 90]\n"),
              HasSubstr("a layer of motion \"water\" casts none"));
  EXPECT_THAT(fault(sky, "shadow = [100, 60, 60, 90]\n"), HasSubstr("Give shade"));
  EXPECT_THAT(fault(sky, "shade = 0.5\nground = [0, 119, 160, 119]\n"), HasSubstr("no ground lies below"));
  EXPECT_THAT(fault(sky, "shade = 0.5\nground = [5, 9, 5, 119]\n"), HasSubstr("stands upright"));
}

}  // namespace
}  // namespace freshet::synth::scene
