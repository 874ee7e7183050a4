#include "synth/flowlines/files/line_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "freshet/error.h"

namespace freshet::synth::flowlines {
namespace {

class LineFiles : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& paths) const {
    std::ofstream(file_) << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100\" height=\"80\">" << paths
                         << "</svg>";
    return file_;
  }
  std::string fault(const std::string& paths) const {
    try {
      read_lines(write(paths), {100, 80}, 10);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  void TearDown() override { std::filesystem::remove(file_); }
  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("lines_" + std::to_string(::getpid()) + ".svg");
};

TEST_F(LineFiles, KeepNamesPlacesAndSpeeds) {
  const std::vector<FlowLine> lines = read_lines(
      write("<path id=\"fall\" d=\"M20.5,10.5 V60.5\" data-speed=\"2\"/><path d=\"M40.5,10.5 V60.5\"/>"),
      {100, 80}, 10);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].name, "fall");
  EXPECT_EQ(lines[0].speed, 2);
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

TEST_F(LineFiles, SayWhatIsWrongWithALine) {
  EXPECT_NE(fault("<path id=\"a\" d=\"M50,40 H140 V60 H50\"/>").find("comes back"), std::string::npos);
  EXPECT_NE(fault("<path id=\"a\" d=\"M50,40 V44\"/>").find("long"), std::string::npos);
  EXPECT_NE(fault("<path id=\"a\" d=\"M50,10 V60\"/><path id=\"a\" d=\"M20,10 V60\"/>").find("two lines"),
            std::string::npos);
}

}  // namespace
}  // namespace freshet::synth::flowlines
