#include "vision/temporal_spectrum.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "freshet/error.h"
#include "vision/flow.h"

namespace freshet::vision {
namespace {

// A clip whose motion is known: at each pixel a mean and one sinusoid a component.
struct Motion {
  cv::Size frame{37, 22};  // odd on purpose: cells at the edges are partial
  int step = 2;
  double fps = 25;
  int flows = 80;
  double mean_u = 30, mean_v = -45;           // px/s
  double amplitude_u = 60, amplitude_v = 35;  // px/s
  double hz = 4 / 1.28;
  double phase_v = 0;  // radians, of v against u

  double u(int t, int) const { return mean_u + amplitude_u * std::sin(angle(t)); }
  double v(int t, int x) const { return mean_v + x + amplitude_v * std::sin(angle(t) + phase_v); }
  double angle(int t) const { return 2 * std::numbers::pi * hz * t / fps; }
  cv::Size flow_size() const { return {(frame.width + step - 1) / step, (frame.height + step - 1) / step}; }
};

void feed(MotionAccumulator& accumulator, const Motion& m) {
  cv::Mat u(m.flow_size(), CV_16S), v(m.flow_size(), CV_16S);
  for (int t = 0; t < m.flows; ++t) {
    for (int y = 0; y < u.rows; ++y) {
      for (int x = 0; x < u.cols; ++x) {
        u.at<short>(y, x) = cv::saturate_cast<short>(m.u(t, x) / m.fps / kFlowUnit);
        v.at<short>(y, x) = cv::saturate_cast<short>(m.v(t, x) / m.fps / kFlowUnit);
      }
    }
    accumulator.add(u, v);
  }
}

CellMap cells_of_clip(const Motion& m, const SpectrumOptions& options) {
  MotionAccumulator accumulator(m.frame, m.step, m.fps, options);
  feed(accumulator, m);
  return accumulator.finish();
}

TEST(MotionBands, AreLogarithmicAndHoldABinEach) {
  const std::vector<int> starts{1, 2, 3, 4, 5, 6, 8, 12, 17};
  const auto edges = band_edges_hz({});
  ASSERT_EQ(edges.size(), starts.size());
  for (std::size_t i = 0; i < starts.size(); ++i) EXPECT_DOUBLE_EQ(edges[i], (starts[i] - 0.5) / 1.28);
  for (int bands = 0; bands < 40; ++bands) {
    const auto e = band_edges_hz({.bands = bands});
    EXPECT_EQ(static_cast<int>(e.size()) - 1, bands == 0 ? 16 : std::min(bands, 16));
    for (std::size_t i = 1; i < e.size(); ++i) EXPECT_GT(e[i], e[i - 1] + 0.99 / 1.28);
  }
  EXPECT_EQ(motion_channels({}), 26);
  EXPECT_THROW(motion_bands({.window_s = 1e9}), Error);
  EXPECT_THROW(motion_bands({.window_s = 0.01}), Error);
}

TEST(NaivePower, GivesHalfTheSquaredAmplitude) {
  std::vector<double> series(100);
  for (int t = 0; t < 100; ++t) series[t] = 7 + 10 * std::sin(2 * std::numbers::pi * 6 / 1.28 * t / 25);
  const auto power = naive_power(series, 25, {});
  ASSERT_EQ(power.size(), 17u);
  EXPECT_NEAR(power[6], 50 * 2 / 3.0, 1e-9);
  EXPECT_NEAR(power[5], 50 / 6.0, 1e-9);
  EXPECT_NEAR(power[7], 50 / 6.0, 1e-9);
  EXPECT_NEAR(std::accumulate(power.begin(), power.end(), 0.0), 50, 1e-9);
}

TEST(MotionCells, HoldTheSignedMeanInPxPerSecond) {
  const Motion m{.flows = 64};
  const CellMap cells = cells_of_clip(m, {});
  ASSERT_EQ(cells.rows, 6);
  ASSERT_EQ(cells.columns, 10);
  ASSERT_EQ(cells.channels, 26);
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.columns; ++column) {
      const double x = column == 9 ? 18 : 2 * column + 0.5;  // mean flow x of the cell's pixels
      EXPECT_NEAR(cells.at(row, column)[0], m.mean_u, 0.1);
      EXPECT_NEAR(cells.at(row, column)[1], m.mean_v + x, 0.1);
    }
  }
}

TEST(MotionCells, PowerEqualsTheSlowTwin) {
  for (const double fps : {25.0, 30.0, 24.0, 60.0, 12.0, 2.0}) {
    for (const int flows : {8, 20, 61, 100}) {
      for (const int bands : {0, 3, 8}) {
        const Motion m{.fps = fps, .flows = flows, .hz = std::min(3.3, fps / 3)};
        const SpectrumOptions options{.bands = bands};
        const CellMap cells = cells_of_clip(m, options);
        std::vector<double> u(flows);
        for (int t = 0; t < flows; ++t) {
          u[t] = cv::saturate_cast<short>(m.u(t, 0) / fps / kFlowUnit) * fps * kFlowUnit;
        }
        const auto power = naive_power(u, fps, options);
        const auto edges = band_edges_hz(options);
        for (int b = 0; b < motion_bands(options); ++b) {
          double expected = 0;
          for (std::size_t n = 1; n < power.size(); ++n) {
            const double hz = static_cast<double>(n) / options.window_s;
            if (hz > edges[b] && hz < edges[b + 1]) expected += power[n];
          }
          for (const auto& cell : {cells.at(0, 0), cells.at(5, 9), cells.at(2, 4)}) {
            EXPECT_NEAR(cell[2 + 3 * b], expected, 1e-4 * m.amplitude_u * m.amplitude_u)
                << fps << " " << flows;
          }
        }
      }
    }
  }
}

TEST(MotionCells, KnownSinusoidsGiveKnownPowerAndCrossPower) {
  for (const double phase : {0.0, std::numbers::pi, std::numbers::pi / 2}) {
    const Motion m{.flows = 96, .hz = 9 / 1.28, .phase_v = phase};
    const CellMap cells = cells_of_clip(m, {});
    const auto cell = cells.at(3, 3);
    // Bin 9 lies inside band 6 (bins 8 to 11) with both of its neighbours.
    EXPECT_NEAR(cell[2 + 3 * 6], m.amplitude_u * m.amplitude_u / 2, 5);
    EXPECT_NEAR(cell[3 + 3 * 6], m.amplitude_v * m.amplitude_v / 2, 5);
    EXPECT_NEAR(cell[4 + 3 * 6], m.amplitude_u * m.amplitude_v / 2 * std::cos(phase), 5);
    for (int band = 0; band < 6; ++band) EXPECT_LT(cell[2 + 3 * band], 1);
    EXPECT_LT(cell[2 + 3 * 7], 1);
  }
}

TEST(MotionCells, SlowClipsLeaveTheUpperBandsEmpty) {
  const CellMap cells = cells_of_clip({.fps = 12, .hz = 2}, {});  // Nyquist 6 Hz: bin 7.68 of 16
  for (int channel = 0; channel < 3; ++channel) EXPECT_EQ(cells.at(1, 1)[2 + 3 * 7 + channel], 0);
  EXPECT_GT(cells.at(1, 1)[2 + 3 * 2], 100);
}

TEST(MotionCells, ClipsOfDifferentRateAgree) {
  const Motion slow{.fps = 25, .flows = 100, .hz = 9.2 / 1.28},
      fast{.fps = 50, .flows = 200, .hz = 9.2 / 1.28};
  const CellMap a = cells_of_clip(slow, {}), b = cells_of_clip(fast, {});
  for (int channel = 0; channel < 2; ++channel) EXPECT_NEAR(a.at(2, 2)[channel], b.at(2, 2)[channel], 1);
  EXPECT_NEAR(a.at(2, 2)[2 + 3 * 6], b.at(2, 2)[2 + 3 * 6], 0.02 * 1800);
}

TEST(MotionCells, AreTheSameOnAnyNumberOfThreads) {
  const Motion m{.frame = {331, 187}, .flows = 70};
  std::vector<float> first;
  for (const std::size_t threads : {1, 2, 8}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    const CellMap cells = cells_of_clip(m, {});
    if (first.empty()) first = cells.values;
    EXPECT_EQ(cells.values, first);
  }
}

TEST(MotionCells, MeanSpeedIsInSourcePxPerFrame) {
  const Motion m{.amplitude_u = 0, .amplitude_v = 0};
  MotionAccumulator accumulator(m.frame, m.step, m.fps, {});
  feed(accumulator, m);
  const cv::Mat speed = accumulator.mean_speed_px();
  ASSERT_EQ(speed.size(), m.flow_size());
  for (int x = 0; x < speed.cols; ++x) {
    EXPECT_NEAR(speed.at<float>(4, x), std::hypot(m.mean_u, m.mean_v + x) / m.fps, kFlowUnit);
  }
}

TEST(MotionCells, RefuseWhatDoesNotFit) {
  EXPECT_THROW(MotionAccumulator({64, 64}, 3, 25, {}), Error);
  EXPECT_THROW(MotionAccumulator({64, 64}, 2, 0, {}), Error);
  MotionAccumulator accumulator({64, 64}, 2, 25, {});
  EXPECT_THROW(accumulator.add(cv::Mat(64, 64, CV_16S), cv::Mat(64, 64, CV_16S)), Error);
  for (int i = 0; i < 7; ++i) accumulator.add(cv::Mat::zeros(32, 32, CV_16S), cv::Mat::zeros(32, 32, CV_16S));
  EXPECT_THROW(accumulator.finish(), Error);
}

}  // namespace
}  // namespace freshet::vision
