#include "vision/flow/tv_l1.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/optflow.hpp>

#include "tests/vision/made_texture.h"

namespace freshet::vision {
namespace {

// The content of `picture` moved by a swirl of up to `speed` px.
cv::Mat moved(const cv::Mat& picture, float speed) {
  cv::Mat places(picture.size(), CV_32FC2), result;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      places.at<cv::Vec2f>(y, x) = {static_cast<float>(x) + speed * std::sin(static_cast<float>(y) / 17),
                                    static_cast<float>(y) + speed * std::cos(static_cast<float>(x) / 23)};
    }
  }
  cv::remap(picture, result, places, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  return result;
}

double mean_distance(const cv::Mat& a, const cv::Mat& b) {
  double sum = 0;
  for (int y = 0; y < a.rows; ++y) {
    for (int x = 0; x < a.cols; ++x) sum += cv::norm(a.at<cv::Vec2f>(y, x) - b.at<cv::Vec2f>(y, x));
  }
  return sum / static_cast<double>(a.total());
}

// OpenCV's goes iteration by iteration over whole pictures. More warps would say nothing: both read pictures
// at places rounded to 1/32 px, and what differs by a rounding there grows from warp to warp.
TEST(TvL1, IsOpenCvsFlowOfTheSameOptions) {
  cv::setNumThreads(1);
  for (const cv::Size size : {cv::Size(160, 120), cv::Size(61, 97)}) {
    const cv::Mat to = made_texture(size), from = moved(to, 2);
    for (const int iterations : {1, 4, 13}) {
      for (const int median : {1, 5}) {
        const TvL1Options options{
            .lambda = 0.5, .theta = 0.8, .iterations = iterations, .warps = 1, .scales = 3, .median = median};
        const auto theirs = cv::optflow::DualTVL1OpticalFlow::create();
        theirs->setLambda(options.lambda);
        theirs->setTheta(options.theta);
        theirs->setInnerIterations(options.iterations);
        theirs->setOuterIterations(1);
        theirs->setWarpingsNumber(options.warps);
        theirs->setScalesNumber(options.scales);
        theirs->setScaleStep(options.step);
        theirs->setMedianFiltering(options.median);
        theirs->setEpsilon(0);
        cv::Mat flow;
        theirs->calc(from, to, flow);
        EXPECT_GT(cv::norm(flow, cv::NORM_L1), 1000);
        EXPECT_LT(mean_distance(tv_l1_flow(from, to, options), flow), 2e-3)
            << size << ' ' << iterations << ' ' << median;
      }
    }
  }
}

TEST(TvL1, FollowsMotionOfManyPixels) {
  const cv::Mat picture = made_texture({240, 200});
  const cv::Mat to = picture(cv::Rect(20, 20, 200, 160)), from = picture(cv::Rect(32, 20, 200, 160));
  const cv::Scalar mean = cv::mean(tv_l1_flow(from.clone(), to.clone())(cv::Rect(40, 40, 120, 80)));
  EXPECT_NEAR(mean[0], 12, 0.3);
  EXPECT_NEAR(mean[1], 0, 0.3);
}

}  // namespace
}  // namespace freshet::vision
