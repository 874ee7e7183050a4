#include "synth/scene/layers/bayesian_matting.h"

#include <gtest/gtest.h>

#include "tests/synth/scene/layers/made_layers.h"

namespace freshet::synth::scene {
namespace {

struct Made {
  cv::Mat picture, alpha, front, behind, trimap;
};

Made two_textures() {
  const cv::Size size(90, 80);
  Made made{{},
            made_disc(size, {45, 40}, 22, 8),
            made_texture(size, {0.15, 0.3, 0.8}, 0.25f, 1),
            made_texture(size, {0.7, 0.5, 0.2}, 0.25f, 2),
            {}};
  made.picture = made_over(made.front, made.alpha, made.behind);
  made.trimap = made_trimap(made.alpha, 3);
  return made;
}

TEST(BayesianMatting, FindsAlphaAndForeground) {
  const Made made = two_textures();
  const Matting found = bayesian_matting(made.picture, made.trimap);
  const cv::Mat unsure = made.trimap == 128;
  EXPECT_LT(cv::norm(found.alpha, made.alpha, cv::NORM_L1, unsure) / cv::countNonZero(unsure), 0.04);
  const cv::Mat mixed = (made.alpha > 0.3) & (made.alpha < 0.7);
  EXPECT_LT(cv::norm(found.foreground, made.front, cv::NORM_L2, mixed),
            0.35 * cv::norm(made.picture, made.front, cv::NORM_L2, mixed));
}

TEST(BayesianMatting, KeepsWhatTheTrimapSays) {
  const Made made = two_textures();
  const Matting found = bayesian_matting(made.picture, made.trimap);
  EXPECT_EQ(cv::countNonZero((made.trimap == 255) & (found.alpha != 1)), 0);
  EXPECT_EQ(cv::countNonZero((made.trimap == 0) & (found.alpha != 0)), 0);
  EXPECT_EQ(cv::norm(found.foreground, made.picture, cv::NORM_INF, made.trimap == 255), 0);
}

TEST(BayesianMatting, AKnownAlphaComesBackWithColoursThatGiveThePicture) {
  const Made made = two_textures();
  const Matting found = estimate_colours(made.picture, made.alpha);
  EXPECT_EQ(cv::norm(found.alpha, made.alpha, cv::NORM_INF), 0);
  const cv::Mat soft = (made.alpha > 0.1) & (made.alpha < 0.9);
  EXPECT_LT(
      cv::norm(made_over(found.foreground, found.alpha, found.background), made.picture, cv::NORM_L2, soft) /
          std::sqrt(3.0 * cv::countNonZero(soft)),
      0.02);
}

TEST(BayesianMatting, ATrimapWithoutEitherSideIsBorne) {
  const Made made = two_textures();
  for (const int value : {255, 0, 128}) {
    cv::Mat trimap = made.trimap.clone();
    trimap.setTo(128, trimap != value);
    const Matting found = bayesian_matting(made.picture, trimap);
    EXPECT_TRUE(cv::checkRange(found.alpha, true, nullptr, 0, 1.0001));
    EXPECT_TRUE(cv::checkRange(found.foreground));
  }
}

}  // namespace
}  // namespace freshet::synth::scene
