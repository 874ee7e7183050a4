#include "synth/animate/still/appearance.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
namespace {

cv::Mat texture(cv::Size size, std::uint64_t seed, double mean, double amplitude) {
  cv::Mat out(size, CV_32F);
  cv::RNG rng(seed);
  rng.fill(out, cv::RNG::NORMAL, 0, 1);
  cv::GaussianBlur(out, out, {}, 1.5);
  cv::Scalar unused, deviation;
  cv::meanStdDev(out, unused, deviation);
  return out * (amplitude / deviation[0]) + mean;
}

const cv::Size kSize(256, 192);
const cv::Mat kAll(kSize, CV_32F, cv::Scalar(1));

std::pair<double, double> statistics(const cv::Mat& picture) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(picture, mean, deviation);
  return {mean[0], deviation[0]};
}

TEST(Appearance, GivesFramesTheContrastAndLevelOfThePicture) {
  const cv::Mat target = texture(kSize, 1, 0.6, 0.10);
  std::vector<cv::Mat> frames;
  for (int i = 0; i < 6; ++i) frames.push_back(texture(kSize, 10 + i, 0.4, 0.05));
  const AppearanceModel model(target, kAll, frames, {});
  const auto [mean, deviation] = statistics(model.apply(texture(kSize, 77, 0.4, 0.05)));
  EXPECT_NEAR(mean, 0.6, 0.01);
  EXPECT_NEAR(deviation / 0.10, 1, 0.12);
}

TEST(Appearance, DoesNotAmplifyBeyondItsLimit) {
  const cv::Mat target = texture(kSize, 1, 0.5, 0.15);
  const std::vector<cv::Mat> frames{texture(kSize, 2, 0.5, 0.005)};
  cv::Mat high, mapped_high;
  const cv::Mat mapped = AppearanceModel(target, kAll, frames, {.max_gain = 2}).apply(frames[0]);
  cv::GaussianBlur(frames[0], high, {}, 1);
  cv::GaussianBlur(mapped, mapped_high, {}, 1);
  // Bands by at most 2, then the picture's own levels: far from the 30 times that a full match would take.
  EXPECT_LT(statistics(mapped - mapped_high).second, 10 * statistics(frames[0] - high).second);
}

TEST(Appearance, TreatsEveryFrameAlike) {
  // A frame that flashes stays a flash: the mean level over time is the animation's own, not the picture's.
  const cv::Mat target = texture(kSize, 1, 0.5, 0.08);
  std::vector<cv::Mat> frames;
  for (int i = 0; i < 6; ++i) frames.push_back(texture(kSize, 10 + i, 0.45 + 0.02 * i, 0.08));
  const AppearanceModel model(target, kAll, frames, {});
  double last = 0;
  for (const cv::Mat& frame : frames) {
    const double mean = statistics(model.apply(frame)).first;
    EXPECT_GT(mean, last + 0.005);
    last = mean;
  }
}

TEST(Appearance, LeavesNoGridOfRegions) {
  // A frame already like the picture is hardly changed, and not more at the borders of regions than
  // elsewhere.
  const cv::Mat target = texture(kSize, 1, 0.5, 0.08);
  const cv::Mat frame = texture(kSize, 2, 0.5, 0.08);
  const cv::Mat change =
      AppearanceModel(target, kAll, std::span(&frame, 1), {.region_px = 64}).apply(frame) - frame;
  cv::Mat step;
  cv::absdiff(change.colRange(1, change.cols), change.colRange(0, change.cols - 1), step);
  double at_border = 0, elsewhere = 0;
  int borders = 0, others = 0;
  for (int x = 0; x < step.cols; ++x) {
    const double mean = cv::mean(step.col(x))[0];
    if ((x + 1) % 64 == 0 || (x + 1) % 64 == 32)
      at_border += mean, ++borders;
    else
      elsewhere += mean, ++others;
  }
  EXPECT_LT(at_border / borders, 1.3 * elsewhere / others);
}

}  // namespace
}  // namespace freshet::synth::animate
