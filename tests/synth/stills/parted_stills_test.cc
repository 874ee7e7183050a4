// Things that move through each other: one is taken out of the stills, and goes before what lies behind it.
#include "synth/stills/parted_stills.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <opencv2/imgcodecs.hpp>

#include "synth/stills/film.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"
#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

constexpr int kPartedStills = 6;
const cv::Size kPartedSize(320, 192);

/// A red ball that leaps along a row, before a bright disc that swings up and down behind it.
class PartedLayers : public testing::Test {
 protected:
  PartedLayers() {
    std::filesystem::create_directories(folder_ / "stills");
    std::filesystem::create_directories(folder_ / "ball");
    for (int i = 0; i < kPartedStills; ++i) {
      cv::Mat still = behind(i), matte(kPartedSize, CV_8U, cv::Scalar(0));
      cv::circle(still, ball(i), 14, {40, 40, 230}, cv::FILLED);
      cv::circle(matte, ball(i), 14, 255, cv::FILLED);
      cv::imwrite(folder_ / "stills" / name(i), still);
      cv::imwrite(folder_ / "ball" / name(i), matte);
    }
  }
  static std::string name(int i) { return std::string(1, static_cast<char>('a' + i)) + ".png"; }
  static cv::Point ball(int i) { return {40 + 48 * i, 96}; }
  static cv::Mat behind(int i) {
    cv::Mat still = made_ground(kPartedSize);
    cv::circle(still, {160, 76 + 8 * i}, 30, {210, 230, 250}, cv::FILLED, cv::LINE_AA);
    return still;
  }
  Film film(const std::string& edits) const {
    std::ofstream(folder_ / "edits.toml") << edits;
    FilmOptions options{
        .seconds = 2, .fps = 10, .camera = "tripod", .one_region = true, .edits = folder_ / "edits.toml"};
    settle(options);
    return plan_film(read_stills(folder_ / "stills"), options, {});
  }
  static std::vector<cv::Mat> frames(const Film& film) {
    std::vector<cv::Mat> out;
    render_frames(film.plan, film.stills.pictures, film.render,
                  [&](const cv::Mat& frame) { out.push_back(frame.clone()); });
    return out;
  }
  /// px that are the ball's red.
  static int red(const cv::Mat& frame) {
    cv::Mat found;
    cv::inRange(frame, cv::Scalar(20, 20, 200), cv::Scalar(70, 70, 255), found);
    return cv::countNonZero(found);
  }
  const ScratchFolder folder_;
  const std::string front_ = "[[front]]\nname = \"ball\"\nmattes = \"ball\"\n";
};

TEST_F(PartedLayers, WhatIsHiddenComesFromStillsThatShowIt) {
  const Film made = film(front_);
  for (int i = 0; i < kPartedStills; ++i) {
    cv::Mat matte = cv::imread(folder_ / "ball" / name(i), cv::IMREAD_GRAYSCALE), apart;
    cv::absdiff(made.stills.pictures[i], behind(i), apart);
    // The ground is the same in all; the disc stands otherwise in each, so that its rim may be another's.
    EXPECT_LT(cv::mean(apart, matte)[0], 25) << i;
    EXPECT_EQ(red(made.stills.pictures[i]), 0) << i;
  }
}

TEST_F(PartedLayers, AStillPutTogetherAgainIsItself) {
  const Film made = film(front_);
  const FrontThing& thing = *made.plan.regions.back().front;
  for (int i = 0; i < kPartedStills; ++i) {
    cv::Mat together = thing.light[i].clone();
    for (int y = 0; y < together.rows; ++y)
      for (int x = 0; x < 3 * together.cols; ++x)
        if (thing.alpha[i].ptr(y)[x] == 0) together.ptr(y)[x] = made.stills.pictures[i].ptr(y)[x];
    const cv::Mat still = cv::imread(folder_ / "stills" / name(i));
    const cv::Mat matte = cv::imread(folder_ / "ball" / name(i), cv::IMREAD_GRAYSCALE);
    EXPECT_EQ(cv::norm(together, still, cv::NORM_INF, matte), 0) << i;
  }
}

TEST_F(PartedLayers, ASoftRimCarriesNothingOfWhatLayBehind) {
  std::vector<cv::Mat> pictures{cv::Mat(64, 64, CV_8UC3, cv::Scalar::all(200)),
                                cv::Mat(64, 64, CV_8UC3, cv::Scalar::all(200))};
  std::vector<cv::Mat> mattes{cv::Mat(64, 64, CV_8U, cv::Scalar(0)), cv::Mat(64, 64, CV_8U, cv::Scalar(0))};
  mattes[0](cv::Rect(20, 20, 9, 9)).setTo(128);
  pictures[0](cv::Rect(20, 20, 9, 9)).setTo(cv::Scalar::all(cvRound(.502 * 40 + .498 * 200)));
  std::vector<std::string> notices;
  const FrontThing thing = part_stills(pictures, mattes, {}, "glass", notices);
  EXPECT_NEAR(thing.light[0].at<cv::Vec3b>(24, 24)[0], .502 * 40, 1.5);
  EXPECT_EQ(pictures[0].at<cv::Vec3b>(24, 24)[0], 200);
  EXPECT_TRUE(notices.empty());
}

TEST_F(PartedLayers, WhatIsSeenNowhereIsMadeUpOfStillsOfSixteenBitsToo) {
  for (const int type : {CV_8UC3, CV_16UC3}) {
    const double most = type == CV_8UC3 ? 255 : 65535;
    std::vector<cv::Mat> pictures(2), mattes(2);
    for (int i = 0; i < 2; ++i) {
      pictures[i] = cv::Mat(64, 64, type, cv::Scalar::all(.8 * most));
      mattes[i] = cv::Mat(64, 64, CV_8U, cv::Scalar(0));
      mattes[i](cv::Rect(20 + i, 20, 9, 9)).setTo(255);
      pictures[i].setTo(cv::Scalar::all(0), mattes[i]);
    }
    std::vector<std::string> notices;
    part_stills(pictures, mattes, {}, "glass", notices);
    EXPECT_EQ(notices.size(), 1u);
    cv::Mat behind;
    pictures[0].convertTo(behind, CV_32F, 1 / most);
    EXPECT_LT(cv::norm(behind, cv::Mat(64, 64, CV_32FC3, cv::Scalar::all(.8)), cv::NORM_INF), .01) << type;
  }
}

TEST_F(PartedLayers, AThingThatLeapsOverItsLengthIsThereOnceInEveryFrame) {
  const double area = CV_PI * 14 * 14;
  for (const cv::Mat& frame : frames(film(front_))) EXPECT_NEAR(red(frame), area, .2 * area);
}

TEST_F(PartedLayers, EachGoesItsOwnWay) {
  const Film made = film(front_ +
                         "[[region]]\nname = \"ball\"\nsequence = [\"a.png\", \"b.png\"]\n"
                         "[[region]]\nname = \"1\"\nsequence = [\"f.png\", \"e.png\"]\n");
  const cv::Mat first = frames(made)[0];
  EXPECT_GT(red(first(cv::Rect(20, 76, 40, 40))), 400);           // the ball of a
  EXPECT_GT(first.at<cv::Vec3b>(140, 160)[0], 180);               // the disc of f
  EXPECT_LT(cv::mean(first(cv::Rect(270, 90, 20, 12)))[2], 110);  // and not the ball of f
}

TEST_F(PartedLayers, WhatFillsOneThingShowsNoneOfAFartherOne) {
  std::filesystem::create_directories(folder_ / "kite");
  for (int i = 0; i < kPartedStills; ++i) {
    cv::Mat still = cv::imread(folder_ / "stills" / name(i)), matte(kPartedSize, CV_8U, cv::Scalar(0));
    // A green kite that goes where the ball is in other stills.
    const cv::Rect kite(30 + 48 * ((i + 1) % kPartedStills), 86, 20, 20);
    still(kite).setTo(cv::Scalar(40, 240, 40));
    matte(kite).setTo(255);
    cv::imwrite(folder_ / "stills" / name(i), still);
    cv::imwrite(folder_ / "kite" / name(i), matte);
  }
  const Film made = film(front_ + "[[front]]\nname = \"kite\"\nmattes = \"kite\"\n");
  for (const cv::Mat& behind : made.stills.pictures) {
    cv::Mat green;
    cv::inRange(behind, cv::Scalar(0, 200, 0), cv::Scalar(120, 255, 120), green);
    EXPECT_EQ(cv::countNonZero(green), 0);
  }
}

TEST_F(PartedLayers, FaultsAreNamed) {
  const auto fault = [&](const std::string& edits) { return fault_of([&] { film(edits); }); };
  EXPECT_NE(fault("[[front]]\nname = \"ball\"\nmattes = \"none\"\n").find("none"), std::string::npos);
  EXPECT_NE(fault("[[front]]\nname = \"1\"\nmattes = \"ball\"\n").find("another region"), std::string::npos);
  EXPECT_NE(fault(front_ + front_).find("another thing"), std::string::npos);
  EXPECT_NE(fault("[[front]]\nname = \"*\"\nmattes = \"ball\"\n").find("all regions"), std::string::npos);
  EXPECT_NE(fault(front_ + "[[region]]\nname = \"ball\"\nkind = \"slow\"\n").find("no kind"),
            std::string::npos);
  EXPECT_NE(fault("[[front]]\nname = \"ball\"\nmattes = \"stills\"\n").find("in colour"), std::string::npos);
  cv::imwrite(folder_ / "ball" / "a.png", cv::Mat(20, 20, CV_8U, cv::Scalar(255)));
  EXPECT_NE(fault(front_).find("20 x 20"), std::string::npos);
}

}  // namespace
}  // namespace freshet::synth::stills
