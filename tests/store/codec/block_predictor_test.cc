#include "store/codec/block_predictor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace freshet::store {
namespace {

/// Frames of a tile, and what docs/format.md says of the samples outside it.
template <class Sample>
struct Tile {
  std::uint32_t width, height, frames;
  std::vector<Sample> samples;

  int at(int f, int y, int x) const {
    if (f < 0 || y < 0) return 0;
    if (x < 0) return at(f, y - 1, 0);
    return samples[(static_cast<std::size_t>(f) * height + y) * width + x];
  }

  /// The formulas of docs/format.md, one sample at a time.
  int predicted(Predictor kind, int f, int y, int x) const {
    const auto med = [](int a, int b, int c) {
      return std::clamp(a + b - c, std::min(a, b), std::max(a, b));
    };
    const int w = at(f, y, x - 1), n = at(f, y - 1, x), nw = at(f, y - 1, x - 1), p = at(f - 1, y, x),
              pw = at(f - 1, y, x - 1), pn = at(f - 1, y - 1, x), pnw = at(f - 1, y - 1, x - 1);
    switch (kind) {
      case Predictor::kSpatial:
        return med(w, n, nw);
      case Predictor::kTemporal:
      case Predictor::kCopy:
        return p;
      case Predictor::kDrift:
        return p + med(w - pw, n - pn, nw - pnw);
      case Predictor::kSoft:
        return (3 * (w + n) - 2 * nw + 2) >> 2;
      case Predictor::kMean:
        return (med(w, n, nw) + p) >> 1;
    }
    return 0;
  }

  Sample residual(Predictor kind, int f, int y, int x) const {
    const auto e = static_cast<std::make_signed_t<Sample>>(at(f, y, x) - predicted(kind, f, y, x));
    return static_cast<Sample>(e >= 0 ? 2 * e : -2 * e - 1);
  }
};

// Noise, extremes, or waves with a part that stands still.
template <class Sample>
Tile<Sample> random_tile(std::mt19937& random) {
  const auto up_to = [&](std::uint32_t maximum) {
    return 1 + static_cast<std::uint32_t>(random()) % maximum;
  };
  Tile<Sample> tile{up_to(70), up_to(40), up_to(4), {}};
  const unsigned content = up_to(3) - 1;
  for (std::uint32_t f = 0; f < tile.frames; ++f) {
    for (std::uint32_t y = 0; y < tile.height; ++y) {
      for (std::uint32_t x = 0; x < tile.width; ++x) {
        unsigned sample = static_cast<unsigned>(random());
        if (content == 1) sample = sample % 2 == 0 ? 0 : ~0u;
        if (content == 2) sample = x < 20 ? 90 : (x * 3 + y * 5 + f * 7) * 11 + sample % 4;
        tile.samples.push_back(static_cast<Sample>(sample));
      }
    }
  }
  return tile;
}

template <class Sample>
class BlockPredictor : public testing::Test {};
using SampleTypes = testing::Types<std::uint8_t, std::uint16_t>;
TYPED_TEST_SUITE(BlockPredictor, SampleTypes);

TYPED_TEST(BlockPredictor, ResidualsAreTheFormulasAndTheChoiceIsTheSmallest) {
  std::mt19937 random(3);
  StripPredictor<TypeParam> predictor;
  for (int i = 0; i < 60; ++i) {
    const Tile<TypeParam> tile = random_tile<TypeParam>(random);
    predictor.begin(tile.width, tile.height);
    std::vector<Predictor> choices((tile.width + kBlock - 1) / kBlock);
    for (std::uint32_t f = 0; f < tile.frames; ++f) {
      const std::size_t frame = std::size_t{tile.width} * tile.height;
      predictor.next_frame(std::span(tile.samples).subspan(f * frame, frame), 0);
      for (std::uint32_t strip = 0; strip * kBlock < tile.height; ++strip) {
        predictor.predict(strip, choices);
        const std::uint32_t bottom = std::min(tile.height, (strip + 1) * kBlock);
        for (std::size_t b = 0; b < choices.size(); ++b) {
          const auto left = static_cast<std::uint32_t>(b * kBlock),
                     right = std::min(tile.width, left + kBlock);
          std::array<std::uint64_t, kPredictors> cost{};
          for (std::uint32_t y = strip * kBlock; y < bottom; ++y) {
            for (std::uint32_t x = left; x < right; ++x) {
              ASSERT_EQ(predictor.residuals(y % kBlock)[x], tile.residual(choices[b], f, y, x));
              for (std::size_t k = 0; k < kPredictors; ++k) {
                cost[k] += tile.residual(static_cast<Predictor>(k), f, y, x);
              }
            }
          }
          const auto kind = static_cast<std::size_t>(choices[b]);
          if (choices[b] == Predictor::kCopy) {
            EXPECT_EQ(cost[1], 0u);
          } else {
            EXPECT_NE(cost[1], 0u);
            EXPECT_EQ(cost[kind], std::ranges::min(cost));
          }
        }
      }
    }
  }
}

TYPED_TEST(BlockPredictor, RestoresSamplesWhateverTheBlocksChose) {
  std::mt19937 random(4);
  StripRestorer<TypeParam> restorer;
  for (int i = 0; i < 120; ++i) {
    const Tile<TypeParam> tile = random_tile<TypeParam>(random);
    restorer.begin(tile.width, tile.height);
    std::vector<Predictor> choices((tile.width + kBlock - 1) / kBlock);
    for (std::uint32_t f = 0; f < tile.frames; ++f) {
      restorer.next_frame();
      for (std::uint32_t strip = 0; strip * kBlock < tile.height; ++strip) {
        for (Predictor& choice : choices) choice = static_cast<Predictor>(random() % kPredictors);
        const std::uint32_t bottom = std::min(tile.height, (strip + 1) * kBlock);
        for (std::uint32_t y = strip * kBlock; y < bottom; ++y) {
          for (std::uint32_t x = 0; x < tile.width; ++x) {
            restorer.residuals(y % kBlock)[x] = tile.residual(choices[x / kBlock], f, y, x);
          }
        }
        restorer.restore(strip, choices);
        for (std::uint32_t y = strip * kBlock; y < bottom; ++y) {
          for (std::uint32_t x = 0; x < tile.width; ++x) {
            ASSERT_EQ(restorer.samples(y % kBlock)[x], tile.at(f, y, x)) << f << ' ' << y << ' ' << x;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace freshet::store
