#include "media/picture/picture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <lcms2.h>

#include <opencv2/imgcodecs.hpp>

#include "media/picture/exr_picture.h"
#include "tests/harness/scratch_folder.h"
#include "tests/media/exr_channel.h"
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
  const ScratchFolder scratch;
  const cv::Mat picture = noise(CV_8UC3);
  for (const char* name : {"a.png", "a.bmp", "a.tif"}) {
    write_picture(scratch / name, picture);
    const Picture back = read_picture(scratch / name);
    EXPECT_EQ(cv::norm(back.bgr, picture, cv::NORM_INF), 0) << name;
    EXPECT_TRUE(back.notices.empty()) << name;
  }
}

TEST(Picture, SixteenBitsAreReducedByRoundingAndSaid) {
  const ScratchFolder scratch;
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
  const ScratchFolder scratch;
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
  const ScratchFolder scratch;
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
  const ScratchFolder scratch;
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
  const ScratchFolder scratch;
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

/// A matte of the picture's size: `nothing` to the left, a ramp, and white.
cv::Mat ramp(int type, int nothing = 0) {
  const int most = CV_MAT_DEPTH(type) == CV_16U ? 65535 : 255;
  cv::Mat matte(17, 33, type, cv::Scalar::all(nothing));
  for (int x = 12; x < 33; ++x) matte.col(x).setTo(cv::Scalar::all(std::min(most, (x - 11) * most / 12)));
  return matte;
}

std::string matte_fault(const fs::path& path, cv::Size size = {33, 17}) {
  const std::string text = fault_of(ErrorKind::kInput, [&] { read_matte(path, size); });
  EXPECT_EQ(text.find(path.string() + ": "), 0u) << text;
  return text;
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Matte, IsGreyOfThePicturesSize) {
  const ScratchFolder scratch;
  const cv::Mat grey = ramp(CV_8UC1);
  cv::Mat tinted = ramp(CV_8UC3);
  tinted.at<cv::Vec3b>(3, 30)[1] = 200;
  write_picture(scratch / "grey.png", grey);
  write_picture(scratch / "deep.png", ramp(CV_16UC1));
  write_picture(scratch / "tinted.png", tinted);
  const Matte plain = read_matte(scratch / "grey.png", {33, 17});
  EXPECT_EQ(cv::norm(plain.alpha, grey, cv::NORM_INF), 0);
  EXPECT_TRUE(plain.notices.empty());
  EXPECT_LE(cv::norm(read_matte(scratch / "deep.png", {33, 17}).alpha, grey, cv::NORM_INF), 1);
  const Matte reduced = read_matte(scratch / "tinted.png", {33, 17});
  EXPECT_EQ(reduced.alpha.type(), CV_8UC1);
  ASSERT_EQ(reduced.notices.size(), 1u);
  EXPECT_EQ(reduced.notices[0], "colour reduced to grey");
}

TEST(Matte, IsTheAlphaOfAFileThatHasOne) {
  const ScratchFolder scratch;
  cv::Mat cut_out = noise(CV_8UC4), alpha = ramp(CV_8UC1);
  cv::insertChannel(alpha, cut_out, 3);
  write_picture(scratch / "a.png", cut_out);
  const Matte matte = read_matte(scratch / "a.png", {33, 17});
  EXPECT_EQ(cv::norm(matte.alpha, alpha, cv::NORM_INF), 0);
  ASSERT_EQ(matte.notices.size(), 1u);
  EXPECT_EQ(matte.notices[0], "its alpha channel is the matte");
  const Still still = read_still(scratch / "a.png");
  EXPECT_EQ(cv::norm(still.alpha, alpha, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(matte_of_alpha(still.alpha, "a.png").alpha, alpha, cv::NORM_INF), 0);
}

TEST(Matte, OfAnotherSizeIsScaledAndSaidAndOfAnotherShapeRefused) {
  const ScratchFolder scratch;
  write_picture(scratch / "a.png", ramp(CV_8UC1));
  const Matte matte = read_matte(scratch / "a.png", {66, 34});
  EXPECT_EQ(matte.alpha.size(), cv::Size(66, 34));
  ASSERT_FALSE(matte.notices.empty());
  EXPECT_EQ(matte.notices[0], "the matte is 33 x 17, and is scaled to the picture's 66 x 34");
  EXPECT_TRUE(holds(matte_fault(scratch / "a.png", {40, 20}),
                    "the matte is 33 x 17, the picture 40 x 20: another shape. Crop them alike"));
}

TEST(Matte, FaintGreyLeavesThePictureAsItIs) {
  const ScratchFolder scratch;
  write_picture(scratch / "faint.png", ramp(CV_8UC1, 5));
  const cv::Mat black(17, 33, CV_8UC1, cv::Scalar(0));
  const Matte matte = read_matte(scratch / "faint.png", {33, 17});
  EXPECT_EQ(cv::norm(matte.alpha, ramp(CV_8UC1), cv::NORM_INF), 0);
  ASSERT_EQ(matte.notices.size(), 1u);
  EXPECT_TRUE(holds(matte.notices[0], "36 % of it is nearly black (below 8 of 255) and stands still"));
}

TEST(Matte, WhatCannotBeMeantIsTold) {
  const ScratchFolder scratch;
  const auto told = [&](const cv::Mat& matte) {
    write_picture(scratch / "m.png", matte);
    return matte_fault(scratch / "m.png");
  };
  EXPECT_TRUE(holds(told(cv::Mat(17, 33, CV_8UC1, cv::Scalar(0))), "black everywhere"));
  EXPECT_TRUE(holds(told(cv::Mat(17, 33, CV_8UC1, cv::Scalar(255))), "white everywhere"));
  EXPECT_TRUE(holds(told(noise(CV_8UC3)), "of it is in colour: a picture, not a matte"));
  EXPECT_TRUE(holds(told(ramp(CV_8UC1, 64)),
                    "the matte has no black: 36 % of it is the grey 64 of 255, and would move"));
  cv::Mat hardly = ramp(CV_8UC1, 64);
  hardly.at<std::uint8_t>(0, 0) = 0;
  EXPECT_TRUE(holds(told(hardly), "the matte has hardly any black: 36 % of it is the grey 64"));
}

TEST(Matte, ASoftOneWithoutBlackIsTakenAndSaid) {
  const ScratchFolder scratch;
  cv::Mat soft(17, 33, CV_8UC1, cv::Scalar(255));
  for (int x = 0; x < 8; ++x) soft.col(x).setTo(21 + 29 * x);
  write_picture(scratch / "soft.png", soft);
  const Matte matte = read_matte(scratch / "soft.png", {33, 17});
  EXPECT_EQ(cv::norm(matte.alpha, soft, cv::NORM_INF), 0);
  ASSERT_EQ(matte.notices.size(), 1u);
  EXPECT_TRUE(holds(matte.notices[0], "no black"));
}

TEST(Picture, ADeepOneKeepsItsBits) {
  const ScratchFolder scratch;
  const cv::Mat deep = noise(CV_16UC3, 65536);
  write_picture(scratch / "a.png", deep);
  const Still still = read_still(scratch / "a.png");
  EXPECT_EQ(cv::norm(still.deep, deep, cv::NORM_INF), 0);
  EXPECT_TRUE(still.notices.empty());
  EXPECT_EQ(still.reduction, "16 bits per channel reduced to 8");
  cv::Mat back;
  coded_picture(still).convertTo(back, CV_16U, 65535);
  EXPECT_EQ(cv::norm(back, deep, cv::NORM_INF), 0);
  EXPECT_TRUE(read_still(scratch / "a.png").alpha.empty());
}

TEST(Picture, ALinearOneIsCodedAndAboveWhiteKept) {
  const ScratchFolder scratch;
  cv::Mat light(4, 5, CV_32FC4, cv::Scalar(0.25, 0.5, 4, 1));
  light.at<cv::Vec4f>(1, 1) = {0, 0, 0, 0};
  write_exr_picture(scratch / "a.exr", light, ExrSamples::kFloat);
  const Still still = read_still(scratch / "a.exr");
  EXPECT_EQ(still.deep.at<cv::Vec3f>(0, 0), cv::Vec3f(0.25f, 0.5f, 4));
  EXPECT_EQ(still.bgr.at<cv::Vec3b>(0, 0), cv::Vec3b(137, 188, 255));  // sRGB's code of .25 and .5
  EXPECT_EQ(still.alpha.at<std::uint8_t>(1, 1), 0);
  EXPECT_EQ(still.alpha.at<std::uint8_t>(1, 2), 255);
  EXPECT_NEAR(coded_picture(still).at<cv::Vec3f>(0, 0)[2], 1.055 * std::pow(4, 1 / 2.4) - 0.055, 1e-5);
  std::vector<char> bytes = bytes_of(scratch / "a.exr");
  bytes.resize(bytes.size() - 40);
  put_bytes(scratch / "cut.exr", bytes);
  EXPECT_TRUE(
      holds(fault_of(ErrorKind::kInput, [&] { read_still(scratch / "cut.exr"); }), "OpenEXR cannot read it"));
  light.setTo(std::numeric_limits<float>::infinity());
  write_exr_picture(scratch / "inf.exr", light, ExrSamples::kFloat);
  EXPECT_TRUE(holds(fault_of(ErrorKind::kInput, [&] { read_still(scratch / "inf.exr"); }), "infinite"));
}

void run(const std::string& command) { ASSERT_EQ(std::system(command.c_str()), 0) << command; }

/// An ICC profile of an RGB space with sRGB's curve.
void save_profile(const fs::path& path, const cmsCIExyYTRIPLE& primaries) {
  cmsCIExyY white{0.3127, 0.3290, 1};
  cmsFloat64Number curve[5] = {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045};
  cmsToneCurve* const tone = cmsBuildParametricToneCurve(nullptr, 4, curve);
  cmsToneCurve* tones[3] = {tone, tone, tone};
  cmsHPROFILE profile = cmsCreateRGBProfile(&white, &primaries, tones);
  ASSERT_TRUE(cmsSaveProfileToFile(profile, path.c_str()));
  cmsCloseProfile(profile);
  cmsFreeToneCurve(tone);
}

TEST(Picture, AWideGamutIsBroughtToSrgbAndSaid) {
  const ScratchFolder scratch;
  save_profile(scratch / "p3.icc",
               {{0.680, 0.320, 1}, {0.265, 0.690, 1}, {0.150, 0.060, 1}});  // Display P3's
  save_profile(scratch / "srgb.icc", {{0.64, 0.33, 1}, {0.30, 0.60, 1}, {0.15, 0.06, 1}});
  cv::Mat picture(20, 30, CV_8UC3, cv::Scalar(60, 120, 180));
  picture.colRange(0, 3).setTo(cv::Scalar(0, 0, 255));  // P3's red, which sRGB lacks
  write_picture(scratch / "plain.png", picture);
  for (const char* name : {"a.png", "a.tif", "a.jpg"}) {
    const std::string out = (scratch / name).string();
    run("convert " + (scratch / "plain.png").string() + " -quality 100 -profile " +
        (scratch / "p3.icc").string() + " " + out);
    const Still still = read_still(out);
    ASSERT_EQ(still.notices.size(), 1u) << name;
    EXPECT_TRUE(holds(still.notices[0], "brought from the profile ")) << still.notices[0];
    EXPECT_TRUE(holds(still.notices[0], "to sRGB; 10.0 % of the pixels lie outside")) << still.notices[0];
    const cv::Vec3b inside = still.bgr.at<cv::Vec3b>(10, 20);
    // By hand: P3 (180, 120, 60) is sRGB (188, 119, 47).
    EXPECT_NEAR(inside[2], 188, 2);
    EXPECT_NEAR(inside[1], 119, 2);
    EXPECT_NEAR(inside[0], 47, 3);
  }
  run("convert " + (scratch / "plain.png").string() + " -profile " + (scratch / "srgb.icc").string() + " " +
      (scratch / "s.png").string());
  const Still same = read_still(scratch / "s.png");
  EXPECT_TRUE(same.notices.empty());
  EXPECT_EQ(cv::norm(same.bgr, picture, cv::NORM_INF), 0);
}

TEST(Picture, PartsOfAnExrAreLayersAndTheFirstAPicture) {
  const ScratchFolder folder;
  const std::string file = (folder / "parts.exr").string();
  const cv::Mat film(5, 7, CV_32FC4, cv::Scalar(.125, .25, .5, 1)),
      oak(5, 7, CV_32FC4, cv::Scalar(2, .75, .5, .25));
  const std::vector<ExrPart> parts{{"(film)", film}, {"an oak", oak}};
  for (const ExrSamples samples : {ExrSamples::kHalf, ExrSamples::kFloat}) {
    write_exr_parts(file, parts, samples);
    Imf::MultiPartInputFile found(file.c_str());
    ASSERT_EQ(found.parts(), 2);
    EXPECT_EQ(found.header(0).name(), "(film)");
    EXPECT_EQ(found.header(1).name(), "an oak");
    const char* const kChannels[] = {"B", "G", "R", "A"};
    for (int c = 0; c < 4; ++c) {
      const auto at = static_cast<std::size_t>(c);
      EXPECT_EQ(exr_channel(file, 0, kChannels[at]).at<float>(4, 6), film.at<cv::Vec4f>(4, 6)[c]);
      EXPECT_EQ(exr_channel(file, 1, std::string("an oak.") + kChannels[at]).at<float>(4, 6),
                oak.at<cv::Vec4f>(4, 6)[c]);
    }
    EXPECT_NEAR(read_picture(file).bgr.at<cv::Vec3b>(2, 2)[2], 188, 1);
  }
  const std::vector<ExrPart> bytes{{"a", cv::Mat(5, 7, CV_8UC3)}};
  EXPECT_TRUE(holds(fault_of(ErrorKind::kUsage, [&] { write_exr_parts(file, bytes, ExrSamples::kHalf); }),
                    "32-bit BGR"));
}

TEST(Picture, PrimariesOfAnotherSpaceInAnExrAreRefused) {
  const ScratchFolder scratch;
  write_exr_picture(scratch / "a.exr", cv::Mat(4, 5, CV_32FC3, cv::Scalar::all(0.5)), ExrSamples::kHalf);
  run("oiiotool " + (scratch / "a.exr").string() +
      " --attrib:type=float[8] chromaticities "
      "0.713,0.293,0.165,0.830,0.128,0.044,0.32168,0.33767 -o " +
      (scratch / "aces.exr").string());
  EXPECT_TRUE(holds(fault_of(ErrorKind::kInput, [&] { read_still(scratch / "aces.exr"); }),
                    "its primaries are not those of Rec. 709 (sRGB)"));
}

TEST(Picture, WritingFaultsNameTheFile) {
  const ScratchFolder scratch;
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
