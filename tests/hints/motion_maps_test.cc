#include "hints/motion_maps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::hints {
namespace {

const cv::Size kPicture(120, 80);

/// All directions, speeds 1 to 120 px/s, nothing in the first row.
cv::Mat some_motion() {
  cv::Mat motion(kPicture, CV_32FC2);
  for (int y = 0; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x) {
      const double angle = y * 2 * CV_PI / 79, speed = y == 0 ? 0 : x + 1;
      motion.at<cv::Vec2f>(y, x) = cv::Vec2d(speed * std::cos(angle), -speed * std::sin(angle));
    }
  return motion;
}

cv::Mat whole() { return cv::Mat(kPicture, CV_8U, cv::Scalar(255)); }

class MotionMaps : public testing::Test {
 protected:
  std::filesystem::path file(const char* name) const { return folder_.path() / name; }
  template <class Read>
  static std::string fault(Read&& read, ErrorKind kind = ErrorKind::kInput) {
    return fault_of(kind, [&] { read(); });
  }
  ScratchFolder folder_;
};

TEST_F(MotionMaps, ComeBackAsTheyWereWritten) {
  const cv::Mat motion = some_motion();
  EXPECT_EQ(write_speed_map(file("speed.png"), motion, whole(), 255), 0);
  write_orientation_map(file("way.png"), motion, whole());
  const cv::Mat speed = read_speed_map(file("speed.png"), kPicture, 255),
                way = read_orientation_map(file("way.png"), kPicture);
  for (int y = 0; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x) {
      const cv::Vec2f true_way = motion.at<cv::Vec2f>(y, x), found = way.at<cv::Vec2f>(y, x);
      if (y == 0) {
        EXPECT_LT(speed.at<float>(y, x), 0);
        EXPECT_EQ(found, cv::Vec2f(0, 0));
        continue;
      }
      EXPECT_NEAR(speed.at<float>(y, x), cv::norm(true_way), 0.01);
      EXPECT_GT(found.dot(true_way) / cv::norm(true_way), std::cos(0.05 * CV_PI / 180));
    }
}

TEST_F(MotionMaps, AskNothingOutsideTheMatte) {
  cv::Mat matte = whole();
  matte(cv::Rect(0, 0, 60, 80)).setTo(0);
  write_speed_map(file("speed.png"), some_motion(), matte, 255);
  write_orientation_map(file("way.png"), some_motion(), matte);
  const cv::Mat speed = read_speed_map(file("speed.png"), kPicture, 255),
                way = read_orientation_map(file("way.png"), kPicture);
  EXPECT_LT(speed.at<float>(40, 59), 0);
  EXPECT_GT(speed.at<float>(40, 60), 0);
  EXPECT_EQ(way.at<cv::Vec2f>(40, 59), cv::Vec2f(0, 0));
  EXPECT_NE(way.at<cv::Vec2f>(40, 60), cv::Vec2f(0, 0));
}

TEST_F(MotionMaps, EightBitsStayWithinADegreeAndAStepOfGrey) {
  const cv::Mat motion = some_motion();
  write_speed_map(file("speed.png"), motion, whole(), 255);
  write_orientation_map(file("way.png"), motion, whole());
  for (const char* name : {"speed.png", "way.png"})
    media::write_picture(file(name), media::read_picture(file(name)).bgr);
  const cv::Mat speed = read_speed_map(file("speed.png"), kPicture, 255),
                way = read_orientation_map(file("way.png"), kPicture);
  for (int y = 1; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x) {
      const cv::Vec2f true_way = motion.at<cv::Vec2f>(y, x);
      EXPECT_NEAR(speed.at<float>(y, x), cv::norm(true_way), 1.01);
      EXPECT_GT(way.at<cv::Vec2f>(y, x).dot(true_way) / cv::norm(true_way), std::cos(0.5 * CV_PI / 180));
    }
}

TEST_F(MotionMaps, HuesAreDirectionsInDegrees) {
  // As a paint program shows them: red, yellow, green, cyan, blue, magenta; grey, black, pale, transparent.
  cv::Mat map(1, 10, CV_8UC4, cv::Scalar(0, 0, 0, 255));
  const cv::Vec4b colours[10] = {
      {0, 0, 255, 255},   {0, 255, 255, 255},   {0, 255, 0, 255}, {255, 255, 0, 255},   {255, 0, 0, 255},
      {255, 0, 255, 255}, {128, 128, 128, 255}, {9, 0, 0, 255},   {220, 220, 255, 255}, {0, 0, 255, 0}};
  for (int i = 0; i < 10; ++i) map.at<cv::Vec4b>(0, i) = colours[i];
  media::write_picture(file("way.png"), map);
  const cv::Mat way = read_orientation_map(file("way.png"), {10, 1});
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(way.at<cv::Vec2f>(0, i)[0], std::cos(i * CV_PI / 3), 1e-5);
    EXPECT_NEAR(way.at<cv::Vec2f>(0, i)[1], -std::sin(i * CV_PI / 3), 1e-5);
  }
  for (int i = 6; i < 10; ++i) EXPECT_EQ(way.at<cv::Vec2f>(0, i), cv::Vec2f(0, 0)) << i;
}

TEST_F(MotionMaps, GreyIsSpeedAndTransparencyAsksNothing) {
  cv::Mat map(1, 3, CV_8UC4);
  map.at<cv::Vec4b>(0, 0) = {0, 0, 0, 255};
  map.at<cv::Vec4b>(0, 1) = {51, 51, 51, 255};
  map.at<cv::Vec4b>(0, 2) = {255, 255, 255, 0};
  media::write_picture(file("speed.png"), map);
  const cv::Mat speed = read_speed_map(file("speed.png"), {3, 1}, 100);
  EXPECT_EQ(speed.at<float>(0, 0), 0);
  EXPECT_NEAR(speed.at<float>(0, 1), 20, 1e-4);
  EXPECT_LT(speed.at<float>(0, 2), 0);
  media::write_picture(file("grey.png"), cv::Mat(1, 3, CV_8U, cv::Scalar(255)));
  EXPECT_NEAR(read_speed_map(file("grey.png"), {3, 1}, 100).at<float>(0, 1), 100, 1e-4);
  std::vector<std::string> notices;
  media::write_picture(file("red.png"), cv::Mat(1, 3, CV_8UC3, cv::Scalar(0, 0, 255)));
  read_speed_map(file("red.png"), {3, 1}, 100, &notices);
  EXPECT_EQ(notices, std::vector<std::string>{"colour reduced to grey"});
}

TEST_F(MotionMaps, CutOffWhatIsFasterThanWhiteAndSayHowMuch) {
  EXPECT_NEAR(write_speed_map(file("speed.png"), some_motion(), whole(), 60), 0.5, 0.01);
  EXPECT_NEAR(read_speed_map(file("speed.png"), kPicture, 60).at<float>(40, 119), 60, 0.01);
}

TEST_F(MotionMaps, RefuseWhatDoesNotFit) {
  write_speed_map(file("speed.png"), some_motion(), whole(), 255);
  const auto speed = [&](const char* name, cv::Size size = kPicture, double white = 255) {
    return [this, name, size, white] { read_speed_map(file(name), size, white); };
  };
  EXPECT_NE(fault(speed("speed.png", {121, 80})).find("the speed map is 120 x 80, the picture 121 x 80"),
            std::string::npos);
  EXPECT_NE(fault(speed("none.png")).find("no such file"), std::string::npos);
  EXPECT_NE(fault(speed("speed.png", kPicture, 0), ErrorKind::kUsage).find("not above 0"), std::string::npos);
  media::write_picture(file("clear.png"), cv::Mat(kPicture, CV_8UC4, cv::Scalar::all(0)));
  EXPECT_NE(fault(speed("clear.png")).find("transparent everywhere"), std::string::npos);
  media::write_picture(file("grey.png"), cv::Mat(kPicture, CV_8UC3, cv::Scalar::all(90)));
  EXPECT_NE(fault([&] { read_orientation_map(file("grey.png"), kPicture); }).find("no colour anywhere"),
            std::string::npos);
  EXPECT_NE(fault([&] { write_speed_map(file("speed.jpg"), some_motion(), whole(), 255); }, ErrorKind::kUsage)
                .find(".png"),
            std::string::npos);
}

}  // namespace
}  // namespace freshet::hints
