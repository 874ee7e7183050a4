#include "media/motion_file.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

#include <unistd.h>

#include <gtest/gtest.h>

#include "freshet_error.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

class MotionFile : public ::testing::Test {
 protected:
  MotionFile() : folder_(fs::temp_directory_path() / ("freshet_motion_file_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~MotionFile() override { fs::remove_all(folder_); }

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
  void expect_refused(const std::string& bytes) const {
    try {
      read_flo(with_bytes(bytes));
      ADD_FAILURE() << "accepted " << bytes.size() << " bytes";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      EXPECT_NE(std::string(error.what()).find("hostile.flo"), std::string::npos);
    }
  }
  fs::path folder_;
};

TEST_F(MotionFile, ReadsBackWhatWasWritten) {
  const cv::Mat motion = ramp(37, 21);
  write_flo(folder_ / "a.flo", motion);
  const cv::Mat back = read_flo(folder_ / "a.flo");
  ASSERT_EQ(back.size(), motion.size());
  EXPECT_EQ(std::memcmp(back.data, motion.data, motion.total() * motion.elemSize()), 0);
}

TEST_F(MotionFile, IsTheMiddleburyFormat) {
  write_flo(folder_ / "a.flo", cv::Mat(1, 2, CV_32FC2, cv::Scalar(1.0, -2.0)));
  const std::string pair("\0\0\x80\x3f\0\0\0\xc0", 8);
  EXPECT_EQ(bytes_of(folder_ / "a.flo"), std::string("PIEH\2\0\0\0\1\0\0\0", 12) + pair + pair);
}

TEST_F(MotionFile, WritesAPartOfALargerField) {
  const cv::Mat part = ramp(40, 30)(cv::Rect(5, 6, 11, 7));
  write_flo(folder_ / "a.flo", part);
  EXPECT_EQ(read_flo(folder_ / "a.flo").at<cv::Vec2f>(3, 4), part.at<cv::Vec2f>(3, 4));
}

TEST_F(MotionFile, RefusesAFileOfAnyOtherLength) {
  write_flo(folder_ / "a.flo", ramp(3, 2));
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

TEST_F(MotionFile, NamesAMissingFileAndAMissingFolder) {
  EXPECT_THROW(read_flo(folder_ / "absent.flo"), Error);
  try {
    write_flo(folder_ / "absent" / "a.flo", ramp(2, 2));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
  }
  EXPECT_THROW(write_flo(folder_ / "a.flo", cv::Mat(2, 2, CV_32F)), Error);
  EXPECT_FALSE(fs::exists(folder_ / "a.flo"));
}

}  // namespace
}  // namespace freshet::media
