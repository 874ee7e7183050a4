#include "bench/transfer/rivals/rivals.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/imgproc.hpp>

#include "tests/synth/transfer/made_exemplar.h"

namespace freshet::bench {
namespace {

using namespace synth::transfer;

const Rival kAll[] = {Rival::kDiscrete, Rival::kBidirectional, Rival::kOccurrences, Rival::kBenard,
                      Rival::kBrowning};

std::vector<TargetFrame> design(int frames) {
  std::vector<TargetFrame> all;
  for (int t = 0; t < frames; ++t) all.push_back(turning_disc({96, 96}, t));
  return all;
}

std::vector<cv::Mat> made(Rival method, const cv::Mat& look, int frames) {
  const std::vector<TargetFrame> of = design(frames);
  const auto next = rival(
      method, [&](int) { return ExemplarFrame{look}; }, of);
  std::vector<cv::Mat> all;
  for (std::size_t t = 0; t < of.size(); ++t) all.push_back(next(t).bgra);
  return all;
}

TEST(Rivals, FillTheDesignWithTheSameBytesOnAnyNumberOfThreads) {
  const cv::Mat look = blot({64, 64}, 3);
  for (const Rival method : kAll) {
    SCOPED_TRACE(static_cast<int>(method));
    const std::vector<cv::Mat> all = made(method, look, 4);
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    const std::vector<cv::Mat> again = made(method, look, 4);
    for (int t = 0; t < 4; ++t) {
      const auto at = static_cast<std::size_t>(t);
      ASSERT_EQ(cv::norm(all[at], again[at], cv::NORM_INF), 0);
      cv::Mat alpha, off;
      cv::extractChannel(all[at], alpha, 3);
      cv::absdiff(alpha, turning_disc({96, 96}, t).alpha, off);
      EXPECT_LT(cv::mean(off)[0], 0.06) << "its outline is the design's";
    }
  }
}

// Fig. 2 and 13 of LazyFluids: none keeps the exemplar's detail as uniform use does.
TEST(Rivals, LoseWhatUniformUseKeeps) {
  const cv::Mat look = blot({64, 64}, 3);
  Transfer transfer([&](int) { return ExemplarFrame{look}; }, {});
  double ours = 0;
  for (const TargetFrame& target : design(6)) ours = laplacian_energy(transfer.next(target).bgra);
  for (const Rival method : {Rival::kDiscrete, Rival::kBidirectional, Rival::kOccurrences, Rival::kBenard})
    EXPECT_LT(laplacian_energy(made(method, look, 6).back()), 0.9 * ours) << static_cast<int>(method);
}

TEST(Rivals, KeyframesPulsate) {
  const std::vector<cv::Mat> all = made(Rival::kBrowning, blot({64, 64}, 3), 21);
  for (const std::size_t key : {10U, 20U})
    EXPECT_LT(laplacian_energy(all[key - 5]), 0.8 * laplacian_energy(all[key])) << key;
}

TEST(Rivals, AFrameIsLikestTheNearerKeyframe) {
  const std::vector<cv::Mat> all = made(Rival::kBrowning, blot({64, 64}, 3), 11);
  const cv::Rect middle(36, 36, 24, 24);  // where the disc hardly moves
  EXPECT_LT(cv::norm(all[1](middle), all[0](middle)), 0.8 * cv::norm(all[9](middle), all[0](middle)));
  EXPECT_LT(cv::norm(all[9](middle), all[10](middle)), 0.8 * cv::norm(all[1](middle), all[10](middle)));
}

TEST(Rivals, KeyframesGoAlongTheDesign) {
  const std::vector<TargetFrame> turning = design(11);
  const cv::Point from(48, 20);
  const double angle = 0.03 * 10;
  const cv::Vec2f to(static_cast<float>(47.5 + 0.5 * std::cos(angle) + 27.5 * std::sin(angle)),
                     static_cast<float>(47.5 + 0.5 * std::sin(angle) - 27.5 * std::cos(angle)));
  EXPECT_LT(cv::norm(carried_places(turning, 0, 10).at<cv::Vec2f>(from) - to), 0.8);
  const cv::Vec2f back =
      carried_places(turning, 10, 0).at<cv::Vec2f>(cv::Point(cvRound(to[0]), cvRound(to[1])));
  EXPECT_LT(cv::norm(back - cv::Vec2f(48, 20)), 1.5);
}

}  // namespace
}  // namespace freshet::bench
