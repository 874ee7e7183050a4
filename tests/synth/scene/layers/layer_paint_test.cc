#include "synth/scene/layers/layer_paint.h"

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/synth/scene/layers/made_layers.h"

namespace freshet::synth::scene {
namespace {

std::vector<CutLayer> two_layers() {
  const cv::Size size(40, 30);
  CutLayer front{.name = "front",
                 .colour = made_texture(size, {0.2, 0.5, 0.8}, 0.2f, 1),
                 .alpha = made_disc(size, {20, 15}, 9, 4),
                 .filled = {}};
  cv::Mat bytes;
  front.alpha.convertTo(bytes, CV_8U, 255);
  bytes.convertTo(front.alpha, CV_32F, 1 / 255.0);
  front.colour.setTo(cv::Scalar::all(0), front.alpha == 0);
  CutLayer rest{.name = "rest",
                .colour = made_texture(size, {0.7, 0.4, 0.1}, 0.2f, 2),
                .alpha = cv::Mat::ones(size, CV_32F),
                .filled = front.alpha > 0};
  return {front, rest};
}

TEST(LayerPaint, ComesBackAsItWentWithinTheBits) {
  const std::vector<CutLayer> layers = two_layers();
  const std::vector<std::string> names{"front", "rest"};
  for (const PaintBits bits : {PaintBits::k8, PaintBits::k16}) {
    std::vector<std::string> notices;
    const std::vector<CutLayer> back =
        from_paint(to_paint(layers, bits), names, {40, 30}, "paint.ora", &notices);
    EXPECT_TRUE(notices.empty());  // nobody asked for what was filled in, and it is no paint
    const double level = bits == PaintBits::k8 ? 255 : 65535;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      EXPECT_LT(cv::norm(back[i].alpha, layers[i].alpha, cv::NORM_INF), 1e-6);
      EXPECT_LT(cv::norm(back[i].colour, layers[i].colour, cv::NORM_INF), 0.501 / level);
    }
    EXPECT_LT(cv::norm(composited(back), composited(layers), cv::NORM_INF), 1 / level);
  }
}

TEST(LayerPaint, ShowsWhatWasFilledInAHiddenLayer) {
  const media::OpenRaster paint = to_paint(two_layers(), PaintBits::k8);
  ASSERT_EQ(paint.layers.size(), 3u);
  EXPECT_EQ(paint.layers[0].name, kFilledName);
  EXPECT_FALSE(paint.layers[0].visible);
}

TEST(LayerPaint, FaultsNameFileLayerAndRemedy) {
  media::OpenRaster paint = to_paint(two_layers(), PaintBits::k8);
  const auto fault = [&](std::vector<std::string> names, cv::Size size) -> std::string {
    try {
      from_paint(paint, names, size, "paint.ora");
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_NE(fault({"front"}, {41, 30}).find("its canvas is 40 x 30 px"), std::string::npos);
  EXPECT_NE(fault({"boat"}, {40, 30}).find("none of its layers is called \"boat\""), std::string::npos);
  paint.layers.push_back(paint.layers[1]);
  EXPECT_NE(fault({"front"}, {40, 30}).find("2 of its layers are called \"front\""), std::string::npos);
  paint.layers.pop_back();
  paint.layers[1].pixels.setTo(cv::Scalar::all(0));
  EXPECT_NE(fault({"front"}, {40, 30}).find("nothing is painted"), std::string::npos);
  EXPECT_EQ(fault({"rest"}, {40, 30}), "none");
}

}  // namespace
}  // namespace freshet::synth::scene
