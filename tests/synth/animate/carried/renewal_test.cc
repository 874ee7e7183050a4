#include "synth/animate/carried/renewal.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/synth/animate/flowing_clip.h"

namespace freshet::synth::animate {
namespace {

const cv::Size kPicture(192, 96);
constexpr double kFps = 25;
const std::vector<int> kSamples{2, 5, 8, 11};

FlowingClip renewed_by(double anew, std::uint64_t seed) {
  const double kept = std::pow(0.5, 1 / (RenewalOptions{}.half_life_s * kFps));
  return {.size = {192, 144}, .steady = {2, -1}, .varying = 0, .seed = seed, .anew = anew, .kept = kept};
}

/// The left half of the picture from one clip, the right half from another.
Placement halves(store::ClipId left, store::ClipId right) {
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  for (int y = 0; y + 48 <= kPicture.height; y += 24)
    for (int x = 0; x + 48 <= kPicture.width; x += 24)
      placement.patches.push_back(
          {.piece = {x, y}, .clip = x < 72 ? left : right, .variant = {}, .patch = {x % 96, y}, .speed = 1});
  return placement;
}

struct Measured {
  std::vector<double> shares;
  double overall = 0;
  std::vector<double> of_picture;
  cv::Mat places;
};

Measured measured(double left, double right, const RenewalOptions& options = {}) {
  const std::vector<FlowingClip> clips{renewed_by(left, 1), renewed_by(right, 2)};
  const FlowingStore store(clips);
  const Placement placement = halved(halves(store.id(0), store.id(1)));
  const PiecesCanvas canvas(placement, kPicture);
  Blender blender(placement, 12, {});
  cv::Mat luma(kPicture, CV_32F);
  cv::RNG(7).fill(luma, cv::RNG::UNIFORM, 0, 1);
  Renewal renewal(placement, canvas, luma, blender, kFps, options);
  for (std::size_t clip = 0; clip < clips.size(); ++clip) {
    std::vector<std::size_t> patches;
    for (std::size_t p = 0; p < placement.patches.size(); ++p)
      if (placement.patches[p].clip == store.id(clip)) patches.push_back(p);
    ClipLayer layer(store.snapshot(), store.id(clip), clips[clip].flow_step, placement, patches,
                    {.frames = 12}, Resampling::kFlow, ClipDetail::kInnovation);
    renewal.measure(layer, kSamples);
  }
  renewal.settle();
  Measured found{.shares = {}, .overall = renewal.overall(), .of_picture = {}, .places = renewal.places()};
  for (std::size_t level = 0; level < Renewal::kLevels; ++level) found.shares.push_back(renewal.share(level));
  for (int level = 0; level < 8; ++level) found.of_picture.push_back(renewal.share_of_picture(level));
  return found;
}

TEST(Renewal, FindsHowMuchOfAClipComesAnew) {
  for (const double anew : {0.05, 0.2, 0.4}) {
    const Measured found = measured(anew, anew);
    EXPECT_NEAR(found.shares[1], anew * 2 / 3, 0.15 * anew + 0.01) << anew;
    EXPECT_NEAR(found.shares[0], anew / 3, 0.15 * anew + 0.01) << anew;
  }
}

TEST(Renewal, OfWhatOnlyMovesNothingComesAnew) {
  const Measured found = measured(0, 0);
  for (const double share : found.shares) EXPECT_LT(share, 0.02);
  EXPECT_LT(found.overall, 0.02);
}

TEST(Renewal, APlaceRenewsAsItsPatchesDo) {
  const Measured found = measured(0.05, 0.35);
  const double left = found.places.at<float>(24, 12) * found.shares[1],
               right = found.places.at<float>(24, 84) * found.shares[1];
  EXPECT_NEAR(left, 0.05 * 2 / 3, 0.03);
  EXPECT_NEAR(right, 0.35 * 2 / 3, 0.06);
}

TEST(Renewal, ThePicturesBandsAreTheCanvassAtHalfTheSize) {
  const Measured found = measured(0.2, 0.2);
  EXPECT_EQ(found.of_picture[0], 0);
  for (std::size_t level = 0; level < Renewal::kLevels; ++level)
    EXPECT_EQ(found.of_picture[level + 1], found.shares[level]);
  for (std::size_t level = Renewal::kLevels + 1; level < found.of_picture.size(); ++level)
    EXPECT_EQ(found.of_picture[level], 0);
}

TEST(Renewal, TakesWhatIsAskedOfIt) {
  const Measured all = measured(0.3, 0.3), half = measured(0.3, 0.3, {.share = 0.5}),
                 none = measured(0.3, 0.3, {.share = 0});
  EXPECT_NEAR(half.shares[1], all.shares[1] / 2, 1e-9);
  EXPECT_EQ(none.shares[1], 0);
  EXPECT_EQ(cv::countNonZero(none.places), 0);
}

}  // namespace
}  // namespace freshet::synth::animate
