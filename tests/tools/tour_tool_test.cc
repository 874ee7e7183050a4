// freshet synth tour: a camera through a film, and what it answers to bad input.

#include <gtest/gtest.h>

#include <filesystem>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

class TourTool : public testing::Test {
 protected:
  TourTool() {
    fs::create_directory(folder_ / "film");
    for (int i = 0; i < 4; ++i) {
      cv::Mat frame(72, 96, CV_8UC3);
      cv::RNG(9).fill(frame, cv::RNG::UNIFORM, 0, 200);
      cv::GaussianBlur(frame, frame, {}, 1.5);
      cv::imwrite(folder_ / ("film/" + std::to_string(i) + ".png"), frame + cv::Scalar::all(10 * i));
    }
    cv::Mat boat(72, 96, CV_8U, cv::Scalar(0));
    cv::rectangle(boat, cv::Rect(40, 25, 20, 30), 255, cv::FILLED);
    cv::imwrite(folder_ / "boat.png", boat);
    folder_.file("tour.toml",
                 "horizon = 24\n[[key]]\ntime = 0\n[[key]]\ntime = 0.2\nposition = [0.3, 0.1, 0.6]\n"
                 "[[thing]]\nname = \"boat\"\nmatte = \"boat.png\"\n");
  }
  Outcome tour(std::vector<std::string> more) const {
    more.insert(more.begin(), {"synth", "tour", "film"});
    return folder_.freshet(more);
  }
  void refuses(const Outcome& outcome, const std::vector<std::string>& words) const {
    EXPECT_NE(outcome.exit_code, 0);
    for (const std::string& word : words) EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  }
  const WorkFolder folder_;
};

TEST_F(TourTool, GoesThroughAFilmAndWritesItsDepth) {
  const Outcome made = tour({"tour.toml", "-o", "out/%03d.png", "--depth-out", "depth/%03d.exr", "--json",
                             "--draw", "drawn.png", "--sheet", "sheet.png"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const nlohmann::json report = nlohmann::json::parse(made.out);
  EXPECT_EQ(report["frames"], 6);
  EXPECT_EQ(report["keys"].size(), 2U);
  EXPECT_NEAR(report["nearest_floor"], 2, 0.01);
  EXPECT_EQ(read_frames(folder_ / "out").size(), 6U);
  EXPECT_TRUE(fs::exists(folder_ / "depth/005.exr"));
  for (const char* name : {"drawn.png", "sheet.png"})
    EXPECT_FALSE(cv::imread(folder_ / name).empty()) << name;
  // A part of it is the same as in the whole.
  ASSERT_EQ(tour({"tour.toml", "-o", "part/%03d.png", "--range", "4-5"}).exit_code, 0);
  EXPECT_EQ(cv::norm(read_frames(folder_ / "out")[5], read_frames(folder_ / "part")[1], cv::NORM_INF), 0);
  // And with one thread.
  ASSERT_EQ(tour({"tour.toml", "-o", "one/%03d.png", "-j", "1"}).exit_code, 0);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(cv::norm(read_frames(folder_ / "out")[i], read_frames(folder_ / "one")[i], cv::NORM_INF), 0);
}

TEST_F(TourTool, EveryMoveNeedsNoFile) {
  for (const char* move : {"in", "pan", "truck", "rise", "orbit"}) {
    const Outcome made =
        tour({"--move", move, "--horizon", "24", "-o", std::string(move) + "/%03d.png", "--frames", "4"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const std::vector<cv::Mat> frames = read_frames(folder_ / move);
    EXPECT_GT(cv::norm(frames[0], frames[2], cv::NORM_L1) / static_cast<double>(frames[0].total()), 6)
        << move;
  }
}

TEST_F(TourTool, SaysWhatIsWrong) {
  refuses(tour({}), {"--output"});
  refuses(folder_.freshet({"synth", "tour"}), {"FILM"});
  refuses(tour({"gone.toml", "-o", "out/%03d.png"}), {"gone.toml"});
  refuses(tour({"tour.toml", "--move", "in", "-o", "out/%03d.png"}), {"--move in", "keys"});
  refuses(tour({"tour.toml", "--amount", "2", "-o", "out/%03d.png"}), {"--amount", "keys"});
  refuses(tour({"--depth-out", "depth.exr", "-o", "out/%03d.png"}), {"--depth-out depth.exr", "sequence"});
  refuses(tour({"--size", "12", "-o", "out/%03d.png"}), {"--size", "WIDTHxHEIGHT"});
  refuses(tour({"--size", "99999x2", "-o", "out/%03d.png"}), {"99999x2", "16384"});
  refuses(tour({"--horizon", "90", "-o", "out/%03d.png"}), {"horizon", "row 90", "72 rows"});
  refuses(tour({"--horizon", "nan", "-o", "out/%03d.png"}), {"--horizon nan"});
  folder_.file("share.toml", "relative = true\n");
  refuses(tour({"share.toml", "--horizon", "20", "-o", "out/%03d.png"}), {"--horizon", "relative"});
}

}  // namespace
}  // namespace freshet::tools
