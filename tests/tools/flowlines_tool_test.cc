// freshet synth flowlines: a clip made endless and edited, and what it answers to bad input.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

cv::Mat blobs(cv::Size size, int seed) {
  cv::Mat out(size, CV_8UC3);
  cv::RNG random(static_cast<std::uint64_t>(seed));
  random.fill(out, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(out, out, {}, 2);
  out.convertTo(out, CV_8U, 5, -4 * 127);
  return out;
}

/// Water that goes down a channel by 3 px a frame between banks that stand still, as pictures in folders.
class FlowlinesTool : public testing::Test {
 protected:
  FlowlinesTool() {
    make("clip", 0, 3);
    make("pan", 2, 3);
    make("candle", 0, 0);
    folder_.file("lines.svg", svg("<path id=\"a\" d=\"M44,4 V92\"/><path id=\"b\" d=\"M64,4 V92\"/>"));
  }

  void make(const std::string& name, int camera, int flow) const {
    constexpr int kClipFrames = 40;
    const cv::Mat bank = blobs({300, 96}, 5), water = blobs({64, 96 + 3 * kClipFrames}, 9);
    fs::create_directory(folder_ / name);
    for (int t = 0; t < kClipFrames; ++t) {
      cv::Mat frame = bank(cv::Rect(90 - camera * t, 0, 128, 96)).clone();
      const cv::Mat shown = water(cv::Rect(0, 3 * kClipFrames - flow * t, 64, 96));
      if (flow > 0)
        shown.copyTo(frame(cv::Rect(32, 0, 64, 96)));
      else  // what flickers in its place
        cv::circle(frame, {64, 48}, 6 + t % 3, cv::Scalar::all(230 + 10 * (t % 3)), cv::FILLED);
      cv::imwrite(folder_ / (name + "/" + std::to_string(100 + t) + ".png"), frame);
    }
  }
  static std::string svg(const std::string& paths) {
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"128\" height=\"96\">" + paths + "</svg>";
  }
  Outcome flowlines(const std::string& clip, std::vector<std::string> more) const {
    std::vector<std::string> arguments{"synth", "flowlines", clip, "-o", "out/%03d.png"};
    if (std::ranges::find(more, "--frames") == more.end()) more.insert(more.end(), {"--frames", "6"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder_.freshet(arguments);
  }
  void refuses(const Outcome& outcome, const std::vector<std::string>& words) const {
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    for (const std::string& word : words) EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
    EXPECT_TRUE(!fs::exists(folder_ / "out") || fs::is_empty(folder_ / "out"));
  }
  const WorkFolder folder_;
};

TEST_F(FlowlinesTool, MakesAClipEndlessAndWritesItsLines) {
  const Outcome made = flowlines("clip", {"--json", "--lines-out", "found.svg", "--draw", "drawn.png"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const nlohmann::json report = nlohmann::json::parse(made.out);
  EXPECT_GT(report["lines"], 1);
  EXPECT_EQ(read_frames(folder_ / "out").size(), 6u);
  EXPECT_FALSE(cv::imread(folder_ / "drawn.png").empty());
  // What it writes can be given back, changed or not.
  EXPECT_EQ(flowlines("clip", {"--lines", "found.svg", "--edited", "found.svg", "--overwrite"}).exit_code, 0);
}

TEST_F(FlowlinesTool, RefusesLinesThatCannotBeRidden) {
  folder_.file("up.svg", svg("<path id=\"a\" d=\"M64,92 V4\"/>"));
  refuses(flowlines("clip", {"--lines", "up.svg"}), {"a", "flows against this line", "the other way round"});
  folder_.file("away.svg", svg("<path id=\"gone\" d=\"M64,4 V60 L200,60 L200,70 L64,70 V92\"/>"));
  refuses(flowlines("clip", {"--lines", "away.svg"}), {"gone", "picture"});
  folder_.file("alone.svg", svg("<path id=\"a\" d=\"M64,4 V92\"/><path id=\"c\" d=\"M80,4 V92\"/>"));
  refuses(flowlines("clip", {"--lines", "lines.svg", "--edited", "alone.svg"}),
          {"\"c\"", "\"a\"", "--lines-out"});
}

TEST_F(FlowlinesTool, CutsOffWhatOfALineLiesBesideThePicture) {
  folder_.file("over.svg", svg("<path id=\"a\" d=\"M64,4 V140\"/>"));
  const Outcome made = flowlines("clip", {"--lines", "over.svg"});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_NE(made.err.find("leaves the picture"), std::string::npos) << made.err;
}

TEST_F(FlowlinesTool, MovesLinesInTimeAndDrawsThem) {
  folder_.file("moving.svg",
               svg("<path id=\"a\" data-time=\"0\" d=\"M44,4 V92\"/><path id=\"b\" d=\"M64,4 V92\"/>"
                   "<path id=\"a\" data-time=\"0.2\" data-speed=\"1 2\" d=\"M30,4 V92\"/>"));
  const Outcome made =
      flowlines("clip", {"--lines", "lines.svg", "--edited", "moving.svg", "--draw", "drawn.png"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(cv::imread(folder_ / "drawn.png").size(), cv::Size(256, 96)) << "edited lines beside the others";
}

TEST_F(FlowlinesTool, RefusesPositionsThatMakeNoSense) {
  folder_.file("timed.svg", svg("<path id=\"a\" data-time=\"1\" d=\"M44,4 V92\"/>"));
  refuses(flowlines("clip", {"--lines", "timed.svg"}), {"a: ", "data-time", "edited lines"});
  folder_.file("late.svg", svg("<path id=\"a\" data-time=\"0\" d=\"M44,4 V92\"/>"
                               "<path id=\"a\" data-time=\"9\" d=\"M50,4 V92\"/>"));
  refuses(flowlines("clip", {"--lines", "lines.svg", "--edited", "late.svg", "--loop"}),
          {"late.svg", "\"a\"", "9 s", "the loop ends", "--frames"});
}

TEST_F(FlowlinesTool, SaysWhatIsWrongWithFilesAndNumbers) {
  folder_.file("empty.svg", svg(""));
  refuses(flowlines("clip", {"--lines", "empty.svg"}), {"empty.svg", "no stroke", "Draw"});
  cv::imwrite(folder_ / "narrow.png", cv::Mat(96, 64, CV_8U, cv::Scalar(255)));
  refuses(flowlines("clip", {"--matte", "narrow.png"}), {"narrow.png", "64 x 96", "128 x 96"});
  fs::create_directory(folder_ / "short");
  fs::copy_file(folder_ / "clip/100.png", folder_ / "short/100.png");
  refuses(flowlines("short", {}), {"short", "at least 16", "longer"});
  const auto usage = [&](const std::vector<std::string>& more, const std::vector<std::string>& words) {
    const Outcome outcome = flowlines("clip", more);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    for (const std::string& word : words) EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  };
  usage({"--entries", "39"}, {"--entries 39", "at most 30", "longer clip"});
  usage({"--frames", "0"}, {"--frames", "1 to 10000000"});
  usage({"--loop"}, {"--loop --frames 6", "Ask for"});
  usage({"--loop", "--frames", "10001"}, {"--loop --frames 10001", "10000", "without --loop"});
}

TEST_F(FlowlinesTool, RefusesClipsThatAreNoCaseForIt) {
  refuses(flowlines("pan", {}), {"the camera moves", "--moving-camera"});
  refuses(flowlines("candle", {}), {"nothing in it flows along lines", "--matte"});
}

}  // namespace
}  // namespace freshet::tools
