// Marks from JSON.

#include <gtest/gtest.h>

#include "tests/harness/scratch_folder.h"
#include "tests/synth/matte/made_picture.h"

namespace freshet::synth::matte {
namespace {

const cv::Size kSize(80, 60);

std::string file_of(const std::string& marks) {
  return R"({"format": "freshet-marks", "version": 1, "marks": [)" + marks + "]}";
}

TEST(MarkFile, LinesDotsAndBoxes) {
  const ScratchFolder folder;
  const Marks marks = read_marks(
      folder.file("m.json", file_of(R"({"is": "fluid", "points": [[20.5, 10.5], [40.5, 10.5]], "width": 3},
                                        {"is": "fluid", "points": [[30.5, 30.5]], "width": 5},
                                        {"is": "background", "box": [60, 0, 5, 60]},
                                        {"is": "within", "box": [10, 0, 70, 60]})")),
      kSize);
  EXPECT_EQ(marks.size(), kSize);
  for (int y = 9; y <= 11; ++y) EXPECT_EQ(marks.at<std::uint8_t>(y, 30), kFluid) << y;
  EXPECT_EQ(marks.at<std::uint8_t>(13, 30), kUnknown);
  EXPECT_EQ(marks.at<std::uint8_t>(7, 30), kUnknown);
  EXPECT_EQ(marks.at<std::uint8_t>(30, 32), kFluid);
  EXPECT_EQ(marks.at<std::uint8_t>(30, 35), kUnknown);
  EXPECT_EQ(cv::countNonZero(marks == kBackground), 5 * 60 + 10 * 60);
}

TEST(MarkFile, BadOnesSayWhichMarkAndWhatIsExpected) {
  const ScratchFolder folder;
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "no mark in it"},
      {R"({"is": "sea", "points": [[1, 1]]})", "mark 1: \"is\" is none of fluid, background, within"},
      {R"({"is": "fluid", "points": [[1, 1]]}, {"is": "fluid"})", "mark 2: \"box\" or \"points\" expected"},
      {R"({"is": "within", "points": [[1, 1]]})", "mark 1: \"box\" or \"points\" expected"},
      {R"({"is": "fluid", "points": []})", "mark 1: \"points\" is not a list"},
      {R"({"is": "fluid", "points": [[1]]})", "mark 1: a point is two numbers"},
      {R"({"is": "fluid", "points": [[1, 1e300]]})", "mark 1: a point is two numbers"},
      {R"({"is": "fluid", "points": [[1, 1]], "width": -2})", "mark 1: \"width\" is not 0 to 1000 px"},
      {R"({"is": "fluid", "points": [[500, 500]]})", "mark 1 lies outside the picture of 80 x 60 px"},
      {R"({"is": "fluid", "box": [1, 2, 3]})", "mark 1: a box is four numbers"},
      {R"({"is": "within", "box": [90, 0, 10, 10]})", "mark 1: its box has no area in the picture"},
      {"7", "mark 1 is not an object"}};
  for (const auto& [marks, message] : cases) {
    const auto path = folder.file("bad.json", file_of(marks));
    const std::string said = fault_of(ErrorKind::kInput, [&] { read_marks(path, kSize); });
    EXPECT_NE(said.find("bad.json: " + message), std::string::npos) << marks << "\n" << said;
    EXPECT_NE(said.find("Expected: {\"format\""), std::string::npos) << said;
  }
  const auto whole = [&](const std::string& text) {
    const auto path = folder.file("bad.json", text);
    return fault_of(ErrorKind::kInput, [&] { read_marks(path, kSize); });
  };
  EXPECT_NE(whole("{").find("not a JSON file"), std::string::npos);
  EXPECT_NE(whole("[]").find("\"format\" is not"), std::string::npos);
  EXPECT_NE(whole(R"({"format": "freshet-marks", "version": 2})").find("\"version\" is not 1"),
            std::string::npos);
  EXPECT_NE(whole(R"({"format": "freshet-marks", "version": 1})").find("\"marks\" is not a list"),
            std::string::npos);
  EXPECT_NE(
      fault_of(ErrorKind::kInput, [&] { read_marks(folder / "missing.json", kSize); }).find("no such file"),
      std::string::npos);
}

}  // namespace
}  // namespace freshet::synth::matte
