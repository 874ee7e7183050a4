#include "synth/flowlines/moments.h"

#include <gtest/gtest.h>

#include <cmath>

#include "synth/flowlines/flowlines.h"
#include "synth/flowlines/plan.h"
#include "tests/synth/flowlines/made_stream.h"

namespace freshet::synth::flowlines {
namespace {

const cv::Size kSize(64, 64);

/// Frames that have nothing to do with each other.
std::vector<cv::Mat> unrelated(int count) {
  cv::RNG random(3);
  std::vector<cv::Mat> frames;
  for (int t = 0; t < count; ++t) {
    frames.emplace_back(kSize, CV_8UC3);
    random.fill(frames.back(), cv::RNG::UNIFORM, 0, 256);
  }
  return frames;
}

/// Of lines that go down the picture at 8 px a frame.
Plan plan_of(const Ladders& ladders, int frames) {
  std::vector<FlowLine> lines;
  Rides rides;
  for (int x = 4; x < kSize.width; x += 8) {
    lines.push_back({.points = {}, .name = "l"});
    rides.lines.emplace_back();
    for (int y = 0; y < kSize.height; ++y) {
      lines.back().points.emplace_back(static_cast<float>(x), static_cast<float>(y));
      rides.lines.back().speed.push_back(8);
      rides.lines.back().age.push_back(static_cast<float>(y) / 8);
    }
  }
  const StrandOptions strands{.spacing_px = 8, .width_px = 0, .blend_px = 4};
  return plan_repeats(ladders, lines, rides, kSize, frames, {.strands = strands}, {});
}

bool shows(const Moment& moment, int frame) {
  for (int i = 0; i < moment.count; ++i)
    if (moment.frame[static_cast<std::size_t>(i)] == frame) return true;
  return false;
}

class ShortClips : public testing::TestWithParam<int> {};

TEST_P(ShortClips, HaveNoCheapJumpsAtTheirEnds) {
  const Plan plan = plan_of(Ladders(unrelated(GetParam())), GetParam());
  ASSERT_FALSE(plan.ladders.empty());
  for (std::size_t k = 0; k < plan.ladders.size(); ++k) {
    const Ladder& ladder = plan.ladders[k];
    EXPECT_GE(ladder.entries(), 4);
    EXPECT_GE(ladder.first, kLeastMargin);
    EXPECT_LE(ladder.first + ladder.entries() + plan.margin +
                  static_cast<int>(std::ceil(plan.arrivals.streams[k].duration)),
              GetParam());
    for (int a = 0; a <= ladder.entries(); ++a)
      for (int b = 0; b < ladder.entries(); ++b)
        if (std::abs(a - b) >= 2) {
          EXPECT_GT(ladder.cost.at<float>(a, b), 0.85f) << "from " << a << " to " << b;
        }
  }
}

/// Where places go over is cut. What lay beyond the clip would be its first or last frame for longer than a frame; a
/// place may show other frames twice, where a short run is passed over.
TEST_P(ShortClips, NeverStandStillAtTheirEnds) {
  const std::vector<cv::Mat> clip = unrelated(GetParam());
  const Ladders ladders(clip);
  const Plan plan = plan_of(ladders, GetParam());
  Moments moments(plan.arrivals, cv::Mat(kSize, CV_32F, cv::Scalar(2)), orders_of(plan, {}), GetParam(),
                  {.frames = &ladders.frames(), .whole = &clip, .margin = plan.margin});
  std::vector<Moment> before, now;
  moments.at(0, before);
  for (int t = 1; t < 200; ++t, std::swap(before, now)) {
    moments.at(t, now);
    int still = 0;
    for (std::size_t i = 0; i < now.size(); ++i)
      for (const int end : {0, GetParam() - 1}) still += shows(before[i], end) && shows(now[i], end);
    EXPECT_EQ(still, 0) << "frame " << t;
  }
}

INSTANTIATE_TEST_SUITE_P(Frames, ShortClips, testing::Values(16, 20, 39));

TEST(Flowlines, GoOnFromTheShortestClips) {
  for (const int frames : {16, 20}) {
    const Footage footage = made_stream({.frames = frames});
    Flowlines engine(footage, {});
    EXPECT_GE(engine.report().entries, 4);
    cv::Mat before = engine.next().clone();
    for (int t = 1; t < 60; ++t) {
      const cv::Mat now = engine.next().clone();
      EXPECT_GT(cv::norm(now, before, cv::NORM_L1), 0) << frames << " frames, frame " << t;
      before = now;
    }
  }
}

}  // namespace
}  // namespace freshet::synth::flowlines
