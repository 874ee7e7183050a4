#include "media/picture/picture.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/media/generated_clip.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

cv::Mat noise(int type, double top = 256) {
  cv::Mat picture(17, 33, type);
  cv::RNG random(4);
  random.fill(picture, cv::RNG::UNIFORM, 0, top);
  return picture;
}

TEST(Picture, ComesBackAsWritten) {
  const Scratch scratch;
  const cv::Mat picture = noise(CV_8UC3);
  for (const char* name : {"a.png", "a.bmp", "a.tif"}) {
    write_picture(scratch / name, picture);
    const Picture back = read_picture(scratch / name);
    EXPECT_EQ(cv::norm(back.bgr, picture, cv::NORM_INF), 0) << name;
    EXPECT_TRUE(back.notices.empty()) << name;
  }
}

TEST(Picture, SixteenBitsAreReducedByRoundingAndSaid) {
  const Scratch scratch;
  const cv::Mat deep = noise(CV_16UC3, 65536);
  write_picture(scratch / "a.png", deep);
  const Picture back = read_picture(scratch / "a.png");
  ASSERT_EQ(back.bgr.type(), CV_8UC3);
  for (int y = 0; y < deep.rows; ++y)
    for (int x = 0; x < deep.cols; ++x)
      EXPECT_NEAR(back.bgr.at<cv::Vec3b>(y, x)[1], deep.at<cv::Vec3w>(y, x)[1] / 257.0, 0.501);
  ASSERT_EQ(back.notices.size(), 1u);
  EXPECT_EQ(back.notices[0], "16 bits per channel reduced to 8");
}

TEST(Picture, AlphaIsIgnoredAndSaidAndGreyIsSpread) {
  const Scratch scratch;
  const cv::Mat clear = noise(CV_8UC4), grey = noise(CV_8UC1);
  write_picture(scratch / "a.png", clear);
  const Picture back = read_picture(scratch / "a.png");
  EXPECT_EQ(back.bgr.at<cv::Vec3b>(3, 4)[2], clear.at<cv::Vec4b>(3, 4)[2]);
  ASSERT_EQ(back.notices.size(), 1u);
  EXPECT_EQ(back.notices[0], "alpha channel ignored");
  write_picture(scratch / "g.png", grey);
  const cv::Vec3b spread = read_picture(scratch / "g.png").bgr.at<cv::Vec3b>(5, 6);
  EXPECT_EQ(spread, cv::Vec3b::all(grey.at<std::uint8_t>(5, 6)));
}

TEST(Picture, IsTurnedUprightByItsExifTag) {
  const Scratch scratch;
  cv::Mat picture(16, 32, CV_8UC3, cv::Scalar::all(0));
  picture.colRange(0, 16).setTo(cv::Scalar::all(255));  // left half white
  write_picture(scratch / "a.jpg", picture);
  std::vector<char> bytes = bytes_of(scratch / "a.jpg");
  // An APP1 segment with one TIFF entry: orientation 6, shown turned by 90 degrees clockwise.
  const std::string exif(
      "\xFF\xE1\x00\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
      36);
  bytes.insert(bytes.begin() + 2, exif.begin(), exif.end());
  put_bytes(scratch / "turned.jpg", bytes);
  const cv::Mat turned = read_picture(scratch / "turned.jpg").bgr;
  ASSERT_EQ(turned.size(), cv::Size(16, 32));
  EXPECT_GT(turned.at<cv::Vec3b>(4, 8)[0], 240);  // white is above
  EXPECT_LT(turned.at<cv::Vec3b>(28, 8)[0], 15);
}

TEST(Picture, FaultsNameTheFile) {
  const Scratch scratch;
  const auto fault = [&](const char* name) {
    const std::string text = fault_of(ErrorKind::kInput, [&] { read_picture(scratch / name); });
    EXPECT_EQ(text.find((scratch / name).string() + ": "), 0u) << text;
    return text;
  };
  EXPECT_NE(fault("missing.png").find("no such file"), std::string::npos);
  put_bytes(scratch / "empty.png", {});
  EXPECT_NE(fault("empty.png").find("empty"), std::string::npos);
  put_bytes(scratch / "words.png", std::vector<char>(100, 'x'));
  EXPECT_NE(fault("words.png").find("not a picture"), std::string::npos);
  fs::create_directory(scratch / "folder.png");
  EXPECT_NE(fault("folder.png").find("not a regular file"), std::string::npos);
}

TEST(Picture, AHeaderThatClaimsGigabytesIsRefusedBeforeAllocation) {
  const Scratch scratch;
  write_picture(scratch / "a.png", noise(CV_8UC3));
  std::vector<char> bytes = bytes_of(scratch / "a.png");
  bytes[16] = bytes[20] = 0x01;  // 16 million pixels per side
  put_bytes(scratch / "huge.png", bytes);
  EXPECT_NE(fault_of(ErrorKind::kInput, [&] { read_picture(scratch / "huge.png"); }).find("pixels large"),
            std::string::npos);
  write_picture(scratch / "a.jpg", noise(CV_8UC3));
  bytes = bytes_of(scratch / "a.jpg");
  std::string text(bytes.begin(), bytes.end());
  const std::size_t frame = text.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  for (std::size_t i = 5; i < 9; ++i) bytes[frame + i] = static_cast<char>(0xFF);
  put_bytes(scratch / "huge.jpg", bytes);
  EXPECT_NE(fault_of(ErrorKind::kInput, [&] { read_picture(scratch / "huge.jpg"); }).find("65535 x 65535"),
            std::string::npos);
}

TEST(Matte, IsGreyOfThePicturesSize) {
  const Scratch scratch;
  const cv::Mat grey = noise(CV_8UC1), deep = noise(CV_16UC1, 65536), colour = noise(CV_8UC3);
  write_picture(scratch / "grey.png", grey);
  write_picture(scratch / "deep.png", deep);
  write_picture(scratch / "colour.png", colour);
  const Matte plain = read_matte(scratch / "grey.png", {33, 17});
  EXPECT_EQ(cv::norm(plain.alpha, grey, cv::NORM_INF), 0);
  EXPECT_TRUE(plain.notices.empty());
  EXPECT_NEAR(read_matte(scratch / "deep.png", {33, 17}).alpha.at<std::uint8_t>(2, 2),
              deep.at<std::uint16_t>(2, 2) / 257.0, 0.501);
  const Matte reduced = read_matte(scratch / "colour.png", {33, 17});
  EXPECT_EQ(reduced.alpha.type(), CV_8UC1);
  ASSERT_EQ(reduced.notices.size(), 1u);
  EXPECT_EQ(reduced.notices[0], "colour reduced to grey");
}

TEST(Matte, OfAnotherSizeOrAllBlackIsRefused) {
  const Scratch scratch;
  write_picture(scratch / "black.png", cv::Mat(17, 33, CV_8UC1, cv::Scalar(0)));
  EXPECT_NE(fault_of(ErrorKind::kInput,
                     [&] {
                       read_matte(scratch / "black.png", {33, 17});
                     })
                .find("black.png"),
            std::string::npos);
  EXPECT_NE(fault_of(ErrorKind::kInput,
                     [&] {
                       read_matte(scratch / "black.png", {40, 20});
                     })
                .find("the matte is 33 x 17, the picture 40 x 20"),
            std::string::npos);
}

TEST(Picture, WritingFaultsNameTheFile) {
  const Scratch scratch;
  const cv::Mat picture = noise(CV_8UC3);
  EXPECT_NE(fault_of(ErrorKind::kIo, [&] { write_picture(scratch / "no" / "a.png", picture); })
                .find("does not exist"),
            std::string::npos);
  EXPECT_NE(fault_of(ErrorKind::kUsage, [&] { write_picture(scratch / "a.xyz", picture); }).find("a.xyz"),
            std::string::npos);
  EXPECT_NE(fault_of(ErrorKind::kUsage, [&] { write_picture(scratch / "a.png", cv::Mat()); }).find("empty"),
            std::string::npos);
  // JPEG ends at 65535 pixels per side.
  fault_of(ErrorKind::kUsage, [&] { write_picture(scratch / "a.jpg", cv::Mat(1, 70000, CV_8UC3)); });
}

}  // namespace
}  // namespace freshet::media
