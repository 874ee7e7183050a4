#include "vision/patch_features.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "vision/flow.h"

namespace freshet::vision {
namespace {

constexpr double kFps = 25;
constexpr int kFlows = 48;
const cv::Size kFrame(240, 160);

// A smooth field with a mean, two rates, and components that swing together here and against each other
// there.
cv::Vec2d velocity(double x, double y, int t) {  // px/s
  const double turn = 2 * std::numbers::pi * t / kFps;
  const double slow = std::sin(turn * 3.1 + x / 70), fast = std::sin(turn * 8.3 - y / 60);
  const double swing = std::cos((x + y) / 90);
  return {40 + x / 8 + 50 * slow + 20 * swing * fast, -60 + y / 5 + 35 * swing * slow + 45 * fast};
}

CellMap motion_of(const SpectrumOptions& options) {
  MotionAccumulator accumulator(kFrame, 2, kFps, options);
  cv::Mat flow(kFrame, CV_32FC2), u, v;
  for (int t = 0; t < kFlows; ++t) {
    for (int y = 0; y < flow.rows; ++y) {
      for (int x = 0; x < flow.cols; ++x) flow.at<cv::Vec2f>(y, x) = velocity(x, y, t) * (1 / kFps);
    }
    quantize_flow(flow, 2, u, v);
    accumulator.add(u, v);
  }
  return accumulator.finish();
}

CellMap texture_ramp(float scale) {
  CellMap map{.rows = static_cast<int>(160 * scale / 4),
              .columns = static_cast<int>(240 * scale / 4),
              .channels = kTextureLevels,
              .cell = 4 / scale,
              .values = {}};
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      for (int level = 0; level < kTextureLevels; ++level) {
        map.values.push_back((column + 0.5f) * map.cell + 10 * level * (row + 0.5f) * map.cell);
      }
    }
  }
  return map;
}

struct Cell {
  cv::Vec2d mean;
  std::vector<double> power_u, power_v;  // by band
};

// The slow way: flow itself is carried into the variant, pixel by pixel, and measured there.
Cell measured_cell(const VariantFrame& frame, cv::Point corner, const SpectrumOptions& options) {
  const int bands = motion_bands(options), side = options.cell;
  Cell cell{{}, std::vector<double>(bands), std::vector<double>(bands)};
  const auto edges = band_edges_hz(options);
  const cv::Matx23d& m = frame.source_from_variant;
  for (int i = 0; i < side * side; ++i) {
    const double x = corner.x + i % side, y = corner.y + i / side;
    const double sx = m(0, 0) * x + m(0, 1) * y + m(0, 2), sy = m(1, 0) * x + m(1, 1) * y + m(1, 2);
    std::vector<double> u, v;
    for (int t = 0; t < kFlows; ++t) {
      const cv::Vec2d turned = frame.variant_from_source_velocity * velocity(sx, sy, t);
      u.push_back(turned[0]);
      v.push_back(turned[1]);
      cell.mean += turned * (1.0 / (kFlows * side * side));
    }
    const auto pu = naive_power(u, kFps, options), pv = naive_power(v, kFps, options);
    for (std::size_t n = 1; n < pu.size(); ++n) {
      for (int b = 0; b < bands; ++b) {
        const double hz = static_cast<double>(n) / options.window_s;
        if (hz < edges[b] || hz > edges[b + 1]) continue;
        cell.power_u[b] += pu[n] / (side * side);
        cell.power_v[b] += pv[n] / (side * side);
      }
    }
  }
  return cell;
}

TEST(PatchFeatures, EqualSpectraOfTheTurnedFlow) {
  const SpectrumOptions options;
  const CellMap motion = motion_of(options);
  const int bands = motion_bands(options), channels = feature_channels(options), patch = 48, cells = 12;
  ASSERT_EQ(channels, 22);
  double worst_mean = 0, worst_power = 0;
  for (const Variant variant :
       {Variant{1, 0, false}, Variant{1, 0, true}, Variant{0.5f, 0, false}, Variant{1, 22.5f, false},
        Variant{1, -22.5f, true}, Variant{0.75f, -22.5f, false}, Variant{0.5f, 22.5f, true}}) {
    const VariantFrame frame = variant_frame(kFrame, variant);
    const cv::Point corner((frame.size.width - patch) / 2, (frame.size.height - patch) / 2);
    std::vector<float> features(static_cast<std::size_t>(cells) * cells * channels);
    patch_features(motion, texture_ramp(variant.scale), frame, corner.x, corner.y, patch, options, features);
    double largest = 0;
    for (const float value : features) largest = std::max<double>(largest, value);
    for (const int index : {0, 5, 11, 66, 132, 143}) {
      const Cell expected =
          measured_cell(frame, corner + cv::Point(index % cells * 4, index / cells * 4), options);
      const float* got = features.data() + static_cast<std::size_t>(index) * channels;
      worst_mean =
          std::max({worst_mean, std::abs(got[0] - expected.mean[0]), std::abs(got[1] - expected.mean[1])});
      double total = 0;
      for (int b = 0; b < bands; ++b) total += expected.power_u[b] + expected.power_v[b];
      for (int b = 0; b < bands; ++b) {
        EXPECT_NEAR(got[2 + b], expected.power_u[b], 0.01 * total) << variant.rotation_deg << " " << b;
        EXPECT_NEAR(got[2 + bands + b], expected.power_v[b], 0.01 * total)
            << variant.rotation_deg << " " << b;
        worst_power = std::max({worst_power, std::abs(got[2 + b] - expected.power_u[b]) / total,
                                std::abs(got[2 + bands + b] - expected.power_v[b]) / total});
      }
    }
  }
  RecordProperty("worst_mean_px_per_s", std::to_string(worst_mean));
  RecordProperty("worst_power_of_total", std::to_string(worst_power));
  EXPECT_LT(worst_mean, 0.5);  // of some 70 px/s; 1/64 px per frame is 0.4 px/s
}

TEST(PatchFeatures, TextureIsReadAtTheMappedCentres) {
  const SpectrumOptions options;
  const CellMap motion = motion_of(options);
  for (const Variant variant : {Variant{1, 22.5f, true}, Variant{0.5f, -22.5f, false}}) {
    const VariantFrame frame = variant_frame(kFrame, variant);
    const int x = (frame.size.width - 48) / 2, y = (frame.size.height - 48) / 2;
    std::vector<float> features(144 * 22);
    patch_features(motion, texture_ramp(variant.scale), frame, x, y, 48, options, features);
    for (int index = 0; index < 144; ++index) {
      const double px = x + (index % 12 + 0.5) * 4 - 0.5, py = y + (index / 12 + 0.5) * 4 - 0.5;
      const cv::Matx23d& m = frame.source_from_variant;
      const double sx = m(0, 0) * px + m(0, 1) * py + m(0, 2) + 0.5,
                   sy = m(1, 0) * px + m(1, 1) * py + m(1, 2) + 0.5;
      for (int level = 0; level < kTextureLevels; ++level) {
        EXPECT_NEAR(features[index * 22 + 18 + level], sx + 10 * level * sy, 1e-3 * (1 + 10 * level * sy));
      }
    }
  }
}

TEST(PatchFeatures, FlippedTwinHasTheSameCellsMirrored) {
  const SpectrumOptions options;
  const CellMap motion = motion_of(options), texture = texture_ramp(1);
  const VariantFrame plain = variant_frame(kFrame, {1, 22.5f, false}),
                     flipped = variant_frame(kFrame, {1, 22.5f, true});
  std::vector<float> a(144 * 22), b(144 * 22);
  patch_features(motion, texture, plain, 96, 72, 48, options, a);
  patch_features(motion, texture, flipped, plain.size.width - 48 - 96, 72, 48, options, b);
  for (int index = 0; index < 144; ++index) {
    const int twin = index / 12 * 12 + 11 - index % 12;
    for (int channel = 0; channel < 22; ++channel) {
      const float sign = channel == 0 ? -1 : 1;
      EXPECT_NEAR(b[twin * 22 + channel], sign * a[index * 22 + channel],
                  1e-3 * (1 + std::abs(a[index * 22 + channel])));
    }
  }
}

TEST(PatchFeatures, MeanMotionIsTheMeanOfTheFirstTwoChannels) {
  const SpectrumOptions options;
  const CellMap motion = motion_of(options), texture = texture_ramp(1);
  for (const Variant variant : make_variants({1, 0.75f, 0.5f}, {-22.5f, 0, 22.5f}, true)) {
    const VariantFrame frame = variant_frame(kFrame, variant);
    std::vector<float> features(144 * 22);
    patch_features(motion, texture, frame, 30, 20, 48, options, features);
    cv::Vec2d sum;
    for (int i = 0; i < 144; ++i) sum += cv::Vec2d(features[i * 22], features[i * 22 + 1]);
    const cv::Vec2f mean = patch_mean_motion(motion, frame, 30, 20, 48);
    EXPECT_NEAR(mean[0], sum[0] / 144, 1e-3);
    EXPECT_NEAR(mean[1], sum[1] / 144, 1e-3);
  }
}

TEST(PatchFeatures, RefuseMapsOfOtherSettings) {
  const SpectrumOptions options;
  CellMap motion = motion_of(options);
  const CellMap texture = texture_ramp(1);
  const VariantFrame frame = variant_frame(kFrame, {});
  std::vector<float> features(144 * 22);
  EXPECT_THROW(patch_features(motion, texture, frame, 0, 0, 48, {.bands = 4}, features), Error);
  EXPECT_THROW(patch_features(motion, texture, frame, 0, 0, 52, options, features), Error);
  EXPECT_THROW(patch_features(motion, motion, frame, 0, 0, 48, options, features), Error);
  motion.values.resize(motion.values.size() / 2);
  EXPECT_THROW(patch_features(motion, texture, frame, 0, 0, 48, options, features), Error);
}

}  // namespace
}  // namespace freshet::vision
