// The light of a fire, and of glittering water, on what is around it.
#include "synth/scene/rendering/layer_glow.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "freshet/error.h"
#include "synth/scene/rendering/glitter_glow.h"
#include "tests/synth/scene/made_scene.h"

namespace freshet::synth::scene {
namespace {

/// A fire of 6 x 8 px of one colour, at times so bright.
cv::Mat flames(float bright) { return cv::Mat(8, 6, CV_32FC4, cv::Scalar(0.1, 0.2, 0.4, 0.5) * bright); }

TEST(LayerGlow, GoesWithTheLightByItsColourAndFallsOffWithTheDistance) {
  LayerGlow glow(0.5, 40.0, {200, 150});
  glow.see({}, {90, 60});
  EXPECT_EQ(glow.light().gain[2], 0) << "before anything burns";
  glow.see(flames(0.0f), {90, 60});
  EXPECT_EQ(glow.light().gain[2], 0);
  glow.see(flames(1.0f), {90, 60});
  for (const float gain : glow.light().gain) EXPECT_NEAR(gain, 0, 1e-6) << "level 1 is the still";
  glow.see(flames(1.6f), {90, 60});
  EXPECT_NEAR(glow.light().gain[0], 0.5 * 0.6 * 0.25, 1e-5);
  EXPECT_NEAR(glow.light().gain[1], 0.5 * 0.6 * 0.5, 1e-5);
  EXPECT_NEAR(glow.light().gain[2], 0.5 * 0.6, 1e-5);
  glow.see({}, {90, 60});
  EXPECT_NEAR(glow.light().gain[2], -0.5, 1e-6) << "it went out";
  // Its middle lies at (92.5, 63.5).
  const cv::Mat& falloff = *glow.light().falloff;
  EXPECT_NEAR(falloff.at<float>(63, 92), 1, 1e-3);
  EXPECT_NEAR(falloff.at<float>(63, 132), 0.5, 0.01);
  EXPECT_NEAR(falloff.at<float>(143, 92), 0.2, 0.01);
}

/// Frames that grow brighter.
class Flaring : public LayerFrames {
 public:
  const cv::Mat& next() override { return frame_ = flames(1 + 0.5f * static_cast<float>(frames_++)); }
  std::optional<cv::Mat> motion() override { return {}; }
  cv::Point at() const override { return {60, 100}; }

 private:
  cv::Mat frame_;
  int frames_ = 0;
};

cv::Mat second_frame(const std::string& fire_keys) {
  MadeScene made(made_scene_text("speed = 0"));
  Scene scene = parse_scene(
      "picture = \"still.png\"\n[[layer]]\nname = \"fire\"\nmotion = \"footage\"\n"
      "file = \"fire.mkv\"\n" +
          fire_keys + made_scene_text("speed = 0").substr(made_scene_text("speed = 0").find("[[layer]]")),
      "made.toml");
  scene.wind.speed_m_per_s = 0;
  read_marks(scene, kMadeSize);
  std::vector<LayerPixels> pixels = made.pixels();
  pixels.insert(pixels.begin(), LayerPixels{});
  SceneAnimation animation(scene, pixels, kMadeSize,
                           [](const SceneLayer&, const LayerPixels&) { return std::make_unique<Flaring>(); });
  cv::Mat out(kMadeSize, CV_32FC4);
  animation.render(0, out);
  animation.render(1, out);
  return out;
}

TEST(LayerGlow, FallsOnAllLayersButTheSkyAndItself) {
  for (const std::string blend : {"blend = \"over\"\n", "blend = \"add\"\n"}) {
    const cv::Mat plain = second_frame(blend), lit = second_frame(blend + "glow = 1\nglow_reach = 50\n");
    const auto factor = [&](int x, int y, int c) {
      return lit.at<cv::Vec4f>(y, x)[c] / plain.at<cv::Vec4f>(y, x)[c];
    };
    const auto expected = [&](int x, int y, double colour) {
      return 1 + 0.5 * colour / (1 + ((x - 62.5) * (x - 62.5) + (y - 103.5) * (y - 103.5)) / 2500);
    };
    for (const cv::Point p : {cv::Point(30, 70), {100, 80}, {80, 110}, {140, 65}}) {
      EXPECT_NEAR(factor(p.x, p.y, 2), expected(p.x, p.y, 1), 1e-3) << p;
      EXPECT_NEAR(factor(p.x, p.y, 0), expected(p.x, p.y, 0.25), 1e-3) << p;
    }
    EXPECT_EQ(factor(100, 20, 2), 1) << "the sky";
    const cv::Vec4f behind = plain.at<cv::Vec4f>(104, 62), both = lit.at<cv::Vec4f>(104, 62);
    EXPECT_NEAR(both[2] - 0.6, (behind[2] - 0.6) * expected(62, 104, 1), 2e-3) << "the fire is as it was";
  }
}

TEST(LayerGlow, IsNoPropertyOfWhatHasOneLight) {
  std::string text = made_scene_text("speed = 5");
  text.insert(text.find("mass = 2"), "glow = 1\n");
  try {
    parse_scene(text, "made.toml");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(),
                ::testing::AllOf(::testing::HasSubstr("glow: a layer of motion \"tree\" has one light"),
                                 ::testing::HasSubstr("Give it to a fire, a layer")));
  }
}

/// Water in the lower half, with a glint of 6 px at each place.
cv::Mat glittering(const std::vector<cv::Point>& places, float bright = 1) {
  cv::Mat water(150, 200, CV_32FC4, cv::Scalar::all(0));
  water.rowRange(75, 150).setTo(cv::Scalar(0.2, 0.2, 0.2, 1));
  for (const cv::Point& at : places)
    water(cv::Rect(at.x - 3, at.y - 3, 6, 6)) = cv::Scalar(0.25 * bright, 0.5 * bright, bright, 1);
  return water;
}

TEST(GlitterGlow, PlaysAboutEachGlint) {
  const cv::Mat still = glittering({{50, 90}, {150, 90}});
  GlitterGlow glow(0.8, 12.0, still);
  const cv::Mat& falloff = *glow.light().falloff;
  EXPECT_NEAR(glow.light().gain[0], 0.8 * 0.25, 1e-6);
  EXPECT_NEAR(glow.light().gain[1], 0.8 * 0.5, 1e-6);
  EXPECT_NEAR(glow.light().gain[2], 0.8, 1e-6);
  glow.see(still);
  EXPECT_LT(cv::norm(falloff, cv::NORM_INF), 1e-5) << "the still is as its own glints light it";
  glow.see(glittering({{50, 90}, {100, 90}}));
  EXPECT_NEAR(falloff.at<float>(90, 100), 1, 0.06) << "as much more as the still's brightest place has";
  EXPECT_NEAR(falloff.at<float>(78, 100), 0.5, 0.06) << "half of it at the reach";
  EXPECT_NEAR(falloff.at<float>(90, 150), -1, 0.06) << "it went out";
  EXPECT_NEAR(falloff.at<float>(90, 50), 0, 0.02);
  EXPECT_NEAR(falloff.at<float>(20, 100), 0, 0.02) << "far away";

  GlitterGlow dull(1, 12.0, glittering({}));
  dull.see(still);
  EXPECT_EQ(cv::norm(*dull.light().falloff, cv::NORM_INF), 0) << "the still does not glitter";
}

TEST(GlitterGlow, FallsOnWhatIsBesideTheWaterInAnyOrderOfFrames) {
  const auto frames = [](const std::string& keys, const std::vector<int>& order) {
    std::string text = made_scene_text("speed = 8");
    text.insert(text.find("amplitude = 6"), keys);
    MadeScene lit(text);
    std::vector<cv::Mat> out(20);
    for (const int frame : order) {
      cv::Mat one(kMadeSize, CV_32FC4);
      lit.animation().render(frame, one);
      out[static_cast<std::size_t>(frame)] = one;
    }
    return out;
  };
  const std::vector<cv::Mat> plain = frames("", {3, 7, 12});
  for (const std::string more : {"", "mirrors = true\n"}) {
    const std::vector<cv::Mat> lit = frames("glow = 1\n" + more, {3, 7, 12}),
                               again = frames("glow = 1\n" + more, {12, 3, 7});
    double most = 0;
    for (const std::size_t at : {3u, 7u, 12u}) {
      EXPECT_EQ(cv::norm(lit[at], again[at], cv::NORM_INF), 0) << more << at;
      const cv::Mat change = cv::abs(lit[at] - plain[at]);
      most = std::max(most, cv::norm(change(cv::Rect(80, 75, 40, 14)), cv::NORM_INF));
      EXPECT_EQ(cv::norm(change(cv::Rect(60, 0, 100, 40)), cv::NORM_INF), 0) << "the sky";
      if (more.empty()) {
        EXPECT_LT(cv::norm(change(cv::Rect(0, 100, 160, 20)), cv::NORM_INF), 1e-3)
            << "the water is as it was";
      }
    }
    EXPECT_GT(most, 0.02) << "the boat";
  }
}

}  // namespace
}  // namespace freshet::synth::scene
