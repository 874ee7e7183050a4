// Transparency in and out of files, seen by the ffmpeg program as well as by our own reader.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "media/frame/bgra.h"
#include "media/video/video_reader.h"
#include "media/video/video_writer.h"
#include "tests/harness/scratch_folder.h"
#include "tests/media/generated_clip.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 45, kHeight = 31, kFrames = 3;

// Colours and alpha that vary slowly, as a fluid's do; nothing is the same in two channels.
cv::Mat soft(int frame, int depth) {
  cv::Mat picture(kHeight, kWidth, CV_MAKETYPE(depth, 4));
  const double top = depth == CV_8U ? 255 : 65535;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double u = static_cast<double>(x) / kWidth, v = static_cast<double>(y) / kHeight;
      const double values[4] = {0.2 + 0.6 * u, 0.8 - 0.5 * v, 0.3 + 0.1 * frame + 0.4 * u * v,
                                std::min(1.0, 1.4 * u * (1 - 0.2 * v))};
      for (int c = 0; c < 4; ++c) {
        const int value = static_cast<int>(std::lround(top * values[c]));
        if (depth == CV_8U)
          picture.at<cv::Vec4b>(y, x)[c] = static_cast<std::uint8_t>(value);
        else
          picture.at<cv::Vec4w>(y, x)[c] = static_cast<std::uint16_t>(value);
      }
    }
  return picture;
}

void write_soft(const fs::path& path, int depth) {
  VideoWriter writer(path, {kWidth, kHeight});
  for (int i = 0; i < kFrames; ++i) writer.write(soft(i, depth));
  writer.finish();
}

// The file's frames as the ffmpeg program decodes them.
std::vector<cv::Mat> by_ffmpeg(const ScratchFolder& scratch, const fs::path& path, int depth) {
  // Not bgra64le: to that swscale has no exact way from PNG's own order.
  const std::string format = depth == CV_8U ? "rgba" : "rgba64le";
  make_clip(
      "-i '" + path.string() + "' -sws_flags accurate_rnd+full_chroma_int -f rawvideo -pix_fmt " + format,
      scratch / "raw");
  const std::vector<char> bytes = bytes_of(scratch / "raw");
  const std::size_t each = std::size_t{kWidth} * kHeight * (depth == CV_8U ? 4 : 8);
  std::vector<cv::Mat> frames;
  for (std::size_t at = 0; at + each <= bytes.size(); at += each) {
    frames.emplace_back(kHeight, kWidth, CV_MAKETYPE(depth, 4));
    std::memcpy(frames.back().data, bytes.data() + at, each);
    cv::cvtColor(frames.back(), frames.back(), cv::COLOR_RGBA2BGRA);
  }
  return frames;
}

double worst(const cv::Mat& a, const cv::Mat& b, int first_channel, int count) {
  double maximum = 0;
  std::vector<cv::Mat> of_a, of_b;
  cv::split(a, of_a);
  cv::split(b, of_b);
  for (int c = first_channel; c < first_channel + count; ++c)
    maximum = std::max(maximum, cv::norm(of_a[static_cast<std::size_t>(c)], of_b[static_cast<std::size_t>(c)],
                                         cv::NORM_INF));
  return maximum;
}

TEST(Alpha, MatroskaAndPngAreExactForFfmpeg) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: nothing to compare with";
  for (const int depth : {CV_8U, CV_16U})
    for (const char* name : {"a.mkv", "f%03d.png", "g####.png"}) {
      const ScratchFolder scratch;
      write_soft(scratch / name, depth);
      const fs::path read = name[0] == 'g' ? scratch / "g%04d.png" : scratch / name;
      const std::vector<cv::Mat> frames = by_ffmpeg(scratch, read, depth);
      ASSERT_EQ(frames.size(), std::size_t{kFrames}) << name;
      for (int i = 0; i < kFrames; ++i)
        EXPECT_EQ(worst(frames[static_cast<std::size_t>(i)], soft(i, depth), 0, 4), 0) << name << depth;
    }
}

TEST(Alpha, ProResKeepsAlphaAndColourWithinItsLoss) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: nothing to compare with";
  for (const int depth : {CV_8U, CV_16U}) {
    const ScratchFolder scratch;
    write_soft(scratch / "a.mov", depth);
    const VideoInfo info = VideoReader(scratch / "a.mov").info();
    EXPECT_EQ(info.codec, "prores");
    EXPECT_TRUE(has_alpha(info.layout)) << info.layout.format;
    EXPECT_EQ(info.layout.matrix, 1);
    const std::vector<cv::Mat> frames = by_ffmpeg(scratch, scratch / "a.mov", depth);
    ASSERT_EQ(frames.size(), std::size_t{kFrames});
    const double unit = depth == CV_8U ? 1 : 257;
    for (int i = 0; i < kFrames; ++i) {
      // Alpha is coded without loss, in ten bits.
      EXPECT_LE(worst(frames[static_cast<std::size_t>(i)], soft(i, depth), 3, 1), unit);
      EXPECT_LE(worst(frames[static_cast<std::size_t>(i)], soft(i, depth), 0, 3), 6 * unit);
    }
  }
}

TEST(Alpha, IsReadAsItWasWritten) {
  const ScratchFolder scratch;
  for (const char* name : {"a.mkv", "a.apng", "f%03d.png", "a.mov"}) {
    write_soft(scratch / name, CV_8U);
    VideoReader reader(scratch / name);
    const double loss = std::string(name) == "a.mov" ? 6 : 0;
    int i = 0;
    for (; const auto frame = reader.next(); ++i) {
      const cv::Mat bgra = to_bgra(*frame);
      EXPECT_LE(worst(bgra, soft(i, CV_8U), 0, 3), loss) << name;
      EXPECT_LE(worst(bgra, soft(i, CV_8U), 3, 1), loss > 0 ? 1 : 0) << name;
    }
    EXPECT_EQ(i, kFrames);
  }
}

TEST(Alpha, IsFullWhereALayoutHasNone) {
  for (const char* format : {"yuv420p", "gray", "rgb24", "gbrp"}) {
    PixelLayout layout;
    layout.format = format;
    layout.width = layout.height = 8;
    const Frame frame = make_frame(layout);
    EXPECT_FALSE(has_alpha(layout));
    const cv::Mat bgra = to_bgra(frame);
    EXPECT_EQ(cv::countNonZero(bgra.reshape(1, 64).col(3) != 255), 0) << format;
  }
}

TEST(Alpha, SixteenBitsAreRefusedWhereTheyWouldBeLost) {
  const ScratchFolder scratch;
  for (const char* name : {"a.mp4", "a.webp", "a.apng"}) {
    VideoWriter writer(scratch / name, {kWidth, kHeight});
    const std::string fault =
        fault_of(ErrorKind::kUsage, [&] { writer.write(cv::Mat(kHeight, kWidth, CV_16UC3, cv::Scalar(0))); });
    EXPECT_NE(fault.find("8 bits per channel"), std::string::npos) << fault;
  }
}

}  // namespace
}  // namespace freshet::media
