#include "synth/stills/still_set.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include <unistd.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/picture/capture_time.h"
#include "synth/stills/region_file.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"
#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

namespace fs = std::filesystem;

class StillFolder : public testing::Test {
 protected:
  void write(const std::string& name, const cv::Mat& picture) const {
    cv::imwrite((folder_ / name).string(), picture);
  }
  void write_pendulum() const {
    const std::vector<cv::Mat> stills = made_pendulum({0, .5, 1});
    for (int i = 0; i < 3; ++i) write(std::string(1, static_cast<char>('a' + i)) + ".png", stills[i]);
  }
  std::string refusal() const {
    return fault_of(ErrorKind::kInput, [&] { read_stills(folder_.path()); });
  }
  ScratchFolder folder_;
};

TEST_F(StillFolder, AVideoAmongThemIsPassedOverAndTold) {
  write_pendulum();
  std::ofstream(folder_ / "clip.mp4") << "no picture";
  const StillSet set = read_stills(folder_.path());
  EXPECT_EQ(set.count(), 3);
  ASSERT_EQ(set.notices.size(), 1u);
  EXPECT_NE(set.notices[0].find("clip.mp4"), std::string::npos);
}

TEST_F(StillFolder, ADamagedStillIsLeftOutAndTold) {
  write_pendulum();
  write("d.jpg", made_pendulum({.7})[0]);
  fs::resize_file(folder_ / "d.jpg", fs::file_size(folder_ / "d.jpg") / 2);
  const StillSet set = read_stills(folder_.path());
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
  const StillSet set = read_stills(folder_.path());
  ASSERT_EQ(set.count(), 4);
  for (const cv::Mat& each : set.pictures) EXPECT_EQ(each.type(), CV_16UC3);
  EXPECT_EQ(cv::norm(set.pictures[3], deep, cv::NORM_INF), 0);
}

// As a camera writes it: an APP1 segment after the JPEG's first two bytes, here little endian.
std::vector<std::uint8_t> with_exif(const std::vector<std::uint8_t>& jpeg, int orientation,
                                    const std::string& date) {
  std::string tiff("II*\0\x08\0\0\0\x02\0", 10);
  const auto entry = [&](int tag, int type, int count, int value) {
    for (const auto& [number, bytes] : {std::pair(tag, 2), {type, 2}, {count, 4}, {value, 4}})
      for (int i = 0; i < bytes; ++i) tiff += static_cast<char>(number >> 8 * i);
  };
  entry(0x0112, 3, 1, orientation);
  entry(0x8769, 4, 1, 38);
  tiff += std::string(4, '\0') + std::string("\x01\0", 2);
  entry(0x9003, 2, 20, 56);
  tiff += std::string(4, '\0') + date + '\0';
  const std::size_t length = tiff.size() + 8;
  std::string segment("\xFF\xE1");
  segment += static_cast<char>(length >> 8);
  segment += static_cast<char>(length & 255);
  segment += std::string("Exif\0\0", 6) + tiff;
  std::vector<std::uint8_t> out = jpeg;
  out.insert(out.begin() + 2, segment.begin(), segment.end());
  return out;
}

TEST_F(StillFolder, ExifTurnsAStillAndItsTimeIsToldButOrdersNothing) {
  const char* dates[] = {"2026:05:01 12:00:40", "2026:05:01 12:00:00", "2026:05:01 12:01:10"};
  const std::vector<cv::Mat> stills = made_pendulum({0, .5, 1});
  for (int i = 0; i < 3; ++i) {
    cv::Mat lying;  // orientation 6: turn it clockwise to see it upright
    cv::rotate(stills[i], lying, cv::ROTATE_90_COUNTERCLOCKWISE);
    std::vector<std::uint8_t> jpeg;
    cv::imencode(".jpg", lying, jpeg, {cv::IMWRITE_JPEG_QUALITY, 98});
    const std::vector<std::uint8_t> bytes = with_exif(jpeg, 6, dates[i]);
    std::ofstream(folder_ / (std::string(1, static_cast<char>('a' + i)) + ".jpg"), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  const StillSet set = read_stills(folder_.path());
  EXPECT_EQ(set.names, (std::vector<std::string>{"a.jpg", "b.jpg", "c.jpg"}));
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(set.pictures[i].size(), stills[i].size());
    EXPECT_LT(cv::norm(set.pictures[i], stills[i], cv::NORM_L1) / (3.0 * stills[i].total()), 4);
  }
  ASSERT_EQ(set.notices.size(), 1u);
  EXPECT_NE(set.notices[0].find("within 70 s, from 2026-05-01 12:00:00 to 12:01:10"), std::string::npos)
      << set.notices[0];
}

TEST_F(StillFolder, BrokenExifIsNoReasonToRefuse) {
  write_pendulum();
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", made_pendulum({.7})[0], jpeg);
  const std::vector<std::uint8_t> whole = with_exif(jpeg, 1, "2026:05:01 12:00:40");
  for (std::size_t at = 4; at < 100; ++at) {
    std::vector<std::uint8_t> bytes = whole;
    bytes[at] = 0xFE;
    std::ofstream(folder_ / "exif.jpg", std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    EXPECT_NO_THROW(media::capture_time(folder_ / "exif.jpg")) << at;
  }
  EXPECT_FALSE(media::capture_time(folder_ / "a.png"));
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
