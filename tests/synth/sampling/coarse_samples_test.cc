#include "synth/sampling/coarse_samples.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::sampling {
namespace {

// A field whose samples hold their own places in the picture gives each pixel its own.
TEST(CoarseSamples, APixelReadsWhatStandsAtItsOwnPlace) {
  constexpr int kStep = 4;
  cv::Mat field(12, 16, CV_32FC2);
  for (int y = 0; y < field.rows; ++y)
    for (int x = 0; x < field.cols; ++x)
      field.at<cv::Vec2f>(y, x) = {kStep * (static_cast<float>(x) + 0.5f) - 0.5f,
                                   kStep * (static_cast<float>(y) + 0.5f) - 0.5f};
  for (const double scale : {1.0, 2.0}) {
    const cv::Point origin(3, 2);
    cv::Mat out;
    cv::warpAffine(field, out, samples_from_pixels(kStep, scale, origin), {20, 16},
                   cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    for (int y = 0; y < out.rows; ++y)
      for (int x = 0; x < out.cols; ++x) {
        // The middle of pixel i of the plane lies at (i + origin + 1/2) scale - 1/2 px of the picture.
        const auto& at = out.at<cv::Vec2f>(y, x);
        EXPECT_NEAR(at[0], (x + origin.x + 0.5) * scale - 0.5, 0.1) << x;
        EXPECT_NEAR(at[1], (y + origin.y + 0.5) * scale - 0.5, 0.1) << y;
      }
  }
}

}  // namespace
}  // namespace freshet::synth::sampling
