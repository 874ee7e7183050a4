#include "synth/animate/still/lost_contrast.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
namespace {

constexpr int kWidth = 160, kHeight = 96, kStep = 4;
const LostContrastOptions kWhole{.max_gain = 2};  // all that two copies lose comes back

cv::Mat noise(int seed) {
  cv::Mat luma(kHeight, kWidth, CV_32F);
  cv::RNG random(seed);
  random.fill(luma, cv::RNG::NORMAL, 0.5, 0.1);
  return luma;
}

/// Two copies whose sources lie `apart` px from each other: both show in the left half, one in the right.
std::vector<CopyMap> two_copies(float apart) {
  const cv::Size size(kWidth / kStep, kHeight / kStep);
  std::vector<CopyMap> copies{
      {cv::Mat(size, CV_32F, cv::Scalar(1)), cv::Mat(size, CV_32FC2, cv::Scalar(300, 0))},
      {cv::Mat(size, CV_32F, cv::Scalar(0)), cv::Mat(size, CV_32FC2, cv::Scalar(300 + apart, 0))}};
  for (CopyMap& copy : copies) copy.weight.colRange(0, size.width / 2).setTo(0.5);
  return copies;
}
/// One copy whose source lies `away` px from every place.
std::vector<CopyMap> one_copy(float away) {
  const cv::Size size(kWidth / kStep, kHeight / kStep);
  return {{cv::Mat(size, CV_32F, cv::Scalar(1)), cv::Mat(size, CV_32FC2, cv::Scalar(away, 0))}};
}
/// What such copies show of two textures.
cv::Mat half_mixed(const cv::Mat& one, const cv::Mat& other) {
  cv::Mat out = one.clone(), left = out.colRange(0, kWidth / 2);
  left = 0.5 * left + 0.5 * other.colRange(0, kWidth / 2);
  return out;
}

double deviation_of(const cv::Mat& luma) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(luma, mean, deviation);
  return deviation[0];
}
double deviation(const cv::Mat& luma) { return deviation_of(luma(cv::Rect(20, 20, 120, 56))); }
/// Of the half where two copies show, in that of the other.
double left_of_right(const cv::Mat& luma) {
  return deviation_of(luma(cv::Rect(10, 10, 60, 76))) / deviation_of(luma(cv::Rect(90, 10, 60, 76)));
}

/// By level what stands of a picture, all of it fluid.
StandingDetail standing_of(const cv::Mat& luma,
                           const std::vector<double>& shares = std::vector<double>(6, 0.0)) {
  cv::Mat picture;
  cv::merge(std::vector<cv::Mat>{luma, luma, luma}, picture);
  const cv::Mat matte(luma.size(), CV_32F, cv::Scalar(1));
  return {fluid_planes(picture, luma, matte), matte, shares};
}

TEST(LostContrast, OfCopiesThatDoNotAgreeComesBackWhereItWasLost) {
  cv::Mat mixed = half_mixed(noise(1), noise(2));
  EXPECT_NEAR(left_of_right(mixed), 1 / std::sqrt(2.0), 0.03);
  restore_contrast(mixed, two_copies(100), kStep, {}, {}, standing_of(noise(1)), 1, kWhole);
  EXPECT_NEAR(left_of_right(mixed), 1, 0.06);
  EXPECT_NEAR(deviation(mixed), 0.1, 0.006);
}

TEST(LostContrast, OfCopiesThatAgreeThereIsNone) {
  cv::Mat same = noise(1);
  restore_contrast(same, two_copies(0), kStep, {}, {}, standing_of(same), 1, {});
  EXPECT_LT(cv::norm(same, noise(1), cv::NORM_INF), 1e-5);
}

TEST(LostContrast, CoarseDetailAgreesLongerThanFine) {
  // Sources three pixels apart: the finest band is unlike, detail of 32 px nearly the same.
  cv::Mat fine = noise(1), coarse;
  cv::GaussianBlur(noise(2), coarse, {}, 12);
  coarse = 0.5 + 20 * (coarse - 0.5);
  const double before_fine = left_of_right(fine), before = left_of_right(coarse);
  restore_contrast(fine, two_copies(3), kStep, {}, {}, standing_of(fine), 1, kWhole);
  restore_contrast(coarse, two_copies(3), kStep, {}, {}, standing_of(coarse), 1, kWhole);
  EXPECT_GT(left_of_right(fine) / before_fine, 1.25);
  EXPECT_NEAR(left_of_right(coarse) / before, 1, 0.06);
}

TEST(LostContrast, AsAWholeIsThePictures) {
  // Half as strong again, everywhere: what comes out has the picture's contrast, and its level.
  const cv::Mat still = noise(1);
  cv::Mat strong = 0.5 + 1.35 * (noise(2) - 0.5);
  restore_contrast(strong, one_copy(100), kStep, {}, {}, standing_of(still), 1, {});
  EXPECT_NEAR(deviation(strong), 0.1, 0.004);
  EXPECT_NEAR(cv::mean(strong)[0], 0.5, 0.004);
}

TEST(LostContrast, LeavesRoomForWhatComesAnew) {
  cv::Mat luma = noise(1);
  const double before = deviation(luma);
  restore_contrast(luma, two_copies(0), kStep, std::vector<double>(5, 0.36), {}, standing_of(noise(1)), 1,
                   {});
  EXPECT_NEAR(deviation(luma) / before, 0.8, 0.02);
  cv::Mat calm = noise(1);
  restore_contrast(calm, two_copies(0), kStep, std::vector<double>(5, 0.36),
                   cv::Mat(kHeight / kStep, kWidth / kStep, CV_32F, cv::Scalar(0)), standing_of(noise(1)), 1,
                   {});
  EXPECT_NEAR(deviation(calm) / before, 1, 1e-3);
}

double correlation(const cv::Mat& a, const cv::Mat& b) {
  const cv::Rect inside(20, 20, 120, 56);
  const cv::Mat from = a(inside) - cv::mean(a(inside))[0], to = b(inside) - cv::mean(b(inside))[0];
  return from.dot(to) / std::sqrt(from.dot(from) * to.dot(to));
}

TEST(StandingDetail, TakesItsPlaceAndLeavesTheContrast) {
  for (const double share : {0.3, 0.7}) {
    const cv::Mat still = noise(1);
    const StandingDetail standing = standing_of(still, std::vector<double>(6, share));
    cv::Mat luma = noise(2);  // what a copy from far away brings
    restore_contrast(luma, one_copy(100), kStep, {}, {}, standing, 1, {});
    EXPECT_NEAR(correlation(luma, still), share, 0.06);
    EXPECT_NEAR(deviation(luma), 0.1, 0.006);
  }
}

TEST(StandingDetail, OfWhatHasNotMovedIsAllThere) {
  const cv::Mat still = noise(1);
  const StandingDetail standing = standing_of(still, {0.1, 0.3, 0.5, 0.7, 0.9, 1});
  cv::Mat luma = still.clone();
  restore_contrast(luma, one_copy(0), kStep, {}, {}, standing, 1, {});
  EXPECT_LT(cv::norm(luma, still, cv::NORM_INF), 1e-5);
}

TEST(StandingDetail, GoesOnWhereItHasHardlyMoved) {
  // Half a pixel away all agrees with itself: the place shows what was carried there, not a mixture with what was
  // there.
  cv::Mat still, moved;
  cv::GaussianBlur(noise(3), still, {}, 12);
  cv::warpAffine(still, moved, cv::Matx23d(1, 0, 0.5, 0, 1, 0), still.size(), cv::INTER_CUBIC,
                 cv::BORDER_REFLECT_101);
  cv::Mat luma = moved.clone();
  restore_contrast(luma, one_copy(0.5), kStep, {}, {}, standing_of(still, {0.5, 0.5, 0.5, 0.5, 0.5, 0}), 0,
                   {});
  const cv::Rect inside(20, 20, 120, 56);
  EXPECT_LT(cv::norm(luma(inside), moved(inside)), 0.15 * cv::norm(still(inside), moved(inside)));
}

TEST(StandingDetail, LeavesTheStillAsItIs) {
  // Stronger than the picture by a half, and nothing has begun.
  cv::Mat strong = 0.5 + 1.5 * (noise(1) - 0.5);
  const cv::Mat before = strong.clone();
  restore_contrast(strong, one_copy(0), kStep, {}, {}, standing_of(noise(1)), 0, {});
  EXPECT_LT(cv::norm(strong, before, cv::NORM_INF), 1e-5);
}

TEST(StandingDetail, HoldsTheCoarseAloneWhereThatIsWhatStands) {
  cv::Mat coarse, other;
  cv::GaussianBlur(noise(3), coarse, {}, 16);
  cv::GaussianBlur(noise(4), other, {}, 16);
  const cv::Mat light = 0.5 + 40 * (coarse - 0.5), still = light + noise(1) - 0.5;
  const StandingDetail standing = standing_of(still, {0, 0, 0, 1, 1, 1});
  cv::Mat luma = 0.5 + 40 * (other - 0.5) + noise(2) - 0.5, low;
  restore_contrast(luma, one_copy(100), kStep, {}, {}, standing, 1, {});
  cv::GaussianBlur(luma, low, {}, 8);
  EXPECT_GT(correlation(low, light), 0.95);
  EXPECT_LT(std::abs(correlation(luma - low, noise(1))), 0.15);
}

}  // namespace
}  // namespace freshet::synth::animate
