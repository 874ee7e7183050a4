// The light of a fire on what is around it.
#include "synth/scene/rendering/layer_glow.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "freshet/error.h"
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
                                 ::testing::HasSubstr("Give it to a fire")));
  }
}

}  // namespace
}  // namespace freshet::synth::scene
