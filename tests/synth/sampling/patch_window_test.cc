#include "synth/sampling/patch_window.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "vision/patch_grid.h"

namespace freshet::synth::sampling {
namespace {

TEST(PatchWindow, CutsWhatTheVariantShows) {
  // Odd sizes, so that scales do not divide them.
  cv::Mat frame(211, 317, CV_32F);
  cv::RNG rng(2);
  rng.fill(frame, cv::RNG::NORMAL, 0, 1);
  cv::GaussianBlur(frame, frame, {}, 4);
  double low = 0, high = 0;
  cv::minMaxLoc(frame, &low, &high);
  for (const vision::Variant& variant :
       vision::make_variants({1.0f, 0.75f, 0.5f}, {-22.5f, 0.0f, 22.5f}, true)) {
    const cv::Mat shown = vision::warp_to_variant(frame, variant);
    const cv::Mat valid = vision::valid_mask(frame.size(), variant);
    const std::vector<cv::Point> positions = vision::patch_positions(valid.size(), {}, variant.flip);
    const std::vector<float> coverage = vision::patch_coverage(valid, positions, 48);
    cv::Mat reduced, window;
    cv::resize(frame, reduced, reduced_to_scale(frame.size(), variant.scale), 0, 0, cv::INTER_AREA);
    int checked = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (coverage[i] < 1) continue;
      PatchWindow(frame.size(), variant, positions[i], 48).cut(reduced, window);
      const cv::Mat expected = shown(cv::Rect(positions[i], cv::Size(48, 48)));
      // Bicubic here, bilinear there; and the reduced size is rounded to whole pixels.
      EXPECT_LT(cv::norm(window, expected, cv::NORM_L1) / window.total(), 0.02 * (high - low))
          << "scale " << variant.scale << " rotation " << variant.rotation_deg << " flip " << variant.flip
          << " at " << positions[i];
      ++checked;
    }
    EXPECT_GT(checked, 0);
  }
}

TEST(PatchWindow, NeedsOnlyPixelsOfTheFrame) {
  const cv::Size source(317, 211);
  for (const vision::Variant& variant : vision::make_variants({1.0f, 0.5f}, {-22.5f, 0.0f}, true)) {
    const cv::Size shown = vision::variant_frame(source, variant).size;
    const cv::Point middle(shown.width / 2 - 24, shown.height / 2 - 24);
    const cv::Rect needed = PatchWindow(source, variant, middle, 48).needed();
    EXPECT_EQ(needed & cv::Rect({}, source), needed);
    EXPECT_GE(needed.area(), static_cast<int>(0.9 * 48 * 48 / (variant.scale * variant.scale)));
  }
}

}  // namespace
}  // namespace freshet::synth::sampling
