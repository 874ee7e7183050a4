// Mattes of pictures whose alpha is known, and marks that leave nothing to find.

#include "synth/matte/matte.h"

#include <cmath>

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/synth/matte/made_picture.h"

namespace freshet::synth::matte {
namespace {

MadeMatte matte_of(const MadePicture& made, Edge edge) {
  MatteOptions options;
  options.edge.edge = edge;
  return make_matte(made.picture, made.marks, options, "marks");
}

// A region without a soft edge cannot come nearer than some 0.083: the edge is 6 px wide, the radius 36.
TEST(Matte, ComesNearAKnownAlpha) {
  const MadePicture made = made_picture();
  EXPECT_LT(sad_fraction(matte_of(made, Edge::kNone).alpha, made.alpha), 0.11);
  EXPECT_LT(sad_fraction(matte_of(made, Edge::kGuided).alpha, made.alpha), 0.075);
  EXPECT_LT(sad_fraction(matte_of(made, Edge::kInformationFlow).alpha, made.alpha), 0.04);
}

// A wide soft edge is what matting is for.
TEST(Matte, InformationFlowFindsAWideEdgeThatARegionCannotHave) {
  const MadePicture made = made_picture({320, 240}, 24);
  const double hard = sad_fraction(matte_of(made, Edge::kNone).alpha, made.alpha);
  const double soft = sad_fraction(matte_of(made, Edge::kInformationFlow).alpha, made.alpha);
  EXPECT_LT(soft, 0.6 * hard) << hard;
}

TEST(Matte, OfALargePictureComesFromReducedCopiesAndIsAsGood) {
  const MadePicture made = made_picture({1600, 1200}, 12);
  const MadeMatte guided = matte_of(made, Edge::kGuided);
  EXPECT_EQ(guided.alpha.size(), made.picture.size());
  EXPECT_LT(sad_fraction(guided.alpha, made.alpha), 0.03);
}

// What stands still wherever a matte is read is 0 in it.
TEST(Matte, HasNothingThatIsNearlyBlack) {
  const MadePicture made = made_picture({320, 240}, 24);
  for (const Edge edge : {Edge::kNone, Edge::kGuided, Edge::kInformationFlow}) {
    const cv::Mat alpha = matte_of(made, edge).alpha;
    EXPECT_EQ(cv::countNonZero((alpha > 0) & (alpha < 8)), 0) << to_string(edge);
    EXPECT_EQ(cv::countNonZero((alpha >= 8) & (alpha < 128)) > 0, edge != Edge::kNone);
  }
}

TEST(Matte, KeepsTheMarksAndTheRegionOutsideOfTheBand) {
  const MadePicture made = made_picture();
  for (const Edge edge : {Edge::kGuided, Edge::kInformationFlow}) {
    MatteOptions options;
    options.edge.edge = edge;
    const cv::Mat region = hard_region(made.picture, made.marks, options.region, "marks");
    const cv::Mat alpha = soft_edge(made.picture, region, made.marks, options.edge);
    const cv::Mat trimap = trimap_of(region, made.marks, band_width(options.edge, region.size()));
    EXPECT_EQ(cv::countNonZero((trimap != 128) & (alpha != trimap)), 0);
    EXPECT_GT(cv::countNonZero((alpha > 0) & (alpha < 255)), 100);
    EXPECT_EQ(cv::countNonZero((made.marks == kFluid) & (alpha != 255)), 0);
    EXPECT_EQ(cv::countNonZero((made.marks == kBackground) & (alpha != 0)), 0);
  }
}

// As spray at a brink: of the fluid's colour, and none of it.
TEST(Matte, SprayBesideTheFluidIsLeftOut) {
  MadePicture made = made_picture();
  cv::Mat spray(made.picture.size(), CV_8U, cv::Scalar(0));
  for (int x = 14; x < 146; x += 12) spray(cv::Rect(x, 12, 2, 2)).setTo(255);
  made.picture.setTo(cv::Scalar(230, 225, 215), spray);
  for (const Edge edge : {Edge::kNone, Edge::kGuided, Edge::kInformationFlow}) {
    const cv::Mat alpha = matte_of(made, edge).alpha;
    EXPECT_EQ(cv::countNonZero(alpha & spray), 0);
    EXPECT_LT(sad_fraction(alpha, made.alpha), 0.11);
  }
}

// As a white sky over a white fall: of the fluid's colour, and nobody's mark near it.
TEST(Matte, WhatLooksAlikeFarFromAllMarksIsLeftOutUnlessItIsMarked) {
  MadePicture made = made_picture({480, 360});
  const cv::Rect far(20, 20, 40, 40), disc(170, 110, 140, 140);
  made.picture(disc)(cv::Rect(50, 50, 40, 40)).copyTo(made.picture(far));
  const MadeMatte one = matte_of(made, Edge::kNone);
  EXPECT_EQ(cv::countNonZero(one.alpha(far)), 0);
  EXPECT_GT(cv::countNonZero(one.alpha(disc)), 10'000);
  ASSERT_EQ(one.notices.size(), 1U);
  EXPECT_NE(one.notices[0].find("mark it"), std::string::npos) << one.notices[0];
  made.marks(cv::Rect(35, 35, 5, 5)).setTo(kFluid);
  const MadeMatte both = matte_of(made, Edge::kNone);
  EXPECT_GT(cv::countNonZero(both.alpha(far)), 1'000);
  EXPECT_TRUE(both.notices.empty());
}

// As a sky of the sea's colours over a horizon.
TEST(Matte, WhatTheBackgroundsMarksReachOverLessOfABorderIsBackground) {
  cv::Mat picture(240, 320, CV_8UC3);
  cv::RNG random(5);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const double sky = 70 + 90.0 * y / 110, level = y < 110   ? sky
                                                      : y < 116 ? 60
                                                                : 150 + 12 * std::sin(y * 0.5);
      const int noise = random.uniform(-3, 4);
      picture.at<cv::Vec3b>(y, x) = cv::Vec3b(cv::saturate_cast<std::uint8_t>(level + 40 + noise),
                                              cv::saturate_cast<std::uint8_t>(level + noise),
                                              cv::saturate_cast<std::uint8_t>(level - 30 + noise));
    }
  Marks marks(picture.size(), CV_8U, cv::Scalar(kUnknown));
  marks(cv::Rect(60, 10, 200, 6)).setTo(kBackground);
  marks(cv::Rect(60, 180, 200, 6)).setTo(kFluid);
  const cv::Mat region = hard_region(picture, marks, {}, "marks");
  EXPECT_EQ(cv::countNonZero(region.rowRange(0, 108)), 0);
  EXPECT_EQ(cv::countNonZero(region.rowRange(120, 240)), 120 * 320);
}

TEST(Matte, IsTheSameTwiceAndWhateverTheGeneratorsState) {
  const MadePicture made = made_picture();
  const cv::Mat first = matte_of(made, Edge::kInformationFlow).alpha;
  cv::theRNG() = cv::RNG(99);
  const std::uint64_t state = cv::theRNG().state;
  const cv::Mat second = matte_of(made, Edge::kInformationFlow).alpha;
  EXPECT_EQ(cv::norm(first, second, cv::NORM_L1), 0);
  EXPECT_EQ(cv::theRNG().state, state);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const cv::Mat alone = matte_of(made, Edge::kInformationFlow).alpha;
  cv::setNumThreads(threads);
  EXPECT_EQ(cv::norm(first, alone, cv::NORM_L1), 0);
}

TEST(Matte, OneKindOfMarkIsEnoughAndIsSaid) {
  MadePicture made = made_picture();
  const Marks both = made.marks.clone();
  made.marks.setTo(kUnknown, both == kBackground);
  const MadeMatte of_fluid = matte_of(made, Edge::kNone);
  EXPECT_LT(sad_fraction(of_fluid.alpha, made.alpha), 0.12);
  ASSERT_EQ(of_fluid.notices.size(), 1u);
  EXPECT_NE(of_fluid.notices[0].find("border is taken for it"), std::string::npos);

  made.marks = both.clone();
  made.marks.setTo(kUnknown, both == kFluid);
  const MadeMatte of_background = matte_of(made, Edge::kNone);
  EXPECT_LT(sad_fraction(of_background.alpha, made.alpha), 0.16);
  ASSERT_EQ(of_background.notices.size(), 1u);
  EXPECT_NE(of_background.notices[0].find("may be fluid"), std::string::npos);
}

// One pixel of each: too few for OpenCV to learn colours from.
TEST(Matte, TheSmallestMarksDo) {
  MadePicture made = made_picture();
  made.marks.setTo(kUnknown);
  made.marks.at<std::uint8_t>(60, 80) = kFluid;
  made.marks.at<std::uint8_t>(5, 5) = kBackground;
  EXPECT_LT(sad_fraction(matte_of(made, Edge::kNone).alpha, made.alpha), 0.15);
}

TEST(Matte, PicturesWithoutContrastOrSizeDoNotFail) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(2, 1), cv::Size(3, 3), cv::Size(40, 30)}) {
    const cv::Mat flat(size, CV_8UC3, cv::Scalar(80, 80, 80));
    Marks marks(size, CV_8U, cv::Scalar(kUnknown));
    marks.at<std::uint8_t>(0, 0) = kFluid;
    if (size.width > 1) marks.at<std::uint8_t>(0, size.width - 1) = kBackground;
    for (const Edge edge : {Edge::kNone, Edge::kGuided, Edge::kInformationFlow}) {
      MatteOptions options;
      options.edge.edge = edge;
      if (size.width == 1) {
        EXPECT_NE(fault_of(ErrorKind::kInput, [&] { make_matte(flat, marks, options, "marks"); }), "");
      } else {
        EXPECT_GT(make_matte(flat, marks, options, "marks").fraction, 0) << size;
      }
    }
  }
}

TEST(Matte, MarksThatLeaveNothingToFindAreRefused) {
  const MadePicture made = made_picture();
  const auto answer = [&](const Marks& marks) {
    return fault_of(ErrorKind::kInput, [&] { make_matte(made.picture, marks, {}, "s.png"); });
  };
  EXPECT_NE(answer(Marks(made.picture.size(), CV_8U, cv::Scalar(kUnknown))).find("s.png: nothing is marked"),
            std::string::npos);
  EXPECT_NE(answer(Marks(made.picture.size(), CV_8U, cv::Scalar(kFluid)))
                .find("s.png: the whole border of the picture is marked as fluid"),
            std::string::npos);
  EXPECT_NE(answer(Marks(made.picture.size(), CV_8U, cv::Scalar(kBackground)))
                .find("s.png: the whole picture is marked as background"),
            std::string::npos);
  // A picture of one colour, with background alone: nothing looks like fluid.
  const cv::Mat flat(60, 80, CV_8UC3, cv::Scalar(80, 80, 80));
  Marks most(flat.size(), CV_8U, cv::Scalar(kBackground));
  most.at<std::uint8_t>(30, 40) = kUnknown;
  const std::string said = fault_of(ErrorKind::kInput, [&] { make_matte(flat, most, {}, "s.png"); });
  EXPECT_NE(said.find("s.png: no pixel came out as fluid"), std::string::npos) << said;
}

TEST(Matte, ASheetShowsAllFourCroppedAtFullSize) {
  const MadePicture made = made_picture();
  cv::Mat picture, alpha;
  Marks marks;
  // The same in a wide picture without fluid around it.
  cv::copyMakeBorder(made.picture, picture, 100, 100, 300, 300, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(made.alpha, alpha, 100, 100, 300, 300, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::copyMakeBorder(made.marks, marks, 100, 100, 300, 300, cv::BORDER_CONSTANT, cv::Scalar(kBackground));
  const cv::Mat sheet = matte_sheet(picture, marks, alpha);
  EXPECT_LT(sheet.cols, 2 * 300) << "cropped";
  const auto colour_in = [&](int column, int row, const cv::Vec3b& colour) {
    cv::Mat found;
    const int half = (sheet.rows - 60) / 2;
    const cv::Rect quarter(column * sheet.cols / 2, row * half, sheet.cols / 2, half);
    cv::inRange(sheet(quarter), cv::Scalar(colour), cv::Scalar(colour), found);
    return cv::countNonZero(found);
  };
  EXPECT_GT(colour_in(1, 0, {40, 220, 40}), 20) << "marks";
  EXPECT_EQ(colour_in(0, 0, {40, 220, 40}), 0);
  // As many white pixels as the matte has: full size.
  EXPECT_NEAR(colour_in(0, 1, {255, 255, 255}), cv::countNonZero(alpha == 255), 200);
}

}  // namespace
}  // namespace freshet::synth::matte
