#include "synth/flowlines/files/line_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "freshet/error.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::synth::flowlines {
namespace {

class LineFiles : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& paths) const {
    return folder_.file(
        "lines.svg",
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100\" height=\"80\">" + paths + "</svg>");
  }
  std::string fault(const std::string& paths) const {
    return fault_of([&] { read_lines(write(paths), {100, 80}, 10); });
  }
  const ScratchFolder folder_;
  const std::filesystem::path file_ = folder_ / "lines.svg";
};

TEST_F(LineFiles, KeepNamesPlacesAndSpeeds) {
  const std::vector<FlowLine> lines = read_lines(
      write("<path id=\"fall\" d=\"M20.5,10.5 V60.5\" data-speed=\"2\"/><path d=\"M40.5,10.5 V60.5\"/>"),
      {100, 80}, 10);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].name, "fall");
  EXPECT_EQ(lines[0].speeds, std::vector<float>{2});
  EXPECT_EQ(lines[1].name, "line 2");
  EXPECT_NEAR(lines[0].points.front().x, 20, 1e-4);
  EXPECT_NEAR(lines[0].points.front().y, 10, 1e-4);
  EXPECT_NEAR(lines[0].length(), 50, 1.01);
  write_lines(file_, lines, {100, 80});
  const std::vector<FlowLine> again = read_lines(file_, {100, 80}, 10);
  ASSERT_EQ(again.size(), 2u);
  EXPECT_LT(cv::norm(again[0].points.back() - lines[0].points.back()), 1.01);
}

TEST_F(LineFiles, EndsBeyondTheBorderAreCutOffAndSaid) {
  std::vector<std::string> notices;
  const std::vector<FlowLine> lines =
      read_lines(write("<path id=\"a\" d=\"M50,40 V140\"/>"), {100, 80}, 10, &notices);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_LE(lines[0].points.back().y, 80.5f);
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_NE(notices[0].find("leaves the picture"), std::string::npos);
}

TEST_F(LineFiles, HaveSpeedsAlongThemAndPositionsInTime) {
  const std::vector<FlowLine> lines =
      read_lines(write("<path id=\"a\" d=\"M20,10 V60\" data-speed=\"1 2 .5\"/>"
                       "<g data-time=\"0\"><path id=\"b\" d=\"M40,10 V60\"/></g>"
                       "<g data-time=\"2.5s\"><path id=\"path7\" data-of=\"b\" d=\"M60,10 V60\"/></g>"
                       "<path id=\"c\" d=\"M80,10 V60\"><animate attributeName=\"d\" dur=\"4s\" "
                       "values=\"M80,10 V60; M90,10 V60\"/></path>"),
                 {100, 80}, 10);
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0].speeds, (std::vector<float>{1, 2, 0.5f}));
  EXPECT_FLOAT_EQ(speed_at(lines[0], 0), 1);
  EXPECT_NEAR(speed_at(lines[0], 0.75f * lines[0].length()), 1.25, 1e-3);
  EXPECT_EQ(lines[0].time_s, std::nullopt);
  EXPECT_EQ(lines[1].time_s, 0);
  EXPECT_EQ(lines[2].time_s, 2.5f);
  EXPECT_EQ(lines[2].name, "b");
  EXPECT_EQ(lines[3].name, "c");
  EXPECT_EQ(lines[4].name, "c");
  EXPECT_EQ(lines[4].time_s, 4);
  EXPECT_NEAR(lines[4].points.front().x, 89.5, 1e-3);
}

TEST_F(LineFiles, SayWhatIsWrongWithSpeedsAndTimes) {
  EXPECT_NE(fault("<path id=\"a\" d=\"M50,10 V60\" data-speed=\"1 0\"/>").find("speed is 0"),
            std::string::npos);
  EXPECT_NE(fault("<path id=\"a\" d=\"M50,10 V60\" data-speed=\"1 fast\"/>").find("number"),
            std::string::npos);
  EXPECT_NE(fault("<path id=\"a\" d=\"M50,10 V60\" data-time=\"soon\"/>").find("data-time of path \"a\""),
            std::string::npos);
  EXPECT_NE(fault("<path id=\"a\" d=\"M50,10 V60\"><animate attributeName=\"d\" dur=\"2s\" "
                  "values=\"M50,10 V60\"/></path>")
                .find("1 positions"),
            std::string::npos);
  EXPECT_NE(
      fault("<path id=\"a\" d=\"M50,10 V60\"><animate attributeName=\"d\" values=\"M50,10 V60;M5,5 V60\"/>"
            "</path>")
          .find("animate"),
      std::string::npos);
}

TEST_F(LineFiles, SayWhatIsWrongWithALine) {
  EXPECT_NE(fault("<path id=\"a\" d=\"M50,40 H140 V60 H50\"/>").find("comes back"), std::string::npos);
  EXPECT_NE(fault("<path id=\"a\" d=\"M50,40 V44\"/>").find("long"), std::string::npos);
  EXPECT_NE(fault("<path id=\"a\" d=\"M50,10 V60\"/><path id=\"a\" d=\"M20,10 V60\"/>").find("two lines"),
            std::string::npos);
}

}  // namespace
}  // namespace freshet::synth::flowlines
