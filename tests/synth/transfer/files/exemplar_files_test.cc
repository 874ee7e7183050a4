#include "synth/transfer/files/exemplar_files.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/video/video_writer.h"
#include "synth/transfer/files/exemplar_motion.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::synth::transfer {
namespace {

namespace fs = std::filesystem;

class ExemplarFilesTest : public testing::Test {
 protected:
  ExemplarFilesTest() { fs::create_directories(folder_ / "frames"); }

  /// A wave that goes by once in so many frames: frame and frame + period are alike.
  static cv::Mat wave(int frame, int period) {
    cv::Mat picture(24, 32, CV_8UC4);
    for (int y = 0; y < picture.rows; ++y)
      for (int x = 0; x < picture.cols; ++x) {
        const double phase = 2 * CV_PI * (static_cast<double>(frame) / period + x / 32.0 + 0.3 * y / 24.0);
        const auto value = static_cast<std::uint8_t>(127.5 + 120 * std::sin(phase));
        picture.at<cv::Vec4b>(y, x) = cv::Vec4b(value, 40, 200, static_cast<std::uint8_t>(155 + value / 3));
      }
    return picture;
  }
  void write_waves(int frames, int period) const {
    for (int i = 0; i < frames; ++i)
      cv::imwrite(folder_ / "frames" / (std::to_string(i) + ".png"), wave(i, period));
  }
  static cv::Mat eight_bits(const ExemplarFrame& frame) {
    EXPECT_EQ(frame.bgra.type(), CV_16UC4);
    cv::Mat picture;
    frame.bgra.convertTo(picture, CV_8U, 1.0 / 257);
    return picture;
  }

  const ScratchFolder folder_;
};

TEST_F(ExemplarFilesTest, AStillIsTheSameMatForEveryFrame) {
  cv::imwrite(folder_ / "a.png", wave(0, 10));
  ExemplarFiles exemplar(folder_ / "a.png", {.frames = 500});
  exemplar.check();
  EXPECT_FALSE(exemplar.opaque());
  EXPECT_FALSE(exemplar.loop());
  const cv::Mat first = exemplar.at(-1).bgra;
  EXPECT_EQ(exemplar.at(0).bgra.data, first.data);
  EXPECT_EQ(exemplar.at(499).bgra.data, first.data);
}

TEST_F(ExemplarFilesTest, FramesGoAsTheAnimationDoes) {
  write_waves(6, 10);
  ExemplarFiles exemplar(folder_ / "frames", {.frames = 6});
  exemplar.check();
  for (int t = 0; t < 6; ++t) {
    EXPECT_EQ(cv::norm(eight_bits(exemplar.at(t)).reshape(1), wave(t, 10).reshape(1), cv::NORM_INF), 0) << t;
    EXPECT_EQ(exemplar.at(t).bgra.data, exemplar.at(t).bgra.data);  // remembered
  }
  EXPECT_EQ(cv::norm(eight_bits(exemplar.at(-1)).reshape(1), wave(0, 10).reshape(1), cv::NORM_INF), 0);
}

// A period of 15 in 60 frames: wherever the loop is joined, the animation goes on as the wave does.
TEST_F(ExemplarFilesTest, AShortOneLoopsWhereItIsLikeItself) {
  write_waves(60, 15);
  ExemplarFiles exemplar(folder_ / "frames", {.frames = 200});
  exemplar.check();
  ASSERT_TRUE(exemplar.loop());
  EXPECT_EQ(exemplar.loop()->length() % 15, 0U);
  double worst = 0;
  for (int t = 0; t < 200; ++t)
    worst = std::max(worst,
                     cv::norm(eight_bits(exemplar.at(t)).reshape(1), wave(t, 15).reshape(1), cv::NORM_INF));
  EXPECT_LE(worst, 2);
}

TEST_F(ExemplarFilesTest, MomentsThatAreStabilisedSayWhereTheyCameFrom) {
  cv::Mat wall(64, 120, CV_8UC1), coloured;
  cv::RNG(1).fill(wall, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(wall, wall, {}, 2);
  cv::normalize(wall, wall, 0, 255, cv::NORM_MINMAX);
  cv::cvtColor(wall, coloured, cv::COLOR_GRAY2BGRA);
  for (int i = 0; i < 6; ++i)  // to the left
    cv::imwrite(folder_ / "frames" / (std::to_string(i) + ".png"), coloured.colRange(2 * i, 80 + 2 * i));
  ExemplarFiles plain(folder_ / "frames", {.frames = 6}),
      stabilised(folder_ / "frames", {.frames = 6, .motion = true});
  plain.check();
  stabilised.check();
  EXPECT_TRUE(plain.at(3).back.empty());
  EXPECT_NEAR(cv::mean(stabilised.at(0).back(cv::Rect(16, 16, 48, 32)))[0], 2, 0.1);
  const cv::Mat back = stabilised.at(3).back;
  ASSERT_EQ(back.type(), CV_32FC2);
  EXPECT_EQ(cv::norm(stabilised.at(3).bgra, plain.at(3).bgra, cv::NORM_INF), 0);
  const cv::Scalar mean = cv::mean(back(cv::Rect(16, 16, 48, 32)));
  EXPECT_NEAR(mean[0], 2, 0.1);
  EXPECT_NEAR(mean[1], 0, 0.1);
}

// Without the white behind it all of it would be black.
TEST_F(ExemplarFilesTest, DarkSmokeOffWhiteIsSeenToMove) {
  for (int i = 0; i < 4; ++i) {
    cv::Mat puff(64, 96, CV_8UC1, cv::Scalar(255));
    for (int k = 0; k < 5; ++k)
      cv::circle(puff, {20 + 9 * k + 2 * i, 24 + 7 * (k % 3)}, 8, cv::Scalar(90), -1);
    cv::GaussianBlur(puff, puff, {}, 3);
    cv::imwrite(folder_ / "frames" / (std::to_string(i) + ".png"), puff);
  }
  ExemplarFiles exemplar(folder_ / "frames", {.ground = Ground::kWhite, .frames = 4, .motion = true});
  exemplar.check();
  EXPECT_NEAR(cv::mean(exemplar.at(2).back(cv::Rect(28, 20, 30, 20)))[0], -2, 0.3);
}

TEST(ExemplarMotion, DimLightIsSeenOverBlackAndDarkPaintOverWhite) {
  cv::Mat puff(20, 20, CV_32FC4, cv::Scalar::all(0));
  puff(cv::Rect(5, 5, 10, 10)).setTo(cv::Scalar(0.1, 0.1, 0.1, 1));
  const cv::Mat paint = seen_by_flow(puff, puff)[0], light = seen_by_flow(puff, puff, true)[1];
  EXPECT_EQ(paint.at<std::uint8_t>(0, 0), 255);
  EXPECT_EQ(light.at<std::uint8_t>(0, 0), 0);
  EXPECT_NEAR(paint.at<std::uint8_t>(10, 10), 25.5, 1);
  EXPECT_EQ(paint.at<std::uint8_t>(10, 10), light.at<std::uint8_t>(10, 10));
}

TEST_F(ExemplarFilesTest, TheOneMomentOfAVideoMovesAsToItsNextFrame) {
  write_waves(3, 10);
  ExemplarFiles one(folder_ / "frames", {.frames = 1, .motion = true}),
      two(folder_ / "frames", {.frames = 2, .motion = true});
  one.check();
  two.check();
  ASSERT_FALSE(one.at(0).back.empty());
  EXPECT_EQ(cv::norm(one.at(0).back, two.at(0).back, cv::NORM_INF), 0);
}

// Flow asks for 16.
TEST_F(ExemplarFilesTest, ASmallExemplarHasItsMotionToo) {
  for (int i = 0; i < 2; ++i)
    cv::imwrite(folder_ / "frames" / (std::to_string(i) + ".png"), wave(i, 10)(cv::Rect(0, 0, 20, 12)));
  ExemplarFiles exemplar(folder_ / "frames", {.frames = 2, .motion = true});
  exemplar.check();
  EXPECT_EQ(exemplar.at(1).back.size(), cv::Size(20, 12));
}

TEST_F(ExemplarFilesTest, AVideoIsWhatItsFramesAre) {
  write_waves(5, 10);
  media::VideoWriter writer(folder_ / "a.mkv", {32, 24});
  for (int i = 0; i < 5; ++i) writer.write(wave(i, 10));
  writer.finish();
  ExemplarFiles of_video(folder_ / "a.mkv", {.frames = 4}), of_frames(folder_ / "frames", {.frames = 4});
  of_video.check();
  of_frames.check();
  EXPECT_EQ(of_video.hash(), of_frames.hash());
  EXPECT_EQ(of_video.frames(), 5);
}

TEST_F(ExemplarFilesTest, MasksTakeThePlaceOfItsAlpha) {
  write_waves(3, 10);
  cv::Mat mask(24, 32, CV_8U, cv::Scalar(0));
  mask(cv::Rect(4, 4, 20, 16)).setTo(255);
  cv::imwrite(folder_ / "mask.png", mask);
  ExemplarFiles exemplar(folder_ / "frames", {.alpha = folder_ / "mask.png", .frames = 3});
  exemplar.check();
  cv::Mat alpha;
  cv::extractChannel(eight_bits(exemplar.at(2)), alpha, 3);
  EXPECT_EQ(cv::norm(alpha, mask, cv::NORM_INF), 0);
}

// A frame that is opaque in a film that is not is all fluid, whatever its grey.
TEST_F(ExemplarFilesTest, MasksAreAlphaOrGreyInAllFramesAlike) {
  write_waves(2, 10);
  fs::create_directories(folder_ / "masks");
  cv::Mat mask(24, 32, CV_8UC4, cv::Scalar(60, 60, 60, 255));
  cv::imwrite(folder_ / "masks" / "0.png", mask);
  mask(cv::Rect(0, 0, 6, 24)).setTo(cv::Scalar::all(0));
  cv::imwrite(folder_ / "masks" / "1.png", mask);
  ExemplarFiles exemplar(folder_ / "frames", {.alpha = folder_ / "masks", .frames = 2});
  exemplar.check();
  cv::Mat alpha;
  cv::extractChannel(eight_bits(exemplar.at(0)), alpha, 3);
  EXPECT_EQ(cv::countNonZero(alpha != 255), 0);
}

TEST_F(ExemplarFilesTest, AFrameThatIsAllThinNamesItself) {
  write_waves(2, 10);
  const std::string thin = folder_ / "frames" / "1.png";
  cv::Mat faint = wave(1, 10);
  cv::insertChannel(cv::Mat(faint.size(), CV_8U, cv::Scalar(20)), faint, 3);
  cv::imwrite(thin, faint);
  ExemplarFiles exemplar(folder_ / "frames", {.frames = 2});
  try {
    exemplar.check();
    FAIL() << "it was taken";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(thin), std::string::npos) << error.what();
  }
  ExemplarFiles lower(folder_ / "frames", {.lower = 0.05, .frames = 2});
  EXPECT_NO_THROW(lower.check());
}

TEST_F(ExemplarFilesTest, ItsStructureIsAsLargeAsIsAskedFor) {
  write_waves(1, 10);
  ExemplarFiles exemplar(folder_ / "frames", {.scale = 0.5});
  exemplar.check();
  EXPECT_EQ(exemplar.size(), cv::Size(16, 12));
  // Light is averaged: colours times alpha.
  const auto light = [](const cv::Mat& bgra) {
    cv::Mat values;
    bgra.convertTo(values, CV_32F, 1.0 / 65535);
    values.forEach<cv::Vec4f>([](cv::Vec4f& at, const int*) {
      at = {at[0] * at[3], at[1] * at[3], at[2] * at[3], at[3]};
    });
    return values;
  };
  ExemplarFiles own(folder_ / "frames", {});
  own.check();
  const cv::Mat whole = light(own.at(0).bgra), half = light(exemplar.at(0).bgra);
  for (int y = 0; y < half.rows; ++y)
    for (int x = 0; x < half.cols; ++x) {
      const cv::Vec4f mean =
          0.25 * (whole.at<cv::Vec4f>(2 * y, 2 * x) + whole.at<cv::Vec4f>(2 * y, 2 * x + 1) +
                  whole.at<cv::Vec4f>(2 * y + 1, 2 * x) + whole.at<cv::Vec4f>(2 * y + 1, 2 * x + 1));
      ASSERT_LT(cv::norm(mean, half.at<cv::Vec4f>(y, x), cv::NORM_INF), 1e-4);
    }
}

// Light on black: a disc, brighter towards its middle.
cv::Mat glow(cv::Size size, double radius) {
  cv::Mat picture(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double light = 1 - std::hypot(x - 0.5 * size.width, y - 0.5 * size.height) / radius;
      picture.at<cv::Vec3b>(y, x) = cv::Vec3b(0, cv::saturate_cast<std::uint8_t>(120 * light),
                                              cv::saturate_cast<std::uint8_t>(255 * light));
    }
  return picture;
}

Extent extent_of_first(ExemplarFiles& exemplar) {
  exemplar.check();
  cv::Mat alpha;
  cv::extractChannel(exemplar.at(0).bgra, alpha, 3);
  alpha.convertTo(alpha, CV_32F, 1.0 / 65535);
  return extent_of(alpha, {});
}

TEST_F(ExemplarFilesTest, ItIsMadeAsLargeAsTheDesign) {
  cv::imwrite(folder_ / "glow.png", glow({200, 160}, 75));
  const Extent design{.boundary = 3000, .interior = 1000};
  ExemplarFiles exemplar(folder_ / "glow.png", {.ground = Ground::kBlack});
  exemplar.fit_scale(design, {});
  EXPECT_LT(exemplar.options().scale, 0.7);
  EXPECT_NEAR(extent_of_first(exemplar).all() / design.all(), 1, 0.1);
  // Not larger than it is.
  ExemplarFiles small(folder_ / "glow.png", {.ground = Ground::kBlack});
  small.fit_scale({.boundary = 20000, .interior = 20000}, {});
  EXPECT_EQ(small.options().scale, 1);
  // Nothing can be said of one that has no outline.
  ExemplarFiles opaque(folder_ / "glow.png", {});
  opaque.fit_scale(design, {});
  EXPECT_EQ(opaque.options().scale, 1);
}

TEST_F(ExemplarFilesTest, AsMuchOfItsLightIsInteriorAsOfTheDesign) {
  cv::imwrite(folder_ / "glow.png", glow({200, 160}, 75));
  for (const double share : {0.1, 0.25, 0.5}) {
    ExemplarFiles exemplar(folder_ / "glow.png", {.ground = Ground::kBlack});
    exemplar.fit_body({.boundary = 1 - share, .interior = share}, {});
    EXPECT_NEAR(extent_of_first(exemplar).interior_share(), share, 0.04);
  }
  // A body that is given stays.
  cv::imwrite(folder_ / "mask.png", cv::Mat(160, 200, CV_8U, cv::Scalar(255)));
  ExemplarFiles given(folder_ / "glow.png", {.alpha = folder_ / "mask.png", .ground = Ground::kBlack});
  given.fit_body({.boundary = 0.9, .interior = 0.1}, {});
  EXPECT_EQ(extent_of_first(given).interior_share(), 1);
}

}  // namespace
}  // namespace freshet::synth::transfer
