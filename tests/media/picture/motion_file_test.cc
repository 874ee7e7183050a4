#include "media/picture/motion_file.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <unistd.h>

#include <gtest/gtest.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#include "freshet/error.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

class MotionFile : public ::testing::Test {
 protected:
  static cv::Mat ramp(int width, int height) {
    cv::Mat motion(height, width, CV_32FC2);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x)
        motion.at<cv::Vec2f>(y, x) = {0.25f * static_cast<float>(x), -1.0f / static_cast<float>(y + 1)};
    }
    return motion;
  }
  std::string bytes_of(const fs::path& path) const {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  fs::path with_bytes(const std::string& bytes) const {
    const fs::path path = folder_ / "hostile.flo";
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  void expect_refused(const std::string& bytes) const { expect_refused(with_bytes(bytes)); }
  static void expect_refused(const fs::path& path) {
    const std::string fault = fault_of(ErrorKind::kInput, [&] { read_motion(path); });
    EXPECT_NE(fault.find("hostile."), std::string::npos);
  }
  ScratchFolder folder_;
};

TEST_F(MotionFile, ReadsBackWhatWasWritten) {
  const cv::Mat motion = ramp(37, 21);
  write_motion(folder_ / "a.flo", motion);
  const cv::Mat back = read_motion(folder_ / "a.flo");
  ASSERT_EQ(back.size(), motion.size());
  EXPECT_EQ(std::memcmp(back.data, motion.data, motion.total() * motion.elemSize()), 0);
}

TEST_F(MotionFile, IsTheMiddleburyFormat) {
  write_motion(folder_ / "a.flo", cv::Mat(1, 2, CV_32FC2, cv::Scalar(1.0, -2.0)));
  const std::string pair("\0\0\x80\x3f\0\0\0\xc0", 8);
  EXPECT_EQ(bytes_of(folder_ / "a.flo"), std::string("PIEH\2\0\0\0\1\0\0\0", 12) + pair + pair);
}

TEST_F(MotionFile, WritesAPartOfALargerField) {
  const cv::Mat part = ramp(40, 30)(cv::Rect(5, 6, 11, 7));
  write_motion(folder_ / "a.flo", part);
  EXPECT_EQ(read_motion(folder_ / "a.flo").at<cv::Vec2f>(3, 4), part.at<cv::Vec2f>(3, 4));
}

TEST_F(MotionFile, RefusesAFileOfAnyOtherLength) {
  write_motion(folder_ / "a.flo", ramp(3, 2));
  const std::string whole = bytes_of(folder_ / "a.flo");
  for (std::size_t length = 0; length < whole.size(); ++length) expect_refused(whole.substr(0, length));
  expect_refused(whole + "x");
}

TEST_F(MotionFile, RefusesHostileHeaders) {
  const std::string rest(8, '\0');
  expect_refused(std::string("PIEX\1\0\0\0\1\0\0\0", 12) + rest);
  expect_refused(std::string("PIEH\0\0\0\0\1\0\0\0", 12) + rest);
  expect_refused(std::string("PIEH\xff\xff\xff\xff\1\0\0\0", 12) + rest);
  expect_refused(std::string("PIEH\xff\xff\xff\x7f\xff\xff\xff\x7f", 12) + rest);
  expect_refused(std::string("PIEH\0\x80\0\0\0\x80\0\0", 12) + rest);  // 8 GB claimed, 8 bytes there
}

// A file of float channels, as a renderer writes it; channel number i has the value 10 i + x everywhere.
void write_channels(const fs::path& path, const std::vector<std::string>& names,
                    Imf::PixelType type = Imf::FLOAT) {
  constexpr int kWidth = 5, kHeight = 3;
  Imf::Header header(kWidth, kHeight);
  Imf::FrameBuffer buffer;
  std::vector<std::vector<float>> values(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    values[i].resize(kWidth * kHeight);
    for (std::size_t k = 0; k < values[i].size(); ++k)
      values[i][k] = 10 * static_cast<float>(i) + static_cast<float>(k % kWidth);
    header.channels().insert(names[i], Imf::Channel(type));
    buffer.insert(names[i], Imf::Slice(type, reinterpret_cast<char*>(values[i].data()), sizeof(float),
                                       sizeof(float) * kWidth));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(kHeight);
}

TEST_F(MotionFile, ExrHoldsHalves) {
  const cv::Mat motion = ramp(37, 21);
  write_motion(folder_ / "a.exr", motion);
  const cv::Mat back = read_motion(folder_ / "a.exr");
  ASSERT_EQ(back.size(), motion.size());
  for (int y = 0; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x) {
      const cv::Vec2f &wrote = motion.at<cv::Vec2f>(y, x), &read = back.at<cv::Vec2f>(y, x);
      EXPECT_EQ(read[0], wrote[0]);  // quarters, exact in a half
      EXPECT_NEAR(read[1], wrote[1], std::abs(wrote[1]) / 2048);
    }
}

TEST_F(MotionFile, ExrIsWhatCompositorsRead) {
  write_motion(folder_ / "a.exr", cv::Mat(4, 6, CV_32FC2, cv::Scalar(1.5, 2.5)));
  Imf::InputFile file((folder_ / "a.exr").c_str());
  const Imf::ChannelList& channels = file.header().channels();
  ASSERT_NE(channels.findChannel("forward.u"), nullptr);
  EXPECT_EQ(channels["forward.u"].type, Imf::HALF);
  std::vector<float> down(24);
  Imf::FrameBuffer buffer;
  buffer.insert("forward.v", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(down.data()), 4, 24));
  file.setFrameBuffer(buffer);
  file.readPixels(0, 3);
  for (const float v : down) EXPECT_EQ(v, -2.5f);  // y up
}

TEST_F(MotionFile, ExrChannelsAreFoundByTheirNames) {
  const auto first_pixel = [&](const std::vector<std::string>& names) {
    write_channels(folder_ / "a.exr", names);
    return read_motion(folder_ / "a.exr").at<cv::Vec2f>(0, 0);
  };
  EXPECT_EQ(first_pixel({"u", "v"}), cv::Vec2f(0, -10));
  EXPECT_EQ(first_pixel({"G", "R"}), cv::Vec2f(10, 0));
  EXPECT_EQ(first_pixel({"motion.X", "motion.Y", "motion.Z"}), cv::Vec2f(0, -10));
  EXPECT_EQ(first_pixel({"backward.u", "backward.v", "forward.u", "forward.v"}), cv::Vec2f(20, -30));
  EXPECT_EQ(first_pixel({"R", "G", "B", "velocity.x", "velocity.y"}), cv::Vec2f(30, -40));
}

TEST_F(MotionFile, RefusesAnExrWithoutMotion) {
  for (const std::vector<std::string>& names :
       std::vector<std::vector<std::string>>{{"R", "G", "B"}, {"u"}, {"Y"}, {"a.u", "b.v"}}) {
    write_channels(folder_ / "hostile.exr", names);
    expect_refused(folder_ / "hostile.exr");
  }
  write_channels(folder_ / "hostile.exr", {"u", "v"}, Imf::UINT);
  expect_refused(folder_ / "hostile.exr");
}

TEST_F(MotionFile, RefusesADamagedExr) {
  write_motion(folder_ / "a.exr", ramp(19, 11));
  const std::string whole = bytes_of(folder_ / "a.exr");
  for (std::size_t length = 1; length < whole.size(); ++length) {
    std::ofstream(folder_ / "hostile.exr", std::ios::binary) << whole.substr(0, length);
    expect_refused(folder_ / "hostile.exr");
  }
  // Flipped bytes give an error or some field of some size, never a crash.
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(~bytes[at]);
    std::ofstream(folder_ / "hostile.exr", std::ios::binary) << bytes;
    try {
      EXPECT_EQ(read_motion(folder_ / "hostile.exr").type(), CV_32FC2);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
    }
  }
}

TEST_F(MotionFile, NamesAMissingFileAndAMissingFolder) {
  EXPECT_THROW(read_motion(folder_ / "absent.flo"), Error);
  fault_of(ErrorKind::kIo, [&] { write_motion(folder_ / "absent" / "a.flo", ramp(2, 2)); });
  EXPECT_THROW(write_motion(folder_ / "a.flo", cv::Mat(2, 2, CV_32F)), Error);
  EXPECT_THROW(write_motion(folder_ / "a.png", ramp(2, 2)), Error);
  EXPECT_FALSE(fs::exists(folder_ / "a.flo"));
}

}  // namespace
}  // namespace freshet::media
