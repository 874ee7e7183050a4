#include "synth/scene/layers/cut_layers.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "freshet/error.h"
#include "tests/synth/scene/layers/made_layers.h"

namespace freshet::synth::scene {
namespace {

constexpr int kWide = 120, kHigh = 90;

struct Made {
  cv::Mat picture;
  std::vector<LayerMatte> layers;
};

// A disc before a lake below a sky: the lake has a matte of its own, with a hole where the disc is seen.
Made disc_before_lake() {
  const cv::Size size(kWide, kHigh);
  const cv::Mat sky = made_texture(size, {0.9, 0.8, 0.7}, 0.1f, 1),
                lake = made_texture(size, {0.5, 0.3, 0.1}, 0.2f, 2),
                disc = made_texture(size, {0.1, 0.2, 0.8}, 0.2f, 3);
  cv::Mat shore = cv::Mat::zeros(size, CV_32F);
  shore.rowRange(kHigh / 2, kHigh).setTo(1);
  const cv::Mat alpha = made_disc(size, {60, 46}, 16, 4);
  Made made{made_over(disc, alpha, made_over(lake, shore, sky)), {}};
  cv::Mat seen_lake = shore > 0.5;
  seen_lake.setTo(0, alpha > 0.5);
  made.layers = {{.name = "disc", .matte = made_trimap(alpha, 2), .kind = MatteKind::kTrimap},
                 {.name = "lake", .matte = seen_lake, .kind = MatteKind::kRegion},
                 {.name = "sky", .matte = {}, .kind = MatteKind::kRest}};
  return made;
}

bool alike(const std::vector<CutLayer>& a, const std::vector<CutLayer>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (cv::norm(a[i].colour, b[i].colour, cv::NORM_INF) != 0 ||
        cv::norm(a[i].alpha, b[i].alpha, cv::NORM_INF) != 0)
      return false;
  return a.size() == b.size();
}

TEST(CutLayers, LaidOverEachOtherUnmovedTheyGiveThePicture) {
  const Made made = disc_before_lake();
  for (const AlphaMethod method :
       {AlphaMethod::kBayesian, AlphaMethod::kInformationFlow, AlphaMethod::kGuided, AlphaMethod::kHard}) {
    const std::vector<CutLayer> layers = cut_layers(made.picture, made.layers, {.alpha = method});
    ASSERT_EQ(layers.size(), 3u);
    EXPECT_LT(cv::norm(composited(layers), made.picture, cv::NORM_INF), 1e-4) << to_string(method);
    // Also of eight bits: within a level.
    std::vector<CutLayer> rounded = layers;
    for (CutLayer& layer : rounded) {
      cv::Mat bytes;
      layer.colour.convertTo(bytes, CV_8U, 255);
      bytes.convertTo(layer.colour, CV_32F, 1 / 255.0);
      layer.alpha.convertTo(bytes, CV_8U, 255);
      bytes.convertTo(layer.alpha, CV_32F, 1 / 255.0);
    }
    EXPECT_LT(cv::norm(composited(rounded), made.picture, cv::NORM_INF), 1.0 / 255) << to_string(method);
  }
}

TEST(CutLayers, WhatIsBehindANearLayerGoesOnAsWhatItIs) {
  const Made made = disc_before_lake();
  const std::vector<CutLayer> layers = cut_layers(made.picture, made.layers);
  const cv::Mat lake = layers[1].alpha;
  // Within the disc, well below and well above the shore.
  EXPECT_GT(cv::mean(lake(cv::Rect(55, 52, 10, 6)))[0], 0.9);
  EXPECT_LT(cv::mean(lake(cv::Rect(55, 34, 10, 6)))[0], 0.1);
  // And has the lake's colours there, not the disc's.
  const cv::Scalar colour = cv::mean(layers[1].colour(cv::Rect(55, 52, 10, 6)));
  EXPECT_NEAR(colour[0], 0.5, 0.1);
  EXPECT_NEAR(colour[2], 0.1, 0.1);
  EXPECT_EQ(layers[1].filled.at<std::uint8_t>(55, 60), 255);
  EXPECT_EQ(layers[1].filled.at<std::uint8_t>(80, 10), 0);
}

TEST(CutLayers, ColoursOfARimAreTheLayersOwn) {
  // Blue behind red: copied, the rim would bring blue along.
  const Made made = disc_before_lake();
  const std::vector<CutLayer> layers = cut_layers(made.picture, made.layers);
  const cv::Mat truth = made_texture({kWide, kHigh}, {0.1, 0.2, 0.8}, 0.2f, 3);
  const cv::Mat rim = (layers[0].alpha > 0.3) & (layers[0].alpha < 0.8);
  ASSERT_GT(cv::countNonZero(rim), 50);
  const double found = cv::norm(layers[0].colour, truth, cv::NORM_L2, rim),
               copied = cv::norm(made.picture, truth, cv::NORM_L2, rim);
  EXPECT_LT(found, 0.4 * copied);
}

// Chuang et al. 2005, Sec. 5: transparency that moves along. A layer with leaves and gaps between them, before stripes:
// what is seen through it must stay behind.
TEST(CutLayers, WhatIsSeenThroughAGreyMatteStaysBehind) {
  for (const bool solid : {true, false}) {
    const cv::Size size(kWide, kHigh);
    cv::Mat behind(size, CV_32FC3), alpha = made_disc(size, {60, 46}, 26, 4), leaves;
    for (int x = 0; x < kWide; ++x)
      behind.col(x).setTo(x / 10 % 2 == 0 ? cv::Scalar(.9, .6, .2) : cv::Scalar(.4, .2, .1));
    // Leaves: here and there a pixel or two wholly theirs, else a third to a half.
    cv::extractChannel(made_texture(size, {.5, .5, .5}, 1.0f, 8), leaves, 0);
    leaves = cv::min(cv::max(leaves, .3), solid ? 1. : .6);
    if (solid) leaves.setTo(1, leaves > .7);
    alpha = alpha.mul(leaves);
    const cv::Mat own = made_texture(size, {.1, .5, .2}, .1f, 3);
    const cv::Mat picture = made_over(own, alpha, behind);
    cv::Mat matte;
    alpha.convertTo(matte, CV_8U, 255);
    const std::vector<LayerMatte> mattes{{.name = "tree", .matte = matte, .kind = MatteKind::kAlpha},
                                         {.name = "lake", .matte = {}, .kind = MatteKind::kRest}};
    const std::vector<CutLayer> layers = cut_layers(picture, mattes);
    const cv::Mat thin = (alpha > .25) & (alpha < .7);
    ASSERT_GT(cv::countNonZero(thin), 300);
    const double found = cv::norm(layers[0].colour, own, cv::NORM_L2, thin),
                 copied = cv::norm(picture, own, cv::NORM_L2, thin);
    const double filled = cv::norm(layers[1].colour, behind, cv::NORM_L2, thin),
                 unfilled = cv::norm(picture, behind, cv::NORM_L2, thin);
    EXPECT_LT(found, .2 * copied) << solid;
    EXPECT_LT(filled, .2 * unfilled) << solid;
    EXPECT_LT(cv::norm(composited(layers), picture, cv::NORM_INF), 1e-4);
  }
}

TEST(CutLayers, AreTheSameForAnyNumberOfThreads) {
  const Made made = disc_before_lake();
  std::vector<CutLayer> one;
  {
    const oneapi::tbb::global_control single(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    one = cut_layers(made.picture, made.layers);
  }
  const oneapi::tbb::global_control several(oneapi::tbb::global_control::max_allowed_parallelism, 5);
  EXPECT_TRUE(alike(one, cut_layers(made.picture, made.layers)));
}

TEST(CutLayers, RefillChangesNothingOutsideOfItsRegionButWhatLiesBehind) {
  const Made made = disc_before_lake();
  const std::vector<LayerMatte> two{made.layers[0], made.layers[2]};
  CutOptions options;
  options.fill.search_px = 12;
  const std::vector<CutLayer> before = cut_layers(made.picture, two, options);
  options.refill = cv::Mat::zeros(made.picture.size(), CV_8U);
  options.refill(cv::Rect(50, 30, 20, 12)).setTo(255);
  options.refill_search_px = 60;
  const std::vector<CutLayer> after = cut_layers(made.picture, two, options);
  cv::Mat changed, any;
  cv::absdiff(before[1].colour, after[1].colour, changed);
  cv::transform(changed, any, cv::Matx13f(1, 1, 1));
  EXPECT_GT(cv::countNonZero(any), 0);
  EXPECT_EQ(cv::countNonZero((any > 0) & (options.refill == 0)), 0);
  EXPECT_LT(cv::norm(composited(after), made.picture, cv::NORM_INF), 1e-4);
}

TEST(CutLayers, AMastThinnerThanTheBandIsKept) {
  const cv::Size size(kWide, kHigh);
  cv::Mat picture = made_texture(size, {0.8, 0.6, 0.5}, 0.15f, 1), matte(size, CV_8U, cv::Scalar(0));
  matte(cv::Rect(40, 60, 40, 20)).setTo(255);  // a hull
  matte(cv::Rect(59, 10, 2, 50)).setTo(255);   // its mast
  picture.setTo(cv::Scalar(0.1, 0.15, 0.2), matte);
  const std::vector<CutLayer> layers = cut_layers(
      picture,
      std::vector<LayerMatte>{{.name = "boat", .matte = matte}, {.name = "lake", .kind = MatteKind::kRest}},
      {.band_px = 14});
  EXPECT_GT(cv::mean(layers[0].alpha(cv::Rect(59, 12, 2, 40)))[0], 0.9);
  EXPECT_LT(cv::mean(layers[0].alpha(cv::Rect(64, 12, 10, 40)))[0], 0.1);
}

TEST(CutLayers, PaintIsTakenAsItIs) {
  Made made = disc_before_lake();
  cv::Mat alpha = made_disc({kWide, kHigh}, {60, 46}, 20, 2);
  const cv::Mat paint(kHigh, kWide, CV_32FC3, cv::Scalar(0, 1, 0));
  made.layers[0] = {.name = "disc", .matte = alpha, .kind = MatteKind::kAlpha, .paint = paint};
  const std::vector<CutLayer> layers = cut_layers(made.picture, made.layers);
  EXPECT_EQ(layers[0].colour.at<cv::Vec3f>(46, 60), cv::Vec3f(0, 1, 0));
  // Behind it is no disc any more, that it covers.
  const cv::Vec3f behind = layers[1].alpha.at<float>(60, 60) > 0.5f ? layers[1].colour.at<cv::Vec3f>(60, 60)
                                                                    : layers[2].colour.at<cv::Vec3f>(60, 60);
  EXPECT_LT(behind[2], 0.4);
}

TEST(CutLayers, KindsAreToldByTheGreys) {
  cv::Mat matte = cv::Mat::zeros(4, 4, CV_8U);
  matte.at<std::uint8_t>(1, 1) = 255;
  EXPECT_EQ(kind_of_matte(matte), MatteKind::kRegion);
  matte.at<std::uint8_t>(1, 2) = 127;
  EXPECT_EQ(kind_of_matte(matte), MatteKind::kTrimap);
  matte.at<std::uint8_t>(1, 3) = 60;
  EXPECT_EQ(kind_of_matte(matte), MatteKind::kAlpha);
}

template <class Change>
std::string fault_of(Change&& change) {
  Made made = disc_before_lake();
  change(made);
  try {
    cut_layers(made.picture, made.layers);
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

TEST(CutLayers, FaultsNameTheLayerAndTheRemedy) {
  EXPECT_NE(
      fault_of([](Made& m) { m.layers.pop_back(); }).find("\"lake\": the furthest layer is not the rest"),
      std::string::npos);
  EXPECT_NE(fault_of([](Made& m) { std::swap(m.layers[1], m.layers[2]); }).find("others lie behind it"),
            std::string::npos);
  EXPECT_NE(fault_of([](Made& m) { m.layers[0].matte = cv::Mat::zeros(5, 7, CV_8U); }).find("7 x 5 px"),
            std::string::npos);
  EXPECT_NE(fault_of([](Made& m) { m.layers[1].matte.setTo(0); }).find("\"lake\": its matte is black"),
            std::string::npos);
  EXPECT_NE(fault_of([](Made& m) { m.layers[0].matte.setTo(255); }).find("cover the whole picture"),
            std::string::npos);
}

}  // namespace
}  // namespace freshet::synth::scene
