// freshet synth matte from end to end: a picture and marks in, a matte that freshet query takes out.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"
#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

const cv::Rect kFluid(50, 30, 60, 50);

class MatteTool : public testing::Test {
 protected:
  MatteTool() {
    cv::Mat picture(120, 160, CV_8UC3), noise(120, 160, CV_8UC3);
    cv::RNG random(3);
    random.fill(noise, cv::RNG::UNIFORM, 0, 30);
    picture.setTo(cv::Scalar(40, 90, 30));
    picture(kFluid).setTo(cv::Scalar(220, 215, 210));
    picture += noise;
    cv::imwrite(folder_ / "still.png", picture);
    cv::Mat scribbles(120, 160, CV_8UC4, cv::Scalar(0, 0, 0, 0));
    scribbles(cv::Rect(70, 50, 20, 5)).setTo(cv::Scalar(0, 255, 0, 255));
    scribbles(cv::Rect(10, 10, 140, 4)).setTo(cv::Scalar(0, 0, 255, 255));
    cv::imwrite(folder_ / "s.png", scribbles);
  }
  Outcome matte(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"synth", "matte", "still.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder_.freshet(arguments);
  }
  /// Mean difference to the truth, 0..1.
  double error_of(const std::string& name) const {
    const cv::Mat alpha = cv::imread(folder_ / name, cv::IMREAD_UNCHANGED);
    EXPECT_EQ(alpha.type(), CV_8U);
    EXPECT_EQ(alpha.size(), cv::Size(160, 120));
    cv::Mat truth(120, 160, CV_8U, cv::Scalar(0));
    truth(kFluid).setTo(255);
    return cv::norm(alpha, truth, cv::NORM_L1) / cv::sum(truth)[0];
  }

  WorkFolder folder_;
};

TEST_F(MatteTool, FromScribblesByEachEdge) {
  for (const char* edge : {"none", "guided", "information-flow"}) {
    const Outcome made = matte({"--scribbles", "s.png", "--edge", edge, "-o", "m.png", "--overwrite"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_EQ(made.out, "m.png\n");
    EXPECT_NE(made.err.find("of 160 x 120 px is fluid"), std::string::npos) << made.err;
    EXPECT_LT(error_of("m.png"), 0.05) << edge;
  }
}

TEST_F(MatteTool, FromABoxOrMarks) {
  folder_.file("m.json", R"({"format": "freshet-marks", "version": 1, "marks": [
    {"is": "fluid", "points": [[60, 55], [100, 55]]}, {"is": "background", "points": [[10, 10], [150, 10]]}]})");
  ASSERT_EQ(matte({"--box", "40,20,80,70", "-o", "box.png"}).exit_code, 0);
  EXPECT_LT(error_of("box.png"), 0.05);
  ASSERT_EQ(matte({"--marks", "m.json", "-o", "marks.png"}).exit_code, 0);
  EXPECT_LT(error_of("marks.png"), 0.05);
}

TEST_F(MatteTool, JsonAndSheet) {
  const Outcome made = matte({"--scribbles", "s.png", "-o", "m.png", "--sheet", "sheet.png", "--json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const nlohmann::json json = nlohmann::json::parse(made.out);
  EXPECT_NEAR(json["share"].get<double>(), kFluid.area() / (160.0 * 120), 0.02);
  EXPECT_EQ(json["matte"], "m.png");
  for (const char* stage : {"marks", "region", "edge"}) EXPECT_GE(json["seconds"][stage].get<double>(), 0);
  // Two cells across and two down, cropped to the matte, with a legend below.
  const cv::Size sheet = cv::imread(folder_ / "sheet.png").size();
  EXPECT_GE(sheet.width, 2 * kFluid.width);
  EXPECT_LT(sheet.width, 2 * 160);
  EXPECT_GT(sheet.height, 2 * kFluid.height);
}

// A still of the store's kind of fluid in the middle of a chequered wall.
TEST_F(MatteTool, FromTheStoreItself) {
  cv::Mat picture(2 * kHeight, 3 * kWidth, CV_8UC3);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      picture.at<cv::Vec3b>(y, x) = (x / 7 + y / 7) % 2 != 0 ? cv::Vec3b(20, 120, 30) : cv::Vec3b(10, 60, 90);
  const cv::Mat still = cv::imread(sample().still), alpha = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE);
  const cv::Rect middle(kWidth, kHeight / 2, kWidth, kHeight);
  still.copyTo(picture(middle));
  cv::imwrite(folder_ / "wall.png", picture);
  const Outcome made = folder_.freshet(
      {"synth", "matte", "wall.png", "--auto", sample().store, "--class", "fall", "-o", "m.png", "--json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_NE(made.err.find("This is a guess"), std::string::npos) << made.err;
  const cv::Mat matte = cv::imread(folder_ / "m.png", cv::IMREAD_GRAYSCALE);
  ASSERT_EQ(matte.size(), picture.size());
  const double inside = cv::sum(matte(middle))[0], all = cv::sum(matte)[0];
  EXPECT_GT(inside, 0.9 * all) << made.err;
  EXPECT_GT(inside / 255, 0.2 * middle.area()) << made.err;
}

TEST_F(MatteTool, WhatTheStoreCannotTellIsSaidAndNoAdviceIsGivenTwice) {
  cv::imwrite(folder_ / "plain.png", cv::Mat(160, 240, CV_8UC3, cv::Scalar(90, 80, 70)));
  const auto asked = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"synth",        "matte", "plain.png", "--auto",
                                       sample().store, "-o",    "p.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder_.freshet(arguments);
  };
  const auto holds = [](const Outcome& outcome, const char* words) {
    return outcome.err.find(words) != std::string::npos;
  };
  const Outcome bare = asked({});
  EXPECT_EQ(bare.exit_code, 1);
  EXPECT_TRUE(holds(bare, "it cannot tell the fluid in this picture from the rest")) << bare.err;
  EXPECT_TRUE(holds(bare, "Try --class with the fluid's class, or mark the fluid")) << bare.err;
  const Outcome of_class = asked({"--class", "fall"});
  EXPECT_EQ(of_class.exit_code, 1);
  EXPECT_FALSE(holds(of_class, "--class")) << of_class.err;
  EXPECT_TRUE(holds(of_class, "Mark the fluid with a few --scribbles or a --box")) << of_class.err;
  // Strokes are followed, whatever the store has to say.
  const Outcome with_strokes = matte({"--auto", sample().store, "--scribbles", "s.png", "-o", "q.png"});
  EXPECT_EQ(with_strokes.exit_code, 0) << with_strokes.err;
  EXPECT_TRUE(holds(with_strokes, "Your own marks are used alone")) << with_strokes.err;
}

TEST_F(MatteTool, BadInputIsRefusedBeforeAnythingIsWritten) {
  cv::imwrite(folder_ / "small.png", cv::Mat(30, 40, CV_8UC3, cv::Scalar(0, 255, 0)));
  cv::imwrite(folder_ / "empty.png", cv::Mat(120, 160, CV_8UC4, cv::Scalar(0, 0, 0, 0)));
  cv::imwrite(folder_ / "all.png", cv::Mat(120, 160, CV_8UC3, cv::Scalar(255, 255, 255)));
  folder_.file("bad.json", "{}");
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    const char* message;
  };
  const std::vector<Case> cases{
      {{}, 2, "nothing says where the fluid is. Give --scribbles, --marks, --box or --auto"},
      {{"--scribbles", "small.png"}, 1, "small.png: the scribbles are 40 x 30 px, the picture 160 x 120"},
      {{"--scribbles", "empty.png"}, 1, "empty.png: no stroke in it"},
      {{"--scribbles", "all.png"}, 1, "all.png: the whole border of the picture is marked as fluid"},
      {{"--scribbles", "none.png"}, 1, "none.png: there is no such file"},
      {{"--marks", "bad.json"}, 1, "bad.json: \"format\" is not"},
      {{"--auto", "none.store"}, 1, "none.store"},
      {{"--box", "1,2,3"}, 2, "--box 1,2,3: it is not LEFT,TOP,WIDTH,HEIGHT"},
      {{"--box", "500,0,10,10"}, 2, "has no area in the picture of 160 x 120 px"},
      {{"--scribbles", "s.png", "--edge", "sharp"}, 2, "--edge"}};
  for (const Case& one : cases) {
    std::vector<std::string> arguments = one.arguments;
    arguments.insert(arguments.end(), {"-o", "m.png"});
    const Outcome outcome = matte(arguments);
    EXPECT_EQ(outcome.exit_code, one.exit_code) << one.message << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(one.message), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "m.png")) << one.message;
  }
  EXPECT_EQ(matte({"--scribbles", "s.png", "-o", "s.png/m.png"}).exit_code, 1);
  EXPECT_EQ(matte({"--scribbles", "s.png", "-o", "m.nosuch"}).exit_code, 2);
}

}  // namespace
}  // namespace freshet::tools
