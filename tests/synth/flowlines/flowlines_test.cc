#include "synth/flowlines/flowlines.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "tests/synth/flowlines/made_stream.h"

namespace freshet::synth::flowlines {
namespace {

std::vector<cv::Mat> frames_of(Flowlines& engine, int count) {
  std::vector<cv::Mat> out;
  for (int t = 0; t < count; ++t) out.push_back(engine.next().clone());
  return out;
}

template <class Job>
std::string fault_of(Job job) {
  try {
    job();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Flowlines, GoOnWithoutASeamAlongTheParticles) {
  const Footage footage = made_stream();
  Flowlines engine(footage, {});
  EXPECT_GT(engine.report().lines, 2);
  EXPECT_TRUE(engine.report().stationary);
  const std::vector<cv::Mat> out = frames_of(engine, 150);
  const cv::Rect bank(0, 0, 28, 96);
  double worst = 0, usual = 0;
  for (std::size_t t = 1; t < footage.frames.size(); ++t)
    usual = std::max(usual, cv::norm(footage.frames[t], footage.frames[t - 1], cv::NORM_L1));
  for (std::size_t t = 1; t < out.size(); ++t) {
    worst = std::max(worst, cv::norm(out[t], out[t - 1], cv::NORM_L1));
    EXPECT_LE(cv::norm(out[t](bank), footage.frames[0](bank), cv::NORM_INF), 3)
        << "what stands still stays, " << t;
  }
  EXPECT_LT(worst, 1.3 * usual);
  // A loop's joint, all at once, is what this is instead of.
  EXPECT_GT(cv::norm(footage.frames.front(), footage.frames.back(), cv::NORM_L1), 1.4 * usual);
}

TEST(Flowlines, ALoopClosesExactly) {
  const Footage footage = made_stream();
  Flowlines engine(footage, {.loop_frames = 60});
  const std::vector<cv::Mat> out = frames_of(engine, 125);
  for (std::size_t t = 0; t < 65; ++t) EXPECT_EQ(cv::norm(out[t], out[t + 60], cv::NORM_INF), 0) << t;
  EXPECT_GT(cv::norm(out[0], out[30], cv::NORM_INF), 20);
}

TEST(Flowlines, AreTheSameForAnyNumberOfThreads) {
  const Footage footage = made_stream({.frames = 32});
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Flowlines engine(footage, {.dynamics = Dynamics::kNonStationary});
    return frames_of(engine, 40);
  };
  const std::vector<cv::Mat> one = run(1), four = run(4);
  for (std::size_t t = 0; t < one.size(); ++t) ASSERT_EQ(cv::norm(one[t], four[t], cv::NORM_INF), 0) << t;
}

TEST(Flowlines, AnEditThatChangesNothingGivesTheClipBack) {
  const Footage footage = made_stream();
  FlowlinesOptions options;
  {
    Flowlines found(footage, options);
    options.lines = found.lines();
  }
  Flowlines plain(footage, options);
  options.edited = options.lines;
  Flowlines edited(footage, options);
  for (int t = 0; t < 40; ++t) EXPECT_LE(cv::norm(plain.next(), edited.next(), cv::NORM_INF), 2) << t;
}

TEST(Flowlines, EditedLinesLeadTheFluidElsewhere) {
  const Footage footage = made_stream({.channel = {8, 0, 40, 96}});
  FlowlinesOptions options;
  for (const float x : {16.0f, 28.0f, 40.0f})
    options.lines.push_back(evenly({{x, 2}, {x, 92}}, std::to_string(static_cast<int>(x))));
  for (FlowLine line : options.lines) {
    for (cv::Point2f& point : line.points) point.x += 60;
    options.edited.push_back(line);
  }
  options.view.background = cv::Mat(footage.size(), CV_8UC3, cv::Scalar(10, 200, 30));
  Flowlines plain(footage, options);  // an edit too: of the clip itself
  FlowlinesOptions as_it_is = options;
  as_it_is.edited.clear();
  Flowlines before(footage, as_it_is);
  const cv::Rect was(22, 20, 12, 50), is(82, 20, 12, 50);
  for (int t = 0; t < 20; ++t) {
    const cv::Mat moved = plain.next(), clip = before.next();
    EXPECT_LT(cv::norm(moved(is), clip(was), cv::NORM_L1) / (is.area() * 3), 4) << "the texture, elsewhere";
    EXPECT_LT(cv::norm(moved(was), options.view.background(was), cv::NORM_L1) / (was.area() * 3), 4)
        << "taken away";
  }
}

TEST(Flowlines, WhatTheClipsBorderCutsOffFadesFurtherInside) {
  const Footage footage = made_stream({.channel = {8, 0, 40, 96}});
  FlowlinesOptions options;
  for (const float x : {16.0f, 28.0f, 40.0f}) {
    const std::string name = std::to_string(static_cast<int>(x));
    options.lines.push_back(evenly({{x, 0}, {x, 92}}, name));
    options.edited.push_back(evenly({{x + 60, 30}, {x + 60, 92}}, name));
  }
  options.view.background = cv::Mat(footage.size(), CV_8UC3, cv::Scalar(10, 200, 30));
  Flowlines engine(footage, options);
  engine.next();
  const cv::Mat fluid = engine.fluid();
  EXPECT_LT(fluid.at<float>(28, 88), 0.1f);
  EXPECT_LT(fluid.at<float>(31, 88), 0.6f);
  for (int y = 28; y < 45; ++y) EXPECT_LE(fluid.at<float>(y, 88) - fluid.at<float>(y - 1, 88), 0.5f) << y;
  EXPECT_GT(fluid.at<float>(45, 88), 0.95f);
}

TEST(Flowlines, CopiesFlowInATimeOfTheirOwn) {
  const Footage footage = made_stream({.channel = {8, 0, 40, 96}});
  for (const int loop : {0, 50}) {
    FlowlinesOptions options{.loop_frames = loop};
    for (const float x : {16.0f, 28.0f, 40.0f}) {
      options.lines.push_back(evenly({{x, 2}, {x, 92}}, std::to_string(static_cast<int>(x))));
      FlowLine copy = options.lines.back();
      for (cv::Point2f& point : copy.points) point.x += 60;
      copy.name += "-2";
      options.edited.push_back(options.lines.back());
      options.edited.push_back(copy);
    }
    Flowlines engine(footage, options);
    const std::vector<cv::Mat> out = frames_of(engine, 110);
    const cv::Rect one(22, 20, 12, 50), two(82, 20, 12, 50);
    for (std::size_t t = 0; t < 50; ++t) {
      EXPECT_GT(cv::norm(out[t](one), out[t](two), cv::NORM_L1) / (one.area() * 3), 10) << t;
      if (loop > 0) {
        EXPECT_EQ(cv::norm(out[t], out[t + 50], cv::NORM_INF), 0) << t;
      }
    }
    // It flows as fast as the clip.
    const cv::Rect later = two + cv::Point(0, 3);
    int followed = 0;
    for (std::size_t t = 0; t + 1 < 50; ++t)
      followed += cv::norm(out[t](two), out[t + 1](later), cv::NORM_L1) / (two.area() * 3) < 4 ? 1 : 0;
    EXPECT_GT(followed, 25) << "of 49";
  }
}

TEST(Flowlines, SayWhyAClipCannotBeUsed) {
  const auto refusal = [](const MadeStream& made, const FlowlinesOptions& options = {}) {
    const Footage footage = made_stream(made);
    return fault_of([&] { Flowlines engine(footage, options); });
  };
  EXPECT_NE(refusal({.frames = 9}).find("at least 16"), std::string::npos);
  EXPECT_NE(
      refusal({.speed = [](int) { return 0.0; }, .flicker = 30}).find("nothing in it flows along lines"),
      std::string::npos);
  EXPECT_NE(refusal({.camera = 2}).find("the camera moves"), std::string::npos);
  EXPECT_EQ(refusal({.camera = 2}, {.moving_camera = true}), "");
  const FlowLine up = evenly({{64, 90}, {64, 6}}, "up");
  EXPECT_NE(refusal({}, {.lines = {up}}).find("flows against this line"), std::string::npos);
  EXPECT_NE(refusal({}, {.entries = 49}).find("at most"), std::string::npos);
  const FlowLine down = evenly({{64, 6}, {64, 90}}, "down"), other = evenly({{64, 6}, {64, 90}}, "downhill");
  const std::string unpaired = refusal({}, {.lines = {down}, .edited = {other}, .edited_name = "e.svg"});
  EXPECT_NE(unpaired.find("\"downhill\""), std::string::npos) << unpaired;
  EXPECT_NE(unpaired.find("--lines-out"), std::string::npos) << unpaired;
}

/// Mean |Laplacian| of the channel.
double detail_of(const std::vector<cv::Mat>& frames, const cv::Rect& channel) {
  double sum = 0;
  for (const cv::Mat& frame : frames) {
    cv::Mat laplacian;
    cv::Laplacian(frame(channel), laplacian, CV_32F);
    sum += cv::mean(cv::abs(laplacian))[0];
  }
  return sum / static_cast<double>(frames.size());
}

TEST(Flowlines, ContrastGivesBackTheDetailThatFeatheringCosts) {
  const Footage footage = made_stream();
  const cv::Rect channel(44, 16, 40, 64);
  const auto detail = [&](Mixing mixing) {
    Flowlines engine(footage, {.mixing = mixing});
    return detail_of(frames_of(engine, 120), channel) / detail_of(footage.frames, channel);
  };
  const double feathered = detail(Mixing::kFeather), contrast = detail(Mixing::kContrast);
  EXPECT_LT(feathered, 0.97);
  EXPECT_GT(contrast, feathered + 0.3 * (1 - feathered));
  EXPECT_LT(contrast, 1.05);
}

}  // namespace
}  // namespace freshet::synth::flowlines
