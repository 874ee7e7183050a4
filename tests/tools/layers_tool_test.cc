// freshet synth layers from end to end: a scene in, its layers as paint out, and taken back by the scene.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

class LayersTool : public testing::Test {
 protected:
  LayersTool() {
    cv::Mat picture(90, 120, CV_8UC3, cv::Scalar(150, 110, 60)), noise(90, 120, CV_8UC3);
    cv::RNG random(3);
    random.fill(noise, cv::RNG::UNIFORM, 0, 40);
    cv::Mat matte = cv::Mat::zeros(90, 120, CV_8U);
    cv::circle(matte, {60, 45}, 20, cv::Scalar(255), cv::FILLED);
    picture.setTo(cv::Scalar(40, 60, 190), matte);
    picture += noise;
    cv::GaussianBlur(picture, picture, {}, 1);
    cv::imwrite(folder_ / "still.png", picture);
    cv::imwrite(folder_ / "ball.png", matte);
    write_scene("");
  }
  void write_scene(const std::string& more) const {
    std::ofstream(folder_ / "s.toml")
        << "picture = \"still.png\"\nframes = 1\n"
        << more
        << "[[layer]]\nname = \"ball\"\nmatte = \"ball.png\"\nmotion = \"still\"\n"
           "[[layer]]\nname = \"wall\"\nmatte = \"rest\"\nmotion = \"still\"\n";
  }
  WorkFolder folder_;
};

TEST_F(LayersTool, LayersGoOutAsPaintAndComeBackIntoTheScene) {
  const Outcome cut =
      folder_.freshet({"synth", "layers", "s.toml", "-o", "l.ora", "--uncover", "12", "--json"});
  ASSERT_EQ(cut.exit_code, 0) << cut.err;
  const nlohmann::json said = nlohmann::json::parse(cut.out);
  ASSERT_EQ(said["layers"].size(), 2u);
  EXPECT_EQ(said["layers"][0]["name"], "ball");
  EXPECT_GT(said["layers"][1]["filled_px"], 1000);
  EXPECT_LE(said["error_levels"], 1.0);

  write_scene("cut = \"l.ora\"\n");
  const Outcome moved = folder_.freshet({"synth", "scene", "s.toml", "-o", "f.####.png"});
  ASSERT_EQ(moved.exit_code, 0) << moved.err;
  const cv::Mat frame = cv::imread(folder_ / "f.0000.png"), still = cv::imread(folder_ / "still.png");
  ASSERT_EQ(frame.size(), still.size());
  EXPECT_LE(cv::norm(frame, still, cv::NORM_INF), 1);
}

TEST_F(LayersTool, FaultsNameFileAndRemedyAndLeaveNothing) {
  const Outcome ending = folder_.freshet({"synth", "layers", "s.toml", "-o", "l.psd"});
  EXPECT_EQ(ending.exit_code, 2);
  EXPECT_NE(ending.err.find("LAYERS.ora"), std::string::npos) << ending.err;

  ASSERT_EQ(folder_.freshet({"synth", "layers", "s.toml", "-o", "l.ora"}).exit_code, 0);
  std::filesystem::resize_file(folder_ / "l.ora", std::filesystem::file_size(folder_ / "l.ora") / 2);
  write_scene("cut = \"l.ora\"\n");
  const Outcome moved = folder_.freshet({"synth", "scene", "s.toml", "-o", "f.####.png"});
  EXPECT_EQ(moved.exit_code, 1);
  EXPECT_NE(moved.err.find("l.ora: not a whole zip archive"), std::string::npos) << moved.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "f.0000.png"));

  write_scene("");
  cv::imwrite(folder_ / "ball.png", cv::Mat(90, 60, CV_8U, cv::Scalar(0)));
  const Outcome matte = folder_.freshet({"synth", "layers", "s.toml", "-o", "other.ora"});
  EXPECT_EQ(matte.exit_code, 1);
  EXPECT_NE(matte.err.find("ball.png"), std::string::npos) << matte.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other.ora"));
}

}  // namespace
}  // namespace freshet::tools
