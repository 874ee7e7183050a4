#include "media/frame/repair.h"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "media/frame/frame_md5.h"
#include "media/video/video_reader.h"
#include "tests/harness/scratch_folder.h"
#include "tests/media/generated_clip.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> repaired_hashes(const fs::path& file, const Repairs& repairs) {
  std::vector<std::string> hashes;
  VideoReader reader(file, 0, repairs);
  while (const auto frame = reader.next()) hashes.push_back(frame_md5(*frame));
  return hashes;
}

constexpr const char* kCoarse =
    "-f lavfi -i testsrc2=s=160x96:r=25:d=0.6 -sws_flags bitexact -c:v mpeg4 -q:v 25 -pix_fmt yuv420p";

TEST(Repair, GivesTheFramesOfTheSameFiltersInFfmpeg) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: nothing to compare with";
  const ScratchFolder scratch;
  make_clip(kCoarse, scratch / "coarse.avi");
  make_clip("-f lavfi -i testsrc2=s=160x96:r=50:d=0.6 -vf interlace -c:v ffv1 -pix_fmt yuv420p",
            scratch / "fields.mkv");
  for (const Repairs repairs : {Repairs{.deblock = true}, Repairs{.deinterlace = true},
                                Repairs{.deinterlace = true, .deblock = true}})
    for (const char* name : {"coarse.avi", "fields.mkv"}) {
      const auto theirs = ffmpeg_hashes(scratch / name, "-flags bitexact", "-vf " + filter_text(repairs));
      ASSERT_EQ(theirs.size(), 15u);
      EXPECT_EQ(repaired_hashes(scratch / name, repairs), theirs) << name << " " << filter_text(repairs);
      EXPECT_NE(theirs, our_hashes(scratch / name)) << "nothing was repaired";
    }
}

// Mean step of luma across the borders of 8 x 8 blocks over that elsewhere; 1: blocks cannot be seen.
double blockiness(const fs::path& file, const Repairs& repairs) {
  VideoReader reader(file, 0, repairs);
  double at_border = 0, elsewhere = 0;
  int borders = 0, others = 0;
  while (const auto frame = reader.next()) {
    const cv::Mat luma = to_luma(*frame);
    for (int y = 0; y < luma.rows; ++y)
      for (int x = 1; x < luma.cols; ++x) {
        const double step = std::abs(luma.at<std::uint8_t>(y, x) - luma.at<std::uint8_t>(y, x - 1));
        (x % 8 == 0 ? at_border : elsewhere) += step;
        ++(x % 8 == 0 ? borders : others);
      }
  }
  return at_border / borders / (elsewhere / others);
}

TEST(Repair, BlocksAreSeenLess) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: nothing to make a clip with";
  const ScratchFolder scratch;
  make_clip(
      "-f lavfi -i nullsrc=s=160x96:r=25:d=0.4,geq=lum='128+60*sin((X+4*N)/17)*cos(Y/13)':cb=128:cr=128 "
      "-c:v mpeg4 -q:v 31 -pix_fmt yuv420p",
      scratch / "soft.avi");
  EXPECT_GT(blockiness(scratch / "soft.avi", {}), 1.5);
  EXPECT_LT(blockiness(scratch / "soft.avi", {.deinterlace = false, .deblock = true}), 1.3);
}

TEST(Repair, KeepsTimesAndNumbersOfFrames) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: nothing to make a clip with";
  const ScratchFolder scratch;
  make_clip(kCoarse, scratch / "coarse.avi");
  VideoReader plain(scratch / "coarse.avi"), repaired(scratch / "coarse.avi", 0, {true, true});
  for (;;) {
    const auto a = plain.next(), b = repaired.next();
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) break;
    EXPECT_NEAR(a->time_s, b->time_s, 1e-9);
  }
  EXPECT_TRUE(repaired.complaint().empty());
}

/// Mean of each tenth of a frame, 8-bit luma: those of a ramp of light.
std::vector<double> tenths(const fs::path& file, const Repairs& repairs, VideoInfo& info) {
  VideoReader reader(file, 0, repairs);
  info = reader.info();
  const auto frame = reader.next();
  if (!frame) return {};
  const cv::Mat luma = to_luma(*frame);
  std::vector<double> means;
  for (int i = 0; i < 10; ++i)
    means.push_back(cv::mean(luma.colRange(i * luma.cols / 10 + 4, (i + 1) * luma.cols / 10 - 4))[0]);
  return means;
}

TEST(Repair, HdrBecomesSdrAndSdrIsLeftAlone) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: nothing to make a clip with";
  const ScratchFolder scratch;
  const std::string ramp =
      "-f lavfi -i nullsrc=s=320x96:r=25:d=0.2,format=yuv420p10le,geq=lum='64+87*floor(X/32)':cb=512:cr=512 "
      "-vf setparams=color_trc=bt709:color_primaries=bt709:colorspace=bt709:range=tv";
  make_clip(ramp + " -c:v ffv1", scratch / "sdr.mkv");
  VideoInfo info;
  const std::vector<double> sdr = tenths(scratch / "sdr.mkv", {}, info);
  ASSERT_EQ(sdr.size(), 10u);
  EXPECT_EQ(tenths(scratch / "sdr.mkv", {.sdr = true}, info), sdr);
  EXPECT_EQ(info.repairs, "");
  for (const char* transfer : {"smpte2084", "arib-std-b67"}) {
    SCOPED_TRACE(transfer);
    const fs::path file = scratch / (std::string(transfer) + ".mkv");
    make_clip(ramp + ",zscale=npl=203:transfer=" + transfer + ":primaries=2020:matrix=2020_ncl -c:v ffv1",
              file);
    const std::vector<double> untouched = tenths(file, {}, info);
    EXPECT_EQ(info.layout.transfer, transfer[0] == 's' ? 16 : 18);
    const std::vector<double> back = tenths(file, {.sdr = true}, info);
    EXPECT_EQ(info.layout.transfer, 1);
    EXPECT_EQ(info.layout.primaries, 1);
    EXPECT_NE(info.repairs, "");
    for (int i = 0; i < 10; ++i) {
      // Up to .3 of white's light nothing is compressed; above, brighter stays brighter.
      EXPECT_LT(back[i], sdr[i] + 3) << i;
      EXPECT_GT(back[i], i <= 4 ? sdr[i] - 3 : back[i - 1] + 4) << i;
    }
    EXPECT_GT(back[9], 170);
    EXPECT_NE(untouched, back);
  }
}

TEST(Repair, WhatCannotBeRepairedIsNamed) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: nothing to make a clip with";
  const ScratchFolder scratch;
  make_clip("-f lavfi -i testsrc=s=64x64:r=25:d=0.2 -c:v rawvideo -pix_fmt bgr24", scratch / "a.avi");
  const std::string fault = fault_of(
      ErrorKind::kInput, [&] { VideoReader(scratch / "a.avi", 0, {.deinterlace = true, .deblock = true}); });
  EXPECT_NE(fault.find("a.avi"), std::string::npos) << fault;
  EXPECT_NE(fault.find("bgr24"), std::string::npos) << fault;
  make_clip("-f lavfi -i testsrc=s=64x64:r=25:d=0.2", scratch / "%02d.png");
  EXPECT_NE(fault_of(ErrorKind::kInput,
                     [&] { VideoReader(scratch / "%02d.png", 0, {.deinterlace = false, .deblock = true}); })
                .find("sequence"),
            std::string::npos);
}

}  // namespace
}  // namespace freshet::media
