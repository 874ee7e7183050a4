#include "synth/flowlines/lines/moving_lines.h"

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "synth/flowlines/flowlines.h"
#include "synth/flowlines/lines/arc_map.h"
#include "tests/synth/flowlines/made_stream.h"

namespace freshet::synth::flowlines {
namespace {

FlowLine upright(float x, std::optional<float> time_s = {}, const std::string& name = "a") {
  FlowLine line = evenly({{x, 4}, {x, 84}}, name);
  line.time_s = time_s;
  return line;
}

std::string fault_of(const std::vector<FlowLine>& lines, double loop_s = 0) {
  try {
    MovingLines(lines, loop_s, "e.svg");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(MovingLines, LieBetweenTheirPositionsAndStayAtTheEnds) {
  const MovingLines moving({upright(50, 3.f), upright(10, 1.f), upright(90, {}, "b")}, 0, "e.svg");
  EXPECT_TRUE(moving.moves());
  const auto x = [&](double time) { return moving.at(time).front().points[20].x; };
  EXPECT_FLOAT_EQ(x(0), 10);
  EXPECT_FLOAT_EQ(x(1.5), 20);
  EXPECT_FLOAT_EQ(x(2), 30);
  EXPECT_FLOAT_EQ(x(3), 50);
  EXPECT_FLOAT_EQ(x(9), 50);
  ASSERT_EQ(moving.at(2).size(), 2u);
  EXPECT_EQ(moving.at(2)[1].points, upright(90).points);
  EXPECT_FALSE(MovingLines({upright(10)}, 0, "e.svg").moves());
}

TEST(MovingLines, GoBackToTheFirstPositionInALoop) {
  const MovingLines moving({upright(10, 1.f), upright(50, 3.f)}, 4, "e.svg");
  const auto x = [&](double time) { return moving.at(time).front().points[20].x; };
  EXPECT_FLOAT_EQ(x(2), 30);
  EXPECT_FLOAT_EQ(x(4), 30) << "halfway from second 3 to second 5";
  EXPECT_FLOAT_EQ(x(0), 30);
  EXPECT_FLOAT_EQ(x(4.5), 20);
  EXPECT_FLOAT_EQ(x(6), 30);
}

TEST(MovingLines, SayWhatIsWrongWithAPosition) {
  EXPECT_NE(fault_of({upright(10, 1.f), upright(20, 1.f)}).find("two positions at 1 s"), std::string::npos);
  EXPECT_NE(fault_of({upright(10, 1.f), upright(20)}).find("has no time"), std::string::npos);
  EXPECT_NE(fault_of({upright(10, 1.f), upright(20, 5.f)}, 4).find("the loop ends at 4 s"),
            std::string::npos);
  EXPECT_EQ(fault_of({upright(10, 1.f), upright(20, 5.f)}), "");
}

TEST(ArcMap, DrawsTextureOutBySpeedAlongTheLine) {
  FlowLine edited = upright(10);
  const FlowLine input = upright(40);
  const auto at = [&](float arc, Correspondence how) { return ArcMap(edited, input, how)(arc); };
  EXPECT_NEAR(at(30, Correspondence::kEqual), 30, 1e-3);
  edited.speeds = {2};
  EXPECT_NEAR(at(30, Correspondence::kEqual), 15, 1e-3);
  // From 1 to 3 over 80 px: the integral of 1 / (1 + s / 40) is 40 ln(1 + s / 40).
  edited.speeds = {1, 3};
  EXPECT_NEAR(at(40, Correspondence::kEqual), 40 * std::log(2), 0.02);
  EXPECT_NEAR(at(80, Correspondence::kEqual), 40 * std::log(3), 0.02);
  EXPECT_NEAR(at(80, Correspondence::kStretched), 80, 1e-3);
  EXPECT_NEAR(at(40, Correspondence::kStretched), 80 * std::log(2) / std::log(3), 0.05);
  EXPECT_NEAR(at(-10, Correspondence::kEqual), -10, 0.2) << "beyond its beginning as there";
}

/// Water moved aside over two seconds: its texture is found where the line then lies.
TEST(MovingLines, TakeTheFluidWithThem) {
  const Footage footage = made_stream({.channel = {8, 0, 40, 96}});
  FlowlinesOptions options;
  for (const float x : {16.0f, 28.0f, 40.0f})
    options.lines.push_back(evenly({{x, 2}, {x, 92}}, std::to_string(static_cast<int>(x))));
  for (const float time : {0.0f, 1.6f})
    for (FlowLine line : options.lines) {
      for (cv::Point2f& point : line.points) point.x += time > 0 ? 70.0f : 50.0f;
      line.time_s = time;
      options.edited.push_back(line);
    }
  Flowlines moved(footage, options);
  options.edited.clear();
  Flowlines clip(footage, options);
  for (int t = 0; t <= 40; ++t) {
    const cv::Mat made = moved.next(), is = clip.next();
    if (t % 8 != 0) continue;  // 4 px further each time: whole pixels
    const cv::Rect was(22, 20, 12, 50), here(22 + 50 + t / 2, 20, 12, 50);
    EXPECT_LT(cv::norm(made(here), is(was), cv::NORM_L1) / (was.area() * 3), 4) << "frame " << t;
    EXPECT_GT(moved.fluid().at<float>(45, 28 + 50 + t / 2), 0.9f) << "frame " << t;
  }
}

TEST(MovingLines, CloseInALoop) {
  const Footage footage = made_stream({.channel = {8, 0, 40, 96}});
  FlowlinesOptions options{.loop_frames = 50};
  options.lines.push_back(evenly({{28, 2}, {28, 92}}, "a"));
  for (const float time : {0.0f, 1.0f}) {
    options.edited.push_back(evenly({{60 + 20 * time, 2}, {60 + 20 * time, 92}}, "a"));
    options.edited.back().time_s = time;
  }
  Flowlines engine(footage, options);
  std::vector<cv::Mat> out;
  for (int t = 0; t < 55; ++t) out.push_back(engine.next().clone());
  for (std::size_t t = 0; t < 5; ++t) EXPECT_EQ(cv::norm(out[t], out[t + 50], cv::NORM_INF), 0) << t;
  EXPECT_GT(cv::norm(out[0], out[25], cv::NORM_INF), 20);
}

}  // namespace
}  // namespace freshet::synth::flowlines
