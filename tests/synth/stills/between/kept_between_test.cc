#include "synth/stills/between/kept_between.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include <unistd.h>

#include "cache/content_hash.h"
#include "synth/stills/rendering.h"
#include "tests/harness/scratch_folder.h"
#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

namespace fs = std::filesystem;

class Kept : public testing::Test {
 protected:
  std::uintmax_t bytes() const {
    std::uintmax_t sum = 0;
    for (const auto& each : fs::directory_iterator(folder_))
      if (each.is_regular_file()) sum += each.file_size();
    return sum;
  }
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_ / "kept";
};

TEST_F(Kept, APictureIsMadeOnceAndAgainWhenItsStillsChange) {
  const std::vector<cv::Mat> stills = made_pendulum({.3, .5, .7});
  int made = 0;
  const auto picture = [&](int a, int b, double phase, cv::Point corner = {}) {
    cache::ResultCache cache(folder_);
    const cv::Rect box(corner, cv::Size(64, 64));
    const BetweenKey key{cache::content_hash(stills[a]), cache::content_hash(stills[b]), box, phase, 160};
    return KeptBetween(&cache).picture(key, stills[a].type(), [&] {
      ++made;
      cv::Mat mean;
      cv::addWeighted(stills[a](box), 1 - phase, stills[b](box), phase, 0, mean);
      return mean;
    });
  };
  const cv::Mat first = picture(0, 1, .25), again = picture(0, 1, .25);
  EXPECT_EQ(made, 1);
  EXPECT_EQ(cv::norm(first, again, cv::NORM_INF), 0);
  picture(0, 2, .25);
  picture(0, 1, .5);
  EXPECT_EQ(made, 3);
  picture(0, 1, .25, {8, 0});
  picture(0, 1, .25, {0, 8});
  EXPECT_EQ(made, 5) << "elsewhere is another picture";
}

/// Two pendulums, each a region with its own clock.
struct TwoPendulums {
  std::vector<std::string> names;
  std::vector<cv::Mat> stills;
  std::vector<Region> regions;

  TwoPendulums() {
    const cv::Mat ground = made_ground({320, 96});
    const double left[5] = {0, .25, .5, .75, 1}, right[5] = {.5, 1, .25, 0, .75};
    for (int i = 0; i < 5; ++i) {
      names.push_back(std::to_string(i));
      stills.push_back(ground.clone());
      draw_pendulum(stills.back(), {10, 24, 130, 48}, left[i]);
      draw_pendulum(stills.back(), {180, 24, 130, 48}, right[i]);
    }
    for (const int x : {5, 175}) {
      regions.push_back({.name = std::to_string(regions.size() + 1),
                         .mask = cv::Mat(ground.size(), CV_8U, cv::Scalar(0)),
                         .parent = {}});
      regions.back().mask(cv::Rect(x, 20, 140, 56)).setTo(255);
    }
  }
  std::vector<cv::Mat> frames(const std::vector<RegionEdits>& edits, cache::ResultCache* cache) const {
    const Plan plan = make_plan(stills, names, regions, {.seconds = 2, .edits = edits});
    std::vector<cv::Mat> out;
    render_frames(plan, stills,
                  {.fps = 10, .frames = 20, .flow_side = 160, .grown_px = 1, .feather_px = 2, .cache = cache},
                  [&](const cv::Mat& frame) { out.push_back(frame.clone()); });
    return out;
  }
};

TEST_F(Kept, AfterAnEditOnlyTheEditedRegionIsMadeAnew) {
  const TwoPendulums scene;
  const auto with_cache = [&](const std::vector<RegionEdits>& edits) {
    cache::ResultCache cache(folder_);
    return scene.frames(edits, &cache);
  };
  RegionEdits slower;
  slower.region = "2";
  slower.speed = .7;
  const std::vector<RegionEdits> edits{slower};
  const auto same = [](const std::vector<cv::Mat>& a, const std::vector<cv::Mat>& b) {
    for (std::size_t i = 0; i < a.size(); ++i)
      if (cv::norm(a[i], b[i], cv::NORM_INF) != 0) return false;
    return a.size() == b.size();
  };
  EXPECT_TRUE(same(with_cache({}), scene.frames({}, nullptr)));
  const std::uintmax_t first = bytes();
  EXPECT_TRUE(same(with_cache({}), scene.frames({}, nullptr)));
  EXPECT_EQ(bytes(), first) << "all of it was there";
  EXPECT_TRUE(same(with_cache(edits), scene.frames(edits, nullptr)));
  EXPECT_LT(bytes() - first, .7 * static_cast<double>(first)) << "region 1 was there";
  EXPECT_GT(bytes(), first) << "region 2 moves at other times";
}

TEST_F(Kept, APixelOutsideARegionsBoxMakesItsPicturesAnew) {
  TwoPendulums scene;
  scene.regions.resize(1);
  const auto with_cache = [&] {
    cache::ResultCache cache(folder_);
    scene.frames({}, &cache);
  };
  with_cache();
  const std::uintmax_t first = bytes();
  with_cache();
  EXPECT_EQ(bytes(), first) << "all of it was there";
  // Far right of the region and its margin: flow that leaves the box may read it, if none here does.
  for (cv::Mat& still : scene.stills) still.at<cv::Vec3b>(90, 310) = {255, 255, 255};
  with_cache();
  EXPECT_GT(bytes() - first, .5 * static_cast<double>(first)) << "pictures of other stills were taken";
}

}  // namespace
}  // namespace freshet::synth::stills
