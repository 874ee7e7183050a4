#include "synth/transfer/features.h"

#include <gtest/gtest.h>

#include "platform/random.h"
#include "platform/vectors.h"

namespace freshet::synth::transfer {
namespace {

Features random_features(int width, int height, std::uint64_t seed) {
  const Random random(seed, 0);
  Features out(width, height);
  PixelGrid now(width, height), previous(width, height);
  Grid alpha(width, height);
  std::uint64_t at = 0;
  for (Pixel& pixel : now.values)
    for (float& value : pixel.c) value = random.at(at++);
  for (Pixel& pixel : previous.values)
    for (float& value : pixel.c) value = random.at(at++);
  for (float& value : alpha.values) value = random.at(at++);
  put_now(now, out);
  put_previous(previous, out);
  put_blurred_alpha(alpha, 16, out);
  return out;
}

TEST(TransferFeatures, VectorsOfAnyWidthGiveTheSameSums) {
  const Features a = random_features(23, 19, 1), b = random_features(31, 17, 2);
  for (const int patch : {3, 5, 7, 9})
    for (const int bytes : {16, 32, 64}) {
      if (bytes > vector_bytes()) continue;
      const auto fast = PatchDistance::kernel(patch, bytes), plain = PatchDistance::kernel(patch, 0);
      for (int k = 0; k <= 17 - patch; ++k) {  // the last one ends where the picture ends
        const std::int16_t* of_a = a.values.data() + ((19 - patch - k) * 23 + (23 - patch)) * kChannels;
        const std::int16_t* of_b = b.values.data() + (k * 31 + (31 - patch)) * kChannels;
        const auto x = fast(of_a, 23 * kChannels, of_b, 31 * kChannels);
        const auto y = plain(of_a, 23 * kChannels, of_b, 31 * kChannels);
        ASSERT_EQ(x.now, y.now) << patch << ' ' << bytes;
        ASSERT_EQ(x.previous, y.previous) << patch << ' ' << bytes;
      }
    }
}

TEST(TransferFeatures, DistanceIsEquationNine) {
  PixelGrid one(5, 5), other(5, 5), before(5, 5);
  Grid alpha(5, 5);
  for (Pixel& pixel : one.values) pixel = {{0.5f, 0.25f, 0.75f, 1.0f}};
  Features source(5, 5), target(5, 5);
  put_now(one, source);
  put_now(other, target);
  put_previous(one, source);
  put_previous(before, target);
  for (float& value : alpha.values) value = 0.5f;
  put_blurred_alpha(alpha, 2, source);
  const std::vector<float> lambda(25, 0.3f);
  const double colours = 0.25 + 0.0625 + 0.5625 + 3;
  EXPECT_NEAR(PatchDistance(source, target, lambda, 5)(12, 12), 25 * (colours + 2 * 0.25 + 0.3 * colours),
              0.2);
}

TEST(TransferFeatures, GuidesOfTheCentreCountAsThoseOfAllPixels) {
  Features source(5, 5), target(5, 5);
  const std::vector<float> lambda(25, 0.0f);
  const TransferOptions options{.curvature = 2, .divergence = 3};
  put_guides({Grid(5, 5, 0.5f), Grid(5, 5, -0.25f)}, options, source);
  put_guides({Grid(5, 5, 0.25f), Grid(5, 5, 0.25f)}, options, target);
  EXPECT_NEAR(PatchDistance(source, target, lambda, 5)(12, 12), 25 * (2 * 0.0625 + 3 * 0.25), 1e-4);
}

TEST(TransferFeatures, TheLargestSumFits) {
  PixelGrid white(9, 9), black(9, 9);
  for (Pixel& pixel : white.values) pixel = {{1, 1, 1, 1}};
  Features source(9, 9), target(9, 9);
  put_now(white, source);
  put_previous(white, source);
  put_blurred_alpha(Grid(9, 9, 1.0f), 16, source);
  const std::vector<float> lambda(81, 1.0f);
  EXPECT_NEAR(PatchDistance(source, target, lambda, 9)(40, 40), 81 * (6 + 16 + 6), 2);
}

}  // namespace
}  // namespace freshet::synth::transfer
