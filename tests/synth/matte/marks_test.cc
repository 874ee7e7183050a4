// Scribbles as people draw them, and boxes.

#include "synth/matte/marks.h"
#include "tests/harness/scratch_folder.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/synth/matte/made_picture.h"

namespace freshet::synth::matte {
namespace {

constexpr int kRows = 60, kCols = 80;
const cv::Rect kOne(10, 10, 8, 5), kTwo(40, 10, 8, 5), kThree(10, 40, 8, 5), kFour(40, 40, 8, 5);

cv::Mat picture() {
  cv::Mat out(kRows, kCols, CV_8UC3);
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kCols; ++x)
      out.at<cv::Vec3b>(y, x) = x < 30 ? cv::Vec3b(0, 0, 0) : cv::Vec3b(60 + y, 100 + x, 90);
  return out;
}

/// White and green in the first and second place, black and red in the third and fourth.
void draw(cv::Mat& on) {
  on(kOne).setTo(cv::Scalar(255, 255, 255, 255));
  on(kTwo).setTo(cv::Scalar(0, 255, 0, 255));
  on(kThree).setTo(cv::Scalar(0, 0, 0, 255));
  on(kFour).setTo(cv::Scalar(0, 0, 255, 255));
}

Marks expected() {
  Marks marks(kRows, kCols, CV_8U, cv::Scalar(kUnknown));
  for (const cv::Rect& place : {kOne, kTwo}) marks(place).setTo(kFluid);
  for (const cv::Rect& place : {kThree, kFour}) marks(place).setTo(kBackground);
  return marks;
}

int differing(const Marks& a, const Marks& b) { return cv::countNonZero(a != b); }

TEST(Scribbles, OnATransparentGround) {
  const ScratchFolder folder;
  cv::Mat drawn(kRows, kCols, CV_8UC4, cv::Scalar(255, 255, 255, 0));
  draw(drawn);
  EXPECT_EQ(differing(read_scribbles(written(folder, "s.png", drawn), picture()), expected()), 0);
}

TEST(Scribbles, OnGrey) {
  const ScratchFolder folder;
  cv::Mat drawn(kRows, kCols, CV_8UC3, cv::Scalar::all(128));
  draw(drawn);
  EXPECT_EQ(differing(read_scribbles(written(folder, "s.png", drawn), picture()), expected()), 0);
}

// The picture's own black is no stroke, and a black stroke over it cannot be told from it.
TEST(Scribbles, PaintedOverThePicture) {
  const ScratchFolder folder;
  cv::Mat drawn = picture();
  draw(drawn);
  std::vector<std::string> notices;
  Marks wanted = expected();
  wanted(kThree).setTo(kUnknown);
  EXPECT_EQ(differing(read_scribbles(written(folder, "s.png", drawn), picture(), &notices), wanted), 0);
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_NE(notices[0].find("painted over the picture"), std::string::npos);
}

// A whole matte in black and white is one, even over a picture that is black and white too.
TEST(Scribbles, ATrimapOfTwoColours) {
  const ScratchFolder folder;
  cv::Mat drawn(kRows, kCols, CV_8UC3, cv::Scalar::all(0));
  drawn(kOne).setTo(cv::Scalar::all(255));
  const Marks marks = read_scribbles(written(folder, "s.png", drawn), picture());
  EXPECT_EQ(cv::countNonZero(marks == kFluid), kOne.area());
  EXPECT_EQ(cv::countNonZero(marks == kBackground), kRows * kCols - kOne.area());
}

TEST(Scribbles, BadOnesSayWhatToDo) {
  const ScratchFolder folder;
  const auto answer = [&](const std::filesystem::path& path) {
    return fault_of(ErrorKind::kInput, [&] { read_scribbles(path, picture()); });
  };
  const std::string small =
      answer(written(folder, "small.png", cv::Mat(30, 40, CV_8UC3, cv::Scalar::all(255))));
  EXPECT_NE(small.find("small.png: the scribbles are 40 x 30 px, the picture 80 x 60"), std::string::npos)
      << small;
  for (const std::string& empty :
       {answer(written(folder, "clear.png", cv::Mat(kRows, kCols, CV_8UC4, cv::Scalar(255, 255, 255, 0)))),
        answer(written(folder, "grey.png", cv::Mat(kRows, kCols, CV_8UC3, cv::Scalar::all(128)))),
        answer(written(folder, "same.png", picture()))}) {
    EXPECT_NE(empty.find("no stroke in it"), std::string::npos) << empty;
    EXPECT_NE(empty.find("white or green where the fluid is"), std::string::npos) << empty;
  }
  EXPECT_NE(answer(folder / "missing.png").find("no such file"), std::string::npos);
  EXPECT_NE(answer(folder.file("text.png", "no picture")).find("not a picture"), std::string::npos);
}

TEST(KeepWithin, MarksWhatIsOutsideOfAllBoxesAndUnknown) {
  Marks marks(kRows, kCols, CV_8U, cv::Scalar(kUnknown));
  marks(kFour).setTo(kFluid);
  keep_within(marks, {{10, 10, 8, 5}, {-5, 40, 23, 5}}, "--box");
  EXPECT_EQ(cv::countNonZero(marks == kUnknown), 8 * 5 + 18 * 5);
  EXPECT_EQ(cv::countNonZero(marks == kFluid), kFour.area());
  EXPECT_EQ(marks.at<std::uint8_t>(42, 5), kUnknown);
}

TEST(KeepWithin, ABoxOutsideOrWithoutAreaIsRefused) {
  Marks marks(kRows, kCols, CV_8U, cv::Scalar(kUnknown));
  for (const cv::Rect2d& box :
       {cv::Rect2d(100, 0, 10, 10), cv::Rect2d(0, 0, 0, 10), cv::Rect2d(5, 5, -3, 4)}) {
    const std::string said = fault_of(ErrorKind::kUsage, [&] { keep_within(marks, {box}, "--box"); });
    EXPECT_NE(said.find("--box: the box"), std::string::npos) << said;
    EXPECT_NE(said.find("has no area in the picture of 80 x 60 px"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace freshet::synth::matte
