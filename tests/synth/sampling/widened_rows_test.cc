#include "synth/sampling/widened_rows.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::sampling {
namespace {

TEST(WidenedRows, AreWhatResizeMakesOfAnySize) {
  for (const auto& [from, to] :
       {std::pair{cv::Size(40, 30), cv::Size(160, 120)}, std::pair{cv::Size(41, 29), cv::Size(163, 113)},
        std::pair{cv::Size(7, 5), cv::Size(100, 9)}, std::pair{cv::Size(40, 30), cv::Size(40, 30)},
        std::pair{cv::Size(40, 30), cv::Size(20, 15)}, std::pair{cv::Size(40, 30), cv::Size(13, 44)},
        std::pair{cv::Size(1, 1), cv::Size(6, 3)}}) {
    cv::Mat coarse(from, CV_32F), expected;
    cv::RNG random(3);
    random.fill(coarse, cv::RNG::UNIFORM, -2, 2);
    cv::resize(coarse, expected, to, 0, 0, cv::INTER_LINEAR);
    WidenedRows rows(coarse, to);
    cv::Mat found(to, CV_32F);
    for (int y = 0; y < to.height; ++y) {
      const WidenedRows::Row row = rows.at(y);
      for (int x = 0; x < to.width; ++x)
        found.at<float>(y, x) = row.upper[x] * row.of_upper + row.lower[x] * row.of_lower;
    }
    EXPECT_LT(cv::norm(found, expected, cv::NORM_INF), 1e-6) << from << " to " << to;
  }
}

}  // namespace
}  // namespace freshet::synth::sampling
