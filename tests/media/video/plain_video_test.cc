#include "media/video/plain_video.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "freshet/error.h"
#include "media/frame/frame.h"
#include "media/video/video_reader.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

const fs::path kFile = fs::temp_directory_path() / ("freshet-plain-" + std::to_string(::getpid()) + ".y4m");

TEST(PlainVideo, HasBytesThatDependOnTheFramesAlone) {
  PlainVideo video(kFile, {2, 2}, 25);
  video.write(cv::Mat(2, 2, CV_8UC3, cv::Scalar(0, 0, 0)));
  video.write(cv::Mat(2, 2, CV_8UC3, cv::Scalar(255, 255, 255)));
  video.write(cv::Mat(2, 2, CV_8UC3, cv::Scalar(0, 0, 255)));
  video.finish();
  std::ifstream file(kFile, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}),
            "YUV4MPEG2 W2 H2 F25000:1000 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\n"
            "FRAME\n\x10\x10\x10\x10\x80\x80"
            "FRAME\n\xeb\xeb\xeb\xeb\x80\x80"
            "FRAME\n\x51\x51\x51\x51\x5a\xf0");
  fs::remove(kFile);
}

TEST(PlainVideo, IsReadBackInItsColoursAndAtItsRate) {
  const cv::Mat frame(48, 64, CV_8UC3, cv::Scalar(40, 120, 200));
  PlainVideo video(kFile, frame.size(), 29.97);
  for (int i = 0; i < 3; ++i) video.write(frame);
  video.finish();
  VideoReader reader(kFile);
  EXPECT_NEAR(static_cast<double>(reader.info().fps_num) / static_cast<double>(reader.info().fps_den), 29.97,
              1e-6);
  int frames = 0;
  while (const auto read = reader.next()) {
    EXPECT_LE(cv::norm(to_bgr(*read), frame, cv::NORM_INF), 4.0);
    ++frames;
  }
  EXPECT_EQ(frames, 3);
  EXPECT_EQ(reader.complaint(), "");
  fs::remove(kFile);
}

TEST(PlainVideo, NamesAFileThatCannotBeWritten) {
  try {
    PlainVideo video("/nowhere/at/all.y4m", {2, 2}, 25);
    FAIL();
  } catch (const Error& fault) {
    EXPECT_EQ(fault.kind(), ErrorKind::kIo);
    EXPECT_NE(std::string(fault.what()).find("/nowhere/at/all.y4m"), std::string::npos);
  }
}

}  // namespace
}  // namespace freshet::media
