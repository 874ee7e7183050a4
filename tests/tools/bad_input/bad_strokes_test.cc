// Strokes and maps of motion: those that work, and those that are unfit.

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

std::string strokes(const std::string& list) {
  return R"({"format": "freshet-strokes", "version": 1, "strokes": [)" + list + "]}";
}

class BadStrokes : public testing::Test {
 protected:
  Outcome label(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"query",   "label",        sample().store, sample().still,
                                       "--matte", sample().matte, "--frames",     "16"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder_.freshet(arguments);
  }
  void expect_failure(std::vector<std::string> more, int exit_code,
                      std::initializer_list<const char*> parts) const {
    const Outcome outcome = label(std::move(more));
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.find("reading the index"), std::string::npos) << "said before the work";
    for (const char* part : parts)
      EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\n" << outcome.err;
  }

  WorkFolder folder_;
};

TEST_F(BadStrokes, OnesBesideTheFluidAreSaid) {
  cv::Mat matte = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE);
  matte.colRange(0, 40).setTo(0);
  cv::imwrite(folder_ / "part.png", matte);
  folder_.file("two.json", strokes(R"({"points": [[10, 20], [12, 120]], "name": "left"},
                                      {"points": [[90, 20], [90, 120]], "name": "middle"})"));
  const Outcome outcome = folder_.freshet({"query", "label", sample().store, sample().still, "--matte",
                                           "part.png", "--frames", "16", "--strokes", "two.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("\"left\" lies wholly outside the matte"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("\"middle\" lies"), std::string::npos) << outcome.err;
}

TEST_F(BadStrokes, GoodOnesAreHonouredDrawnAndComeBackAsMaps) {
  folder_.file("down.svg", "<svg viewBox='0 0 192 144'><path data-speed='60' d='M90 20q4 50 0 100'/></svg>");
  const Outcome drawn = label({"--strokes", "down.svg", "--direction", "right", "--draw", "arrows.png",
                               "--speed-out", "speed.png", "--orientation-out", "way.png"});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_NE(drawn.err.find("--direction has no effect"), std::string::npos) << drawn.err;
  EXPECT_NE(drawn.out.find("arrows.png"), std::string::npos) << drawn.out;
  EXPECT_EQ(cv::imread(folder_ / "arrows.png").size(), cv::Size(kWidth, kHeight));
  const cv::Mat speed = cv::imread(folder_ / "speed.png", cv::IMREAD_UNCHANGED),
                way = cv::imread(folder_ / "way.png", cv::IMREAD_UNCHANGED);
  EXPECT_EQ(speed.type(), CV_16UC4);
  ASSERT_EQ(way.type(), CV_16UC3);
  // The sample's waterfalls go down: hue 270, more blue than red, and no green.
  const cv::Mat matte = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE) > 127;
  const cv::Scalar mean = cv::mean(way, matte);
  EXPECT_GT(mean[0], 1.3 * mean[2]);
  EXPECT_GT(mean[2], 2 * mean[1]);

  const Outcome again = label({"--orientation-map", "way.png", "--speed-map", "speed.png"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  const Outcome animated = folder_.freshet({"synth", "animate", sample().store, sample().still, "--matte",
                                            sample().matte, "--frames", "4", "-o", "out.mkv", "--strokes",
                                            "down.svg", "--speed-out", "speed2.png"});
  EXPECT_EQ(animated.exit_code, 0) << animated.err;
  EXPECT_TRUE(fs::exists(folder_ / "speed2.png"));
  const Outcome candidates = folder_.freshet({"query", "candidates", sample().store, sample().still,
                                              "--frames", "16", "--strokes", "down.svg", "--draw", "c.png"});
  EXPECT_EQ(candidates.exit_code, 0) << candidates.err;
  EXPECT_TRUE(fs::exists(folder_ / "c.png"));
}

TEST_F(BadStrokes, StrokesThatSayNothing) {
  folder_.file("none.json", strokes(""));
  folder_.file("dot.json", strokes(R"({"points": [[20, 30], [20, 30]]})"));
  folder_.file("far.json",
               strokes(R"({"points": [[20, 30], [60, 30]]}, {"points": [[900, 30], [950, 30]]})"));
  folder_.file("text.json", "down, please");
  folder_.file("page.svg", "<svg width='210mm' height='297mm'><path d='M0 0h9'/></svg>");
  folder_.file("path.svg", "<svg><path id='p1' d='M0 0L9'/></svg>");
  expect_failure({"--strokes", "missing.json"}, 1, {"missing.json: there is no such file"});
  expect_failure({"--strokes", "text.json"}, 1, {"text.json: neither JSON nor SVG"});
  expect_failure({"--strokes", "none.json"}, 1, {"none.json: no stroke in it", "Draw at least one"});
  expect_failure({"--strokes", "dot.json"}, 1, {"dot.json: stroke 1 at (20, 30) has no length"});
  expect_failure({"--strokes", "far.json"}, 1,
                 {"far.json: stroke 2 lies outside the picture", "x 900 to 950", "192 x 144 px"});
  expect_failure({"--strokes", "page.svg"}, 1, {"page.svg: its page is", "other proportions", "192 x 144"});
  expect_failure({"--strokes", "path.svg"}, 1, {"path.svg: d of path \"p1\"", "number is expected"});
}

TEST_F(BadStrokes, MapsThatDoNotFit) {
  cv::imwrite(folder_ / "small.png", cv::Mat(60, 80, CV_8UC3, cv::Scalar(0, 0, 255)));
  cv::imwrite(folder_ / "grey.png", cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(90)));
  cv::imwrite(folder_ / "clear.png", cv::Mat(kHeight, kWidth, CV_8UC4, cv::Scalar::all(0)));
  folder_.file("text.png", "No picture.\n");
  expect_failure({"--speed-map", "small.png"}, 1,
                 {"small.png: the speed map is 80 x 60, the picture 192 x 144"});
  expect_failure({"--orientation-map", "small.png"}, 1, {"small.png: the orientation map is 80 x 60"});
  expect_failure({"--orientation-map", "grey.png"}, 1,
                 {"grey.png: the orientation map has no colour anywhere"});
  expect_failure({"--speed-map", "clear.png"}, 1, {"clear.png: the speed map is transparent everywhere"});
  expect_failure({"--speed-map", "text.png"}, 1, {"text.png: not a picture"});
}

TEST_F(BadStrokes, OptionsThatCannotBe) {
  folder_.file("none", "");
  folder_.file("down.json", strokes(R"({"points": [[80, 20], [80, 120]]})"));
  cv::imwrite(folder_ / "red.png", cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(0, 0, 255)));
  expect_failure({"--strokes", "down.json", "--orientation-map", "red.png"}, 2, {"excludes"});
  expect_failure({"--speed-map", "red.png", "--speed-white", "0"}, 2, {"--speed-white"});
  expect_failure({"--strokes", "down.json", "--speed-tolerance", "0.5"}, 2, {"--speed-tolerance"});
  expect_failure({"--speed-out", "speed.jpg"}, 2, {"speed.jpg: a map needs a format that keeps 16 bits"});
  expect_failure({"--orientation-out", "none/a.png"}, 1, {"the folder none cannot be made"});
  expect_failure({"--draw", "none/a.png"}, 1, {"the folder none cannot be made"});
  const Outcome nothing = folder_.freshet(
      {"query", "candidates", sample().store, sample().still, "--hint", "none", "--draw", "a.png"});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_NE(nothing.err.find("no motion is asked"), std::string::npos) << nothing.err;
}

}  // namespace
}  // namespace freshet::tools
