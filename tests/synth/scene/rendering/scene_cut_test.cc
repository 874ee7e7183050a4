#include "synth/scene/rendering/scene_cut.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "media/picture/openraster.h"
#include "synth/scene/scene_file.h"

namespace freshet::synth::scene {
namespace {

/// A blue picture with half transparent red paint over a square of it, taken as the word says.
std::vector<LayerPixels> cut_with(const std::string& word) {
  const std::filesystem::path folder = testing::TempDir();
  cv::Mat paint(30, 40, CV_8UC4, cv::Scalar::all(0));
  paint(cv::Rect(10, 8, 20, 14)).setTo(cv::Scalar(0, 0, 255, 128));
  media::write_openraster(
      folder / "paint.ora",
      {.canvas = paint.size(), .layers = {{.name = "glow", .pixels = paint, .at = {}}}, .notices = {}});
  media::Still still;
  still.bgr = cv::Mat(paint.size(), CV_8UC3, cv::Scalar(204, 0, 0));
  const Scene scene =
      parse_scene("picture = \"still.png\"\npaint = \"paint.ora\"\n[[layer]]\nname = \"glow\"\nmatte = \"" +
                      word + "\"\nmotion = \"still\"\n",
                  folder / "scene.toml");
  return cut_scene(scene, still);
}

TEST(SceneCut, WhatIsPaintedBringsItsColoursAndAlpha) {
  const std::vector<LayerPixels> pixels = cut_with("painted");
  ASSERT_EQ(pixels.size(), 2u);
  const cv::Vec3f colour = pixels[0].colour.at<cv::Vec3f>(15, 20);
  EXPECT_NEAR(colour[2], 1, 0.01);
  EXPECT_NEAR(colour[0], 0, 0.01);
  EXPECT_NEAR(pixels[0].alpha.at<float>(15, 20), 128 / 255.0, 0.01);
  EXPECT_EQ(pixels[0].alpha.at<float>(3, 3), 0);
}

TEST(SceneCut, PaintTakesThePicturesColours) {
  const std::vector<LayerPixels> pixels = cut_with("paint");
  ASSERT_EQ(pixels.size(), 2u);
  EXPECT_NEAR(pixels[0].colour.at<cv::Vec3f>(15, 20)[0], 0.8, 0.02);
  EXPECT_NEAR(pixels[0].colour.at<cv::Vec3f>(15, 20)[2], 0, 0.02);
}

}  // namespace
}  // namespace freshet::synth::scene
