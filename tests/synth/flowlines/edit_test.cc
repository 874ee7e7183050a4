#include "synth/flowlines/edit.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::synth::flowlines {
namespace {

FlowLine down(float x, const std::string& name) { return evenly({{x, 10}, {x, 110}}, name); }

/// Three lines of one plume, 30 px apart.
const std::vector<FlowLine> kPlume{down(40, "a"), down(70, "b"), down(100, "c")};

std::vector<FlowLine> beside(float way, const std::string& copy, float mirror = 1, float wide = 1) {
  std::vector<FlowLine> out;
  for (const FlowLine& line : kPlume)
    out.push_back(down(70 + way + mirror * wide * (line.points.front().x - 70), line.name + copy));
  return out;
}

std::vector<FlowLine> both(std::vector<FlowLine> first, const std::vector<FlowLine>& then) {
  first.insert(first.end(), then.begin(), then.end());
  return first;
}

/// How many interpolated lines lie between each drawn one and the next.
std::vector<int> between_lines(const std::vector<FlowLine>& drawn, const EditOptions& options) {
  const std::vector<cv::Mat> frames(4, cv::Mat(120, 400, CV_8UC3, cv::Scalar::all(90)));
  std::vector<int> out;
  for (const EditedLine& line : densify(kPlume, drawn, partners(kPlume, drawn, "e.svg"), frames, options)) {
    EXPECT_GE(line.input, 0);
    if (line.drawn)
      out.push_back(0);
    else
      ++out.back();
  }
  return out;
}

/// The times of the drawn lines; those between have their chain's.
std::vector<int> times(const std::vector<FlowLine>& drawn, const EditOptions& options) {
  const std::vector<cv::Mat> frames(4, cv::Mat(120, 400, CV_8UC3, cv::Scalar::all(90)));
  std::vector<int> out;
  for (const EditedLine& line : densify(kPlume, drawn, partners(kPlume, drawn, "e.svg"), frames, options)) {
    if (!line.drawn) {
      EXPECT_EQ(line.time, out.back());
      continue;
    }
    out.push_back(line.time);
  }
  return out;
}

TEST(Edit, LinesOfASheetAreJoinedAndItsCopiesAreNot) {
  // Patches as large as for smoke: 4 of them reach over the whole picture.
  const EditOptions large{.patch_px = 100, .spacing_px = 10};
  EXPECT_EQ(between_lines(both(kPlume, beside(140, "-2")), large), (std::vector<int>{2, 2, 0, 2, 2, 0}));
  EXPECT_EQ(between_lines(both(kPlume, beside(90, "-2")), large), (std::vector<int>{2, 2, 0, 2, 2, 0}))
      << "copies as near to each other as lines of one";
  EXPECT_EQ(between_lines({down(40, "a"), down(120, "a-2"), down(200, "a-3")}, large),
            (std::vector<int>{0, 0, 0}))
      << "chimneys of one line each";
  EXPECT_EQ(between_lines(beside(140, "-2", -1), large), (std::vector<int>{2, 2, 0})) << "mirrored";
  EXPECT_EQ(between_lines(beside(140, "-2", 1, 1.8f), large), (std::vector<int>{4, 4, 0})) << "drawn out";
  EXPECT_EQ(between_lines({down(40, "a"), evenly({{60, 60}, {180, 60}}, "b")}, large),
            (std::vector<int>{0, 0}))
      << "across";
}

TEST(Edit, CopiesHaveATimeOfTheirOwnAndGoTogether) {
  const EditOptions large{.patch_px = 100, .spacing_px = 10};
  EXPECT_EQ(times(both(both(kPlume, beside(90, "-2")), {down(300, "b-3"), down(380, "c-2")}), large),
            (std::vector<int>{0, 0, 0, 1, 1, 1, 2, 1}));
  // A drawing program may give each line of a copy an ending of its own.
  EXPECT_EQ(times(both(kPlume, {down(140, "a-3"), down(170, "b-6"), down(200, "c-1")}), large),
            (std::vector<int>{0, 0, 0, 1, 1, 1}));
  std::vector<FlowLine> many;
  for (int i = 0; i < 9; ++i) many.push_back(down(20.0f * static_cast<float>(i), "a-" + std::to_string(i)));
  for (const int time : times(many, large)) {
    EXPECT_GT(time, 0);
    EXPECT_LT(time, kTimes);
  }
}

TEST(Edit, CopiesBesideEachOtherStayTwoWhateverTheirOrder) {
  const EditOptions large{.patch_px = 100, .spacing_px = 10};
  const std::vector<FlowLine> sheet{down(70, "b"), down(40, "a"), down(100, "c")};
  for (const float way : {24.0f, 48.0f, 60.0f, 90.0f}) {
    std::vector<FlowLine> copy;
    for (const FlowLine& line : sheet) copy.push_back(down(line.points.front().x + way, line.name + "-2"));
    EXPECT_EQ(between_lines(both(sheet, copy), large)[2], 0) << way;
  }
}

TEST(Edit, ADistanceThatIsAskedForDecidesAlone) {
  const EditOptions asked{.patch_px = 100, .spacing_px = 10, .join_px = 45};
  EXPECT_EQ(between_lines({down(40, "a"), down(80, "a-2"), down(130, "b")}, asked),
            (std::vector<int>{3, 0, 0}));
}

TEST(Edit, SmallPatchesDoNotReachFar) {
  EXPECT_EQ(between_lines(kPlume, {.patch_px = 7, .spacing_px = 3}), (std::vector<int>{0, 0, 0}));
}

TEST(Edit, LinesBetweenShowWhatMatchesTheirNeighbours) {
  // Of a picture whose colours change across the lines, those of the plume beside it show what lies in order.
  std::vector<cv::Mat> frames;
  for (int t = 0; t < 4; ++t) {
    cv::Mat frame(120, 400, CV_8UC3);
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols; ++x)
        frame.at<cv::Vec3b>(y, x) = cv::Vec3b(static_cast<unsigned char>(std::min(255, 2 * x)),
                                              static_cast<unsigned char>(255 - std::min(255, 2 * x)), 90);
    frames.push_back(frame);
  }
  const EditOptions options{.patch_px = 24, .spacing_px = 6};
  const std::vector<FlowLine> inputs = dense_inputs(kPlume, options);
  ASSERT_GT(inputs.size(), 10u);
  const std::vector<FlowLine> drawn = beside(160, "");
  const std::vector<EditedLine> dense =
      densify(inputs, drawn, partners(inputs, drawn, "e.svg"), frames, options);
  ASSERT_GT(dense.size(), 10u);
  for (const EditedLine& line : dense)
    EXPECT_NEAR(inputs[static_cast<std::size_t>(line.input)].points.front().x + 160,
                line.line.points.front().x, 4);
}

TEST(Edit, ErrorsOfOverlapsAreMeansOverTheFrames) {
  // The first frame says that all inputs are alike, the other three that they are in order.
  std::vector<cv::Mat> frames(4, cv::Mat(120, 400, CV_8UC3, cv::Scalar::all(90)));
  for (std::size_t t = 1; t < 4; ++t) {
    frames[t] = frames[t].clone();
    for (int x = 0; x < 400; ++x) frames[t].col(x).setTo(cv::Scalar::all(std::min(255, 2 * x)));
  }
  EditOptions options{.patch_px = 24, .spacing_px = 6};
  const std::vector<FlowLine> inputs = dense_inputs(kPlume, options), drawn = beside(160, "");
  const auto apart = [&] {
    double sum = 0;
    for (const EditedLine& line : densify(inputs, drawn, partners(inputs, drawn, "e.svg"), frames, options))
      sum += std::abs(static_cast<double>(inputs[static_cast<std::size_t>(line.input)].points.front().x +
                                          160 - line.line.points.front().x));
    return sum;
  };
  const double of_all = apart();
  options.frames = 1;
  EXPECT_LT(of_all, 0.25 * apart());
}

}  // namespace
}  // namespace freshet::synth::flowlines
