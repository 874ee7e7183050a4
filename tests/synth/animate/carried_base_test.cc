#include "synth/animate/carried_base.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth {
namespace {

constexpr int kWidth = 160, kHeight = 96;
constexpr double kFps = 25;

double stripes(double x, double y) { return 0.5 + 0.25 * std::sin(x / 5) + 0.15 * std::cos(y / 7); }

cv::Mat picture() {
  cv::Mat luma(kHeight, kWidth, CV_32F);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) luma.at<float>(y, x) = static_cast<float>(stripes(x, y));
  return luma;
}
cv::Mat bgr_of(const cv::Mat& luma) {
  cv::Mat bgr;
  cv::merge(std::vector<cv::Mat>(3, luma), bgr);
  return bgr;
}
cv::Mat whole() { return cv::Mat(kHeight, kWidth, CV_32F, cv::Scalar(1)); }
cv::Mat motion(float u, float v) { return cv::Mat(kHeight, kWidth, CV_32FC2, cv::Scalar(u, v)); }
cv::Mat grey(double level) { return cv::Mat(kHeight, kWidth, CV_32F, cv::Scalar(level)); }

const cv::Rect kMiddle(50, 30, 60, 36);

TEST(CarriedBase, WithoutMotionIsThePicture) {
  const CarriedBase base(bgr_of(picture()), picture(), whole(), grey(0.1), motion(0, 0), kFps, {});
  for (const int i : {0, 3, 25}) EXPECT_LT(cv::norm(base.frame(i), picture(), cv::NORM_INF), 1e-5);
}

TEST(CarriedBase, IsThreeCopiesEachCarriedByItsAge) {
  const CarriedBaseOptions options{.share = 1, .life_s = 0.6, .max_px = 100, .edge_px = 1};
  const CarriedBase base(bgr_of(picture()), picture(), whole(), grey(0.1), motion(40, -20), kFps, options);
  constexpr int kLife = 15;
  for (int i = 0; i < 2 * kLife; ++i) {
    const cv::Mat frame = base.frame(i);
    double worst = 0;
    for (int y = kMiddle.y; y < kMiddle.br().y; ++y)
      for (int x = kMiddle.x; x < kMiddle.br().x; ++x) {
        double expected = 0;
        for (int copy = 0; copy < 3; ++copy) {
          const int age = (i + copy * 5 + kLife / 2) % kLife - kLife / 2;  // frames from its own place
          const double weight = (1 + std::cos(2 * std::numbers::pi * age / kLife)) / 3;
          expected += weight * stripes(x - 40 * age / kFps, y + 20 * age / kFps);
        }
        worst = std::max(worst, std::abs(expected - frame.at<float>(y, x)));
      }
    EXPECT_LT(worst, 4e-3) << i;
  }
}

TEST(CarriedBase, LongLivesAreSampledAndLookTheSame) {
  // 240 frames a second, 450 frames of life: a map every five of them.
  const CarriedBase fast(bgr_of(picture()), picture(), whole(), grey(0.1), motion(20, 10), 240,
                         {.share = 1, .life_s = 1.875});
  const CarriedBase slow(bgr_of(picture()), picture(), whole(), grey(0.1), motion(20, 10), 24,
                         {.share = 1, .life_s = 1.875});
  for (const int i : {0, 7, 20, 33})
    EXPECT_LT(cv::norm(fast.frame(10 * i)(kMiddle), slow.frame(i)(kMiddle), cv::NORM_INF), 0.02) << i;
}

TEST(CarriedBase, NeitherLevelNorContrastPulses) {
  cv::Mat noise(kHeight, kWidth, CV_32F), coarse;
  cv::RNG random(3);
  random.fill(noise, cv::RNG::UNIFORM, 0.2, 0.8);
  const CarriedBase base(bgr_of(noise), noise, whole(), grey(0.5), motion(60, 0), kFps,
                         {.share = 1, .life_s = 1.2});
  double least = 1, most = 0;
  for (int i = 0; i < 30; ++i) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(base.frame(i)(kMiddle), mean, deviation);
    EXPECT_NEAR(mean[0], 0.5, 0.02);
    least = std::min(least, deviation[0]);
    most = std::max(most, deviation[0]);
  }
  EXPECT_LT(most / least, 1.2);
}

TEST(CarriedBase, BringsTheColoursAlong) {
  // Red on the left, blue on the right, equally bright, going right: the border passes the middle.
  cv::Mat luma = grey(0.4), bgr(kHeight, kWidth, CV_32FC3);
  const cv::Vec3f red(0.4f, 0.4f - 0.3f * 0.299f / 0.587f, 0.7f),
      blue(0.7f, 0.4f - 0.3f * 0.114f / 0.587f, 0.4f);
  bgr(cv::Rect(0, 0, 80, kHeight)).setTo(cv::Scalar(red[0], red[1], red[2]));
  bgr(cv::Rect(80, 0, 80, kHeight)).setTo(cv::Scalar(blue[0], blue[1], blue[2]));
  const CarriedBase base(bgr, luma, whole(), grey(0.1), motion(25, 0), kFps, {.share = 1, .life_s = 1.2});
  cv::Mat colour;
  base.frame(0, &colour);
  ASSERT_EQ(colour.type(), CV_32FC4);
  const cv::Vec4f left = colour.at<cv::Vec4f>(48, 40), right = colour.at<cv::Vec4f>(48, 120);
  EXPECT_NEAR(left[0], 0.4, 1e-3);
  EXPECT_NEAR(left[2], 0.3, 1e-3);  // red less luma
  EXPECT_NEAR(left[1], 0, 1e-3);
  EXPECT_NEAR(right[1], 0.3, 1e-3);  // blue less luma
  EXPECT_NEAR(right[3], 1, 0.02);
  // Some copies of the border have gone ten pixels on, others have yet to come: a mixture lies between.
  const cv::Vec4f middle = colour.at<cv::Vec4f>(48, 84);
  EXPECT_GT(middle[2], 0.02);
  EXPECT_GT(middle[1], 0.02);
}

TEST(CarriedBase, BringsNothingThatIsNotFluid) {
  cv::Mat luma = picture(), matte = whole();
  luma(cv::Rect(0, 0, kWidth, 30)).setTo(100);  // rock, and it would be seen
  matte(cv::Rect(0, 0, kWidth, 30)).setTo(0);
  const CarriedBase base(bgr_of(luma), luma, matte, grey(0.5), motion(0, 100), kFps,
                         {.share = 1, .life_s = 1});
  for (int i = 0; i < 25; ++i) {
    double most = 0;
    cv::minMaxLoc(base.frame(i)(cv::Rect(0, 31, kWidth, kHeight - 31)), nullptr, &most);
    EXPECT_LT(most, 1.5) << i;
  }
}

TEST(CarriedBase, RepeatsInALoopOfAnyLengthAndIsCarriedInAll) {
  for (const int loop : {50, 51, 97, 7, 500}) {
    const CarriedBaseOptions options{
        .share = 1, .life_s = 0.8, .max_px = 1000, .edge_px = 1, .loop_frames = loop};
    const CarriedBase base(bgr_of(picture()), picture(), whole(), grey(0.5), motion(30, 10), kFps, options);
    for (const int i : {0, 1, 5})
      EXPECT_EQ(cv::norm(base.frame(i), base.frame(i + loop), cv::NORM_INF), 0) << loop;
    EXPECT_GT(cv::norm(base.frame(0)(kMiddle), base.frame(2)(kMiddle), cv::NORM_INF), 0.01) << loop;
  }
}

TEST(CarriedBase, WhereItIsTooFastTheExposureShows) {
  const CarriedBase base(bgr_of(picture()), picture(), whole(), grey(0.25), motion(2000, 0), kFps,
                         {.share = 1, .life_s = 1, .max_px = 50});
  EXPECT_EQ(cv::norm(base.frame(4), grey(0.25), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::synth
