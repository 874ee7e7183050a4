#include "synth/stills/still_set.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include <unistd.h>
#include <opencv2/imgcodecs.hpp>

#include "freshet/error.h"
#include "synth/stills/region_file.h"
#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

namespace fs = std::filesystem;

class StillFolder : public testing::Test {
 protected:
  StillFolder() : folder_(fs::temp_directory_path() / ("stills_test_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~StillFolder() override { fs::remove_all(folder_); }
  void write(const std::string& name, const cv::Mat& picture) const {
    cv::imwrite((folder_ / name).string(), picture);
  }
  void write_pendulum() const {
    const std::vector<cv::Mat> stills = made_pendulum({0, .5, 1});
    for (int i = 0; i < 3; ++i) write(std::string(1, static_cast<char>('a' + i)) + ".png", stills[i]);
  }
  std::string refusal() const {
    try {
      read_stills(folder_);
    } catch (const Error& fault) {
      EXPECT_EQ(fault.kind(), ErrorKind::kInput);
      return fault.what();
    }
    return "nothing was refused";
  }
  fs::path folder_;
};

TEST_F(StillFolder, AVideoAmongThemIsPassedOverAndTold) {
  write_pendulum();
  std::ofstream(folder_ / "clip.mp4") << "no picture";
  const StillSet set = read_stills(folder_);
  EXPECT_EQ(set.count(), 3);
  ASSERT_EQ(set.notices.size(), 1u);
  EXPECT_NE(set.notices[0].find("clip.mp4"), std::string::npos);
}

TEST_F(StillFolder, ADamagedStillIsLeftOutAndTold) {
  write_pendulum();
  write("d.jpg", made_pendulum({.7})[0]);
  fs::resize_file(folder_ / "d.jpg", fs::file_size(folder_ / "d.jpg") / 2);
  const StillSet set = read_stills(folder_);
  EXPECT_EQ(set.names, (std::vector<std::string>{"a.png", "b.png", "c.png"}));
  ASSERT_EQ(set.notices.size(), 1u);
  EXPECT_NE(set.notices[0].find("d.jpg"), std::string::npos);
}

TEST_F(StillFolder, OneStillTwoEqualOnesAndNoneAreRefused) {
  EXPECT_NE(refusal().find("no "), std::string::npos) << refusal();
  const cv::Mat still = made_pendulum({.5})[0];
  write("a.png", still);
  EXPECT_NE(refusal().find("one still"), std::string::npos) << refusal();
  write("b.png", still);
  EXPECT_NE(refusal().find("one and the same"), std::string::npos) << refusal();
}

TEST_F(StillFolder, UnlikeSizesAreNamed) {
  write_pendulum();
  write("wide.png", made_pendulum({.5}, {200, 96})[0]);
  const std::string said = refusal();
  EXPECT_NE(said.find("wide.png"), std::string::npos) << said;
  EXPECT_NE(said.find("200 x 96"), std::string::npos) << said;
}

TEST_F(StillFolder, SixteenBitsAreKept) {
  write_pendulum();
  cv::Mat deep;
  made_pendulum({.3})[0].convertTo(deep, CV_16U, 256);
  write("deep.tif", deep);
  const StillSet set = read_stills(folder_);
  ASSERT_EQ(set.count(), 4);
  for (const cv::Mat& each : set.pictures) EXPECT_EQ(each.type(), CV_16UC3);
  EXPECT_EQ(cv::norm(set.pictures[3], deep, cv::NORM_INF), 0);
}

TEST_F(StillFolder, MasksSayWhatMovesBySelf) {
  cv::Mat masks(96, 160, CV_8UC3, cv::Scalar::all(0));
  masks(cv::Rect(0, 0, 30, 30)).setTo(cv::Scalar::all(255));
  masks(cv::Rect(60, 0, 30, 30)).setTo(cv::Scalar::all(255));
  masks(cv::Rect(0, 50, 30, 30)).setTo(cv::Scalar(0, 0, 255));
  masks(cv::Rect(60, 50, 30, 30)).setTo(cv::Scalar(0, 0, 255));
  masks(cv::Rect(110, 0, 40, 90)).setTo(cv::Scalar::all(128));
  write("masks.png", masks);
  std::vector<std::string> notices;
  const std::vector<Region> regions = read_regions(folder_ / "masks.png", {160, 96}, {160, 96}, notices);
  ASSERT_EQ(regions.size(), 4u) << "two white areas, one red region of two areas, one slow";
  int slow = 0, red = 0;
  for (const Region& region : regions) {
    slow += region.kind == RegionKind::kSlow;
    red += region.mask.at<std::uint8_t>(60, 10) != 0 && region.mask.at<std::uint8_t>(60, 70) != 0;
  }
  EXPECT_EQ(slow, 1);
  EXPECT_EQ(red, 1);
}

TEST_F(StillFolder, AnOutlineInAnSvgIsARegion) {
  std::ofstream(folder_ / "r.svg") << R"(<svg xmlns="http://www.w3.org/2000/svg" width="320" height="192">
    <path id="flame" d="M 20 20 H 120 V 100 H 20 Z"/><path id="slow-water" d="M 200 20 H 300 V 100 H 200 Z"/></svg>)";
  std::vector<std::string> notices;
  const std::vector<Region> regions = read_regions(folder_ / "r.svg", {320, 192}, {160, 96}, notices);
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[0].name, "flame");
  EXPECT_EQ(regions[0].kind, RegionKind::kIndependent);
  EXPECT_EQ(regions[1].kind, RegionKind::kSlow);
  EXPECT_NEAR(cv::countNonZero(regions[0].mask), 50 * 40, 200);
  EXPECT_NE(regions[0].mask.at<std::uint8_t>(30, 30), 0);
}

}  // namespace
}  // namespace freshet::synth::stills
