#include "synth/flowlines/rides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synth/flowlines/streamlines.h"
#include "synth/simulate/simulate.h"
#include "tests/synth/flowlines/made_stream.h"

namespace freshet::synth::flowlines {
namespace {

std::vector<cv::Mat> luma_of(const Footage& footage) {
  std::vector<cv::Mat> luma;
  for (const cv::Mat& frame : footage.frames) {
    luma.emplace_back();
    cv::cvtColor(frame, luma.back(), cv::COLOR_BGR2GRAY);
  }
  return luma;
}

const FlowLine kDown = evenly({{64, 6}, {64, 90}}, "down");

TEST(Rides, AParticleIsFollowedToAFractionOfAPixel) {
  for (const double speed : {1.3, 2.5, 4.2}) {
    const std::vector<cv::Mat> luma =
        luma_of(made_stream({.frames = 24, .speed = [=](int) { return speed; }}));
    const Rides rides = follow(luma, {kDown}, measure_motion(luma), {.dynamics = Dynamics::kMeasured});
    EXPECT_TRUE(rides.stationary) << rides.gain;
    const Ride& ride = rides.lines.front();
    for (std::size_t s = 20; s < 60; ++s)
      EXPECT_NEAR(static_cast<double>(ride.speed[s]), speed, 0.08) << speed << " at " << s;
    // Where the particle is after so many frames, against where it should be: error in px along the line.
    const double frames = static_cast<double>(ride.age[70] - ride.age[10]);
    EXPECT_NEAR(frames * speed, 60, 1.5) << speed;
  }
}

TEST(Rides, SpeedsOfTheirOwnAreFoundWhereParticlesHaveThem) {
  const auto speed = [](int t) { return 2.4 + 1.4 * std::sin(t * 0.5); };
  const std::vector<cv::Mat> luma = luma_of(made_stream({.frames = 40, .speed = speed}));
  const Rides rides = follow(luma, {kDown}, measure_motion(luma));
  EXPECT_FALSE(rides.stationary);
  EXPECT_GT(rides.gain, 0.3);
  // A particle that enters in frame 5 has gone the sum of the speeds since.
  const std::vector<float>& age = rides.lines.front().age_of_entry[5];
  double gone = 0;
  for (int t = 5; t < 20; ++t) {
    gone += speed(t);
    const auto reached = static_cast<std::size_t>(
        std::lower_bound(age.begin(), age.end(), static_cast<float>(t + 1 - 5)) - age.begin());
    EXPECT_NEAR(static_cast<double>(reached), gone, 2.5) << "after frame " << t;
  }
  EXPECT_TRUE(follow(luma, {kDown}, measure_motion(luma), {.dynamics = Dynamics::kStationary}).stationary);
}

TEST(Rides, AgreeWithTheSimulatorsOwnMotion) {
  simulate::Simulation clip(
      {.kind = simulate::SceneKind::kWaterfall, .size = {160, 128}, .frames = 24, .seed = 4});
  simulate::SimulatedFrame frame;
  Footage footage;
  cv::Mat truth(128, 160, CV_32FC2, cv::Scalar::all(0));
  while (clip.next(frame)) {
    footage.frames.push_back(frame.picture.clone());
    truth += frame.motion;
  }
  truth *= 1.0 / 24;
  const std::vector<cv::Mat> luma = luma_of(footage);
  cv::Mat parts[2], speed;
  cv::split(truth, parts);
  cv::magnitude(parts[0], parts[1], speed);
  const cv::Mat matte = speed > 0.5;
  const std::vector<FlowLine> lines = evenly_spaced(truth, matte, {.spacing_px = 16, .min_length_px = 40});
  ASSERT_FALSE(lines.empty());
  const Rides rides = follow(luma, lines, measure_motion(luma));
  std::vector<double> errors;
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (int s = 12; s + 12 < lines[i].samples(); s += 3) {
      const cv::Vec2f v = truth.at<cv::Vec2f>(cv::Point(lines[i].points[static_cast<std::size_t>(s)]));
      const double along = cv::Point2f(v[0], v[1]).dot(tangent(lines[i], s));
      errors.push_back(
          std::abs(static_cast<double>(rides.lines[i].speed[static_cast<std::size_t>(s)]) - along));
    }
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  RecordProperty("median_error_milli_px", static_cast<int>(1000 * errors[errors.size() / 2]));
  EXPECT_LT(errors[errors.size() / 2], 0.5) << "px a frame along the line";
}

}  // namespace
}  // namespace freshet::synth::flowlines
