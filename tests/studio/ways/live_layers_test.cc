#include "studio/ways/live_layers.h"

#include <filesystem>
#include <fstream>
#include <stop_token>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "tests/tools/work_folder.h"

namespace freshet::studio {
namespace {

struct Rolled {
  cv::Size size;
  int first = -1;
  std::vector<cv::Mat> frames;
};

/// Layers over one picture, kept from film to film, and how often they were cut.
class LiveLayersTest : public testing::Test {
 protected:
  Rolled roll(const Document& document, int first = 0, std::stop_token stop = {}) {
    Rolled rolled;
    const LiveLayers::Places places{
        .project = std::filesystem::path(folder_ / ""),
        .write =
            [&](const std::string& name, const std::vector<WayFile>& files) {
              const std::filesystem::path to = folder_ / ("ways/" + name);
              std::filesystem::create_directories(to);
              for (const WayFile& file : files) std::ofstream(to / file.name) << file.bytes;
            },
        .begin =
            [&](cv::Size size, int frames, double fps, int from) {
              rolled.size = size;
              rolled.first = from;
              EXPECT_GT(frames, 0);
              EXPECT_EQ(fps, 25);
            },
        .add = [&](const cv::Mat& frame) { rolled.frames.push_back(frame.clone()); }};
    layers_.render(document, picture, first, places,
                   {.progress = [&](const Progress&) { ++cuts; }, .stop = std::move(stop)});
    return rolled;
  }

  static cv::Mat textured(cv::Size size) {
    cv::Mat out(size, CV_8UC3);
    cv::RNG(4).fill(out, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(out, out, {}, 3);
    cv::normalize(out, out, 20, 235, cv::NORM_MINMAX);
    return out;
  }

  /// Clouds above, and ground that stands still.
  static Document drawn(cv::Size size) {
    const auto w = static_cast<float>(size.width), h = 0.5f * static_cast<float>(size.height);
    DrawnLayer sky{.name = "sky", .motion = "clouds"};
    sky.paint = {{.points = {{0, 0}, {w, 0}, {w, h}, {0, h}}, .is_area = true}};
    sky.drift = 40;
    Document document;
    document.scene.frames = 12;
    document.scene.layers = {sky, {.name = "ground", .motion = "still", .matte = LayerMatte::kRest}};
    return document;
  }

  static double differ(const cv::Mat& one, const cv::Mat& other) {
    return cv::norm(one, other, cv::NORM_INF);
  }

  cv::Mat picture = textured({160, 120});
  int cuts = 0;

 private:
  tools::WorkFolder folder_;
  LiveLayers layers_;
};

TEST_F(LiveLayersTest, FramesBeginAnywhereAndGoRound) {
  const Document document = drawn(picture.size());
  const Rolled whole = roll(document), later = roll(document, 19);
  ASSERT_EQ(whole.frames.size(), 12U);
  EXPECT_EQ(whole.size, picture.size());
  EXPECT_EQ(later.first, 7);
  ASSERT_EQ(later.frames.size(), 12U);
  for (int i = 0; i < 12; ++i)
    EXPECT_EQ(differ(later.frames[static_cast<std::size_t>(i)],
                     whole.frames[static_cast<std::size_t>((i + 7) % 12)]),
              0);
  EXPECT_GT(differ(whole.frames[0], whole.frames[5]), 20) << "clouds drift";
}

TEST_F(LiveLayersTest, AreCutAgainOnlyWhereTheirPlacesChange) {
  Document document = drawn(picture.size());
  const Rolled before = roll(document);
  EXPECT_EQ(cuts, 1);
  document.scene.layers[0].drift = 90;
  document.scene.wind = 9;
  const Rolled faster = roll(document);
  EXPECT_EQ(cuts, 1);
  EXPECT_GT(differ(before.frames[5], faster.frames[5]), 20);
  document.scene.layers[0].paint[0].points[2].y -= 20;
  roll(document);
  EXPECT_EQ(cuts, 2);
}

TEST_F(LiveLayersTest, ALargePictureIsReducedAndItsSpeedsWithIt) {
  picture = textured({1280, 320});
  Document document = drawn(picture.size());
  document.scene.loop = false;
  document.scene.layers[0].drift = 100;  // 50 px/s of 640: 22 px in 11 frames
  const Rolled rolled = roll(document);
  ASSERT_EQ(rolled.size, cv::Size(640, 160));
  const cv::Rect sky(100, 10, 400, 50);
  EXPECT_LT(cv::norm(rolled.frames[11](sky + cv::Point(22, 0)), rolled.frames[0](sky), cv::NORM_L1),
            0.5 * cv::norm(rolled.frames[11](sky), rolled.frames[0](sky), cv::NORM_L1));
}

TEST_F(LiveLayersTest, PatchesStandStillAndNeedNoStore) {
  Document document = drawn(picture.size());
  document.scene.layers[0].motion = "patches";
  const Rolled rolled = roll(document);
  for (const cv::Mat& frame : rolled.frames) EXPECT_EQ(differ(frame, rolled.frames[0]), 0);
}

TEST_F(LiveLayersTest, WhatIsLackingIsSaidAndAStopIsHeeded) {
  Document document = drawn(picture.size());
  document.scene.layers[0].motion = "tree";
  EXPECT_THROW(roll(document), Error) << "it has no armature";
  std::stop_source stop;
  stop.request_stop();
  try {
    roll(drawn(picture.size()), 0, stop.get_token());
    FAIL() << "it went on";
  } catch (const Error& fault) {
    EXPECT_EQ(fault.kind(), ErrorKind::kCancelled);
  }
  EXPECT_EQ(roll(drawn(picture.size())).frames.size(), 12U) << "and nothing half cut is kept";
}

}  // namespace
}  // namespace freshet::studio
