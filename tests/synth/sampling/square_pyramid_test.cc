#include "synth/sampling/square_pyramid.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::sampling {
namespace {

TEST(SquarePyramid, IsOpenCvs) {
  cv::RNG random(5);
  for (const int n : {4, 6, 12, 24, 48, 96}) {
    cv::Mat square(n, n, CV_32F), expected_low, up, weight(n, n, CV_32F), sum(n, n + 5, CV_32F), expected_sum;
    random.fill(square, cv::RNG::UNIFORM, -1, 1);
    random.fill(weight, cv::RNG::UNIFORM, 0, 1);
    random.fill(sum, cv::RNG::UNIFORM, -1, 1);
    cv::pyrDown(square, expected_low);
    cv::pyrUp(expected_low, up, square.size());
    expected_sum = sum.clone();
    expected_sum(cv::Rect(3, 0, n, n)) += (square - up).mul(weight);

    cv::Mat low(n / 2, n / 2, CV_32F), wide(n / 2, n, CV_32F);
    std::vector<float> line(static_cast<std::size_t>(n) + 4);
    reduce_square(square.ptr<float>(), n, line.data(), low.ptr<float>());
    widen_square(low.ptr<float>(), n, line.data(), wide.ptr<float>());
    add_band(square.ptr<float>(), wide.ptr<float>(), weight.ptr<float>(), n, sum.ptr<float>() + 3,
             static_cast<std::ptrdiff_t>(sum.step1()));
    EXPECT_LT(cv::norm(low, expected_low, cv::NORM_INF), 1e-6) << n;
    EXPECT_LT(cv::norm(sum, expected_sum, cv::NORM_INF), 1e-6) << n;
  }
}

}  // namespace
}  // namespace freshet::synth::sampling
