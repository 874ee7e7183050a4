#include "bench/kind/outlines.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "synth/simulate/simulate.h"

namespace freshet::bench {
namespace {

namespace fs = std::filesystem;

class Outlines : public testing::Test {
 protected:
  std::vector<Outlined> read(const std::string& text) {
    std::ofstream(file_) << text;
    return read_outlines(file_);
  }
  ~Outlines() override { fs::remove(file_); }

 private:
  fs::path file_ = fs::temp_directory_path() /
                   (std::string("outlines_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(Outlines, SayClassFramesAndMatte) {
  const std::vector<Outlined> lines =
      read("# a remark\n\nwater/smoke plume a/b.mp4@5,70 0,0 50,0 50,100 0,100; 10,40 30,40 30,60 10,60\n");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].classes, (std::vector<std::string>{"water", "smoke"}));
  EXPECT_EQ(lines[0].file, "a/b.mp4");
  EXPECT_EQ(lines[0].percents, (std::vector<int>{5, 70}));
  const cv::Mat matte = lines[0].matte({100, 100});
  EXPECT_EQ(matte.at<std::uint8_t>(20, 20), 255);
  EXPECT_EQ(matte.at<std::uint8_t>(50, 20), 0);  // a hole
  EXPECT_EQ(matte.at<std::uint8_t>(50, 80), 0);
}

TEST_F(Outlines, NameTheLineThatTheyCannotRead) {
  for (const char* const line :
       {"water falls", "water falls a.mp4", "water falls a.mp4 1,2 3,4", "water falls a.mp4 1,2 3,4 5",
        "water falls a.mp4 1,2 3,4 5,101", "water falls a.mp4@x all"}) {
    try {
      read(std::string("\n") + line);
      ADD_FAILURE() << line;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("line 2"), std::string::npos) << error.what();
    }
  }
}

TEST_F(Outlines, TakeTheMatteOfASimulatedClip) {
  const std::vector<Outlined> lines = read("water falls simulated/waterfall/5 alpha");
  EXPECT_EQ(lines[0].scene(), "simulated/waterfall");
  const std::vector<Still> stills = stills_of(lines[0], "", 640);
  ASSERT_EQ(stills.size(), 1u);
  synth::simulate::Simulation clip(
      {.kind = synth::simulate::SceneKind::kWaterfall, .size = {320, 240}, .frames = 1, .seed = 5});
  synth::simulate::SimulatedFrame frame;
  clip.next(frame);
  EXPECT_EQ(cv::norm(stills[0].picture, frame.picture, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(stills[0].matte, frame.alpha, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::bench
