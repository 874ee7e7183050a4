#include "vision/variant.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

const std::vector<Variant> kAll = make_variants({1.0f, 0.75f, 0.5f}, {-22.5f, 0.0f, 22.5f}, true);

cv::Vec2d source_point(const VariantFrame& frame, double x, double y) {
  const cv::Matx23d& m = frame.source_from_variant;
  return {m(0, 0) * x + m(0, 1) * y + m(0, 2), m(1, 0) * x + m(1, 1) * y + m(1, 2)};
}

cv::Mat ramp(cv::Size size, double slope_x, double slope_y) {
  cv::Mat picture(size, CV_32F);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      picture.at<float>(y, x) = static_cast<float>(slope_x * x + slope_y * y);
    }
  }
  return picture;
}

TEST(Variant, ListIsScaleMajorThenRotationThenFlip) {
  ASSERT_EQ(kAll.size(), 18u);
  EXPECT_EQ(kAll[0], (Variant{1.0f, -22.5f, false}));
  EXPECT_EQ(kAll[1], (Variant{1.0f, -22.5f, true}));
  EXPECT_EQ(kAll[2], (Variant{1.0f, 0.0f, false}));
  EXPECT_EQ(kAll[6], (Variant{0.75f, -22.5f, false}));
  EXPECT_EQ(make_variants({1.0f}, {0.0f}, false).size(), 1u);
}

TEST(Variant, FrameIsTheBoundingBoxOfTheTurnedSource) {
  EXPECT_EQ(variant_frame({640, 360}, {1, 0, false}).size, cv::Size(640, 360));
  EXPECT_EQ(variant_frame({640, 360}, {0.5f, 0, true}).size, cv::Size(320, 180));
  EXPECT_EQ(variant_frame({640, 360}, {1, 90, false}).size, cv::Size(360, 640));
  const double c = std::cos(M_PI / 8), s = std::sin(M_PI / 8);
  EXPECT_EQ(variant_frame({640, 360}, {1, 22.5f, false}).size,
            cv::Size(static_cast<int>(std::ceil(640 * c + 360 * s)),
                     static_cast<int>(std::ceil(640 * s + 360 * c))));
}

TEST(Variant, RampIsReadExactlyInside) {
  const double slope_x = 2, slope_y = -3;
  for (const cv::Size size : {cv::Size(131, 97), cv::Size(128, 96)}) {
    const cv::Mat source = ramp(size, slope_x, slope_y);
    for (const Variant& variant : kAll) {
      const VariantFrame frame = variant_frame(size, variant);
      const cv::Mat warped = warp_to_variant(source, variant), mask = valid_mask(size, variant);
      ASSERT_EQ(warped.size(), frame.size);
      ASSERT_EQ(mask.size(), frame.size);
      // cv::warpAffine rounds coordinates to 1/32 px of the reduced picture: half of that on each axis, and a
      // little for its own rounding. An area average over a broken number of pixels is itself off by up to
      // 1/12 px.
      const bool whole = variant.scale == 1 || (variant.scale == 0.5f && size.width % 2 == 0);
      const double tolerance_px = (1 / 64.0 + 1 / 256.0) / variant.scale + (whole ? 0 : 0.09);
      int checked = 0;
      for (int y = 0; y < warped.rows; ++y) {
        for (int x = 0; x < warped.cols; ++x) {
          if (!mask.at<std::uint8_t>(y, x)) continue;
          const cv::Vec2d p = source_point(frame, x, y);
          ASSERT_NEAR(warped.at<float>(y, x), slope_x * p[0] + slope_y * p[1],
                      (slope_x - slope_y) * tolerance_px)
              << variant.scale << " " << variant.rotation_deg << " " << variant.flip << " at " << x << ","
              << y;
          ++checked;
        }
      }
      EXPECT_GT(checked, 0.9 * size.area() * variant.scale * variant.scale);
    }
  }
}

TEST(Variant, PositiveRotationIsCounterClockwiseOnTheScreen) {
  cv::Mat source(101, 101, CV_8U, cv::Scalar(0));
  cv::circle(source, {90, 50}, 3, cv::Scalar(255), cv::FILLED);  // on the right
  const cv::Mat turned = warp_to_variant(source, {1, 90, false});
  cv::Point brightest;
  cv::minMaxLoc(turned, nullptr, nullptr, nullptr, &brightest);
  EXPECT_NEAR(brightest.x, 50, 3);
  EXPECT_NEAR(brightest.y, 10, 3);  // at the top
}

TEST(Variant, FlipIsTheTwinsMirrorImageBitForBitAndTwiceTheIdentity) {
  cv::Mat source(61, 83, CV_8U);
  cv::randu(source, 0, 255);
  for (const Variant& variant : kAll) {
    if (variant.flip) continue;
    Variant flipped = variant;
    flipped.flip = true;
    cv::Mat twin;
    cv::flip(warp_to_variant(source, variant), twin, 1);
    EXPECT_EQ(cv::norm(twin, warp_to_variant(source, flipped), cv::NORM_INF), 0);
  }
  const Variant flip{1, 0, true};
  EXPECT_EQ(cv::norm(warp_to_variant(warp_to_variant(source, flip), flip), source, cv::NORM_INF), 0);
}

TEST(Variant, VelocityTransformIsTheDerivativeOfTheMapping) {
  for (const Variant& variant : kAll) {
    const VariantFrame frame = variant_frame({320, 240}, variant);
    // Walking v' in the variant must walk v in the source, with v' = A v.
    const cv::Vec2d v(3, -2);
    const cv::Vec2d turned = frame.variant_from_source_velocity * v;
    const cv::Vec2d walked =
        source_point(frame, 40 + turned[0], 50 + turned[1]) - source_point(frame, 40, 50);
    EXPECT_NEAR(walked[0], v[0], 1e-9);
    EXPECT_NEAR(walked[1], v[1], 1e-9);
  }
}

TEST(Variant, MaskMarksWhatIsInterpolatedFromInsideAndNoLess) {
  // Every marked pixel's centre lies in the source, and every pixel a bilinear step inside is marked.
  const cv::Size source(96, 64);
  for (const Variant& variant : kAll) {
    const cv::Mat mask = valid_mask(source, variant);
    const VariantFrame frame = variant_frame(source, variant);
    for (int y = 0; y < mask.rows; ++y) {
      for (int x = 0; x < mask.cols; ++x) {
        const cv::Vec2d p = source_point(frame, x, y);
        const bool inside = p[0] >= -0.5 && p[1] >= -0.5 && p[0] <= 95.5 && p[1] <= 63.5;
        if (mask.at<std::uint8_t>(y, x)) {
          ASSERT_TRUE(inside);
        }
        const double margin = 1 / variant.scale;
        const bool deep = p[0] >= margin && p[1] >= margin && p[0] <= 95 - margin && p[1] <= 63 - margin;
        if (deep) {
          ASSERT_TRUE(mask.at<std::uint8_t>(y, x));
        }
      }
    }
  }
}

TEST(Variant, RefusesAScaleOfZero) {
  EXPECT_THROW(variant_frame({64, 64}, {0, 0, false}), Error);
  EXPECT_THROW(variant_frame({0, 64}, {1, 0, false}), Error);
}

}  // namespace
}  // namespace freshet::vision
