#include "synth/animate/still/glitter.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "synth/animate/still/colour_model.h"

namespace freshet::synth::animate {
namespace {

constexpr int kWidth = 640, kHeight = 200, kStep = 4;
const cv::Rect kPath(240, 30, 160, 140);    // where the light stands
const cv::Rect kMiddle(270, 60, 100, 80);   // well within it
const cv::Rect kBeside(20, 30, 120, 140);   // beside it
const cv::Scalar kWater(0.15, 0.12, 0.06);  // green and blue
const cv::Scalar kLight(0.55, 0.85, 0.95);  // yellow

/// Dashes of light on water, of this size.
cv::Mat glittering(cv::Size dash = {9, 2}, const cv::Scalar& light = kLight,
                   const cv::Scalar& water = kWater) {
  cv::Mat picture(kHeight, kWidth, CV_32FC3, water);
  cv::RNG random(3);
  for (int i = 0; i < 400; ++i) {
    const cv::Point at(random.uniform(kPath.x, kPath.br().x), random.uniform(kPath.y, kPath.br().y));
    picture(cv::Rect(at, dash)) = light;
  }
  return picture;
}

Glitter found(const cv::Mat& picture, double share = 1) {
  return {picture, luma_of(picture), cv::Mat(picture.size(), CV_32F, cv::Scalar(1)), share};
}

CopyMap copy_of(double weight) {
  const cv::Size samples(kWidth / kStep, kHeight / kStep);
  return {cv::Mat(samples, CV_32F, cv::Scalar(weight)), cv::Mat::zeros(samples, CV_32FC2)};
}

double mean(const cv::Mat& values, const cv::Rect& where) { return cv::mean(values(where))[0]; }

double deviation(const cv::Mat& values, const cv::Rect& where) {
  cv::Scalar mean, found;
  cv::meanStdDev(values(where), mean, found);
  return found[0];
}

/// What lights the ground when copies bring this.
cv::Mat lit(const Glitter& glitter, const cv::Mat& texture, const std::vector<CopyMap>& copies) {
  cv::Mat luma = glitter.ground_luma().clone();
  glitter.add(texture, copies, kStep, luma, nullptr);
  return luma;
}

cv::Mat moved(const cv::Mat& texture, int right) {
  cv::Mat out;
  cv::warpAffine(texture, out, cv::Matx23d(1, 0, right, 0, 1, 0), texture.size(), cv::INTER_NEAREST,
                 cv::BORDER_WRAP);
  return out;
}

TEST(Glitter, IsPartedFromTheWaterThatItLiesOn) {
  const Glitter glitter = found(glittering());
  ASSERT_TRUE(glitter.any());
  EXPECT_GT(mean(glitter.where(), kMiddle), 0.95);
  EXPECT_EQ(mean(glitter.where(), kBeside), 0);
  EXPECT_EQ(cv::norm(glitter.ground()(kBeside), glittering()(kBeside), cv::NORM_INF), 0);
  const cv::Scalar ground = cv::mean(glitter.ground()(kMiddle));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(ground[k], kWater[k], 0.04) << "its own colour, not the light's";
  EXPECT_NEAR(glitter.size_px(), 4, 1.5);
}

TEST(Glitter, IsStrongLevelAndBright) {
  EXPECT_FALSE(found(glittering({2, 9})).any()) << "upright, as in a fall";
  EXPECT_FALSE(found(glittering({4, 4})).any()) << "neither, as drops are";
  EXPECT_FALSE(found(glittering({9, 2}, kWater + cv::Scalar::all(0.15))).any()) << "faint";
  EXPECT_FALSE(found(glittering({9, 2}, cv::Scalar::all(1), cv::Scalar::all(0.6))).any())
      << "on light ground";
  EXPECT_FALSE(found(cv::Mat(kHeight, kWidth, CV_32FC3, kWater)).any());
  EXPECT_FALSE(found(glittering(), 0).any());
}

TEST(Glitter, AGlintByItselfHasNoRim) {
  cv::Mat picture = glittering();
  picture(cv::Rect(500, 100, 22, 6)) = kLight;
  const cv::Rect around(450, 60, 120, 90);
  const cv::Mat where = found(picture).where()(around);
  cv::Mat across, down;
  cv::Sobel(where, across, CV_32F, 1, 0, 3, 1 / 8.);
  cv::Sobel(where, down, CV_32F, 0, 1, 3, 1 / 8.);
  EXPECT_GT(where.at<float>(43, 60), 0.3f);
  EXPECT_LT(cv::norm(across, cv::NORM_INF), 0.08);
  EXPECT_LT(cv::norm(down, cv::NORM_INF), 0.08);
}

TEST(Glitter, NothingDoesWhereItIsLittleOfTheLight) {
  cv::Mat picture = glittering();
  // Upright things that are as bright.
  for (int x = 16; x + 4 < kWidth; x += 8)
    for (int y = 8; y + 14 < kHeight; y += 18)
      if (x > kWidth / 2 || !kPath.contains({x, y})) picture(cv::Rect(x, y, 4, 14)) = cv::Scalar::all(0.95);
  EXPECT_FALSE(found(picture).any());
}

TEST(Glitter, WithItsOwnSparklesItIsTheStill) {
  const cv::Mat picture = glittering();
  const Glitter glitter = found(picture);
  const cv::Mat frame = lit(glitter, glitter.texture(), {copy_of(1)});
  EXPECT_LT(cv::norm(frame(kMiddle), luma_of(picture)(kMiddle), cv::NORM_INF), 0.03);
}

TEST(Glitter, SparklesTakeTheStrengthOfThePlaceWhereTheyAreLit) {
  cv::Mat picture = glittering();
  const cv::Rect left(270, 60, 40, 80), right(335, 60, 40, 80);
  picture.colRange(kWidth / 2, kWidth) = 0.5 * picture.colRange(kWidth / 2, kWidth) + kWater * 0.5;
  const Glitter glitter = found(picture);
  const cv::Mat luma = luma_of(picture), frame = lit(glitter, moved(glitter.texture(), 40), {copy_of(1)});
  EXPECT_NEAR(mean(frame, left) / mean(luma, left), 1, 0.25);
  EXPECT_NEAR(mean(frame, right) / mean(luma, right), 1, 0.1);
  double brightest = 0;
  cv::minMaxLoc(frame(right), nullptr, &brightest);
  EXPECT_LT(brightest, 0.85) << "no brighter than those around it";
}

TEST(Glitter, AsMuchIsLitAsThePlaceHas) {
  cv::Mat picture = glittering();
  const cv::Rect right(350, 60, 30, 80);
  const cv::Mat whole = picture.clone();
  picture.colRange(kWidth / 2, kWidth) = kWater;
  // A third of the rows keep theirs.
  for (int y = 0; y < kHeight; y += 6)
    whole(cv::Rect(kWidth / 2, y, kWidth / 2, 2)).copyTo(picture(cv::Rect(kWidth / 2, y, kWidth / 2, 2)));
  const Glitter glitter = found(picture);
  const auto light = [&](const cv::Mat& luma) { return mean(luma - glitter.ground_luma(), right); };
  const cv::Mat frame = lit(glitter, moved(glitter.texture(), 70), {copy_of(1)});
  EXPECT_NEAR(light(frame) / light(luma_of(picture)), 1, 0.3)
      << "it comes from where three times as much is lit";
}

TEST(Glitter, MixedCopiesKeepTheirContrast) {
  const Glitter glitter = found(glittering());
  const cv::Mat one = lit(glitter, moved(glitter.texture(), 17), {copy_of(1)});
  const cv::Mat mixed = 0.5 * (moved(glitter.texture(), 17) + moved(glitter.texture(), -23));
  const cv::Mat two = lit(glitter, mixed, {copy_of(0.5), copy_of(0.5)});
  EXPECT_NEAR(deviation(two, kMiddle) / deviation(one, kMiddle), 0.85, 0.09) << ".71 without";
}

TEST(Glitter, LightBringsItsOwnColour) {
  const Glitter glitter = found(glittering());
  const auto plane = [](int rows, int cols) { return cv::Mat(cv::Mat::zeros(rows, cols, CV_16S)); };
  CarriedFrame frame{plane(kHeight, kWidth), plane(kHeight / 2, kWidth / 2), plane(kHeight / 2, kWidth / 2),
                     plane(kHeight / 2, kWidth / 2)};
  cv::Mat luma = cv::Mat::zeros(kHeight, kWidth, CV_32F);
  const std::vector<CopyMap> copies{copy_of(1)};
  glitter.add(glitter.texture(), copies, kStep, luma, &frame);
  const cv::Rect half(kMiddle.x / 2, kMiddle.y / 2, kMiddle.width / 2, kMiddle.height / 2);
  const double light = mean(luma, kMiddle), unit = CarriedFrame::kOne;
  const cv::Mat rise(1, 1, CV_32FC3, kLight - kWater);
  const double per_light = luma_of(rise).at<float>(0, 0);
  EXPECT_NEAR(mean(frame.luma, kMiddle) / unit, light, 1e-3);
  EXPECT_NEAR(mean(frame.blue, half) / unit / light, (kLight[0] - kWater[0]) / per_light - 1, 0.06);
  EXPECT_NEAR(mean(frame.red, half) / unit / light, (kLight[2] - kWater[2]) / per_light - 1, 0.06);
}

}  // namespace
}  // namespace freshet::synth::animate
