#include "synth/animate/still/finished_frame.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/harness/noise.h"

namespace freshet::synth::animate {
namespace {

const cv::Size kSize(77, 41);  // odd: rows end in the middle of a vector
// To whole levels, and what shows below the fluid to 1/128 before.
constexpr double kRounded = 0.5 + 0.5 / 128 + 1e-3;

/// Colours that keep luma.
cv::Mat chroma(std::uint64_t seed, double most) {
  cv::Mat out = noise(kSize, CV_32FC3, seed, -most, most);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      cv::Vec3f& c = out.at<cv::Vec3f>(y, x);
      c[1] = -(0.114f * c[0] + 0.299f * c[2]) / 0.587f;
    }
  return out;
}

struct Parts {
  ColourModel model{chroma(1, 0.4), chroma(2, 0.1)};
  cv::Mat own_colour = chroma(3, 0.1), still = noise(kSize, CV_32FC3, 4, 0, 1);
  cv::Mat luma = noise(kSize, CV_32F, 5, -0.2, 1.2), fluid = noise(kSize, CV_32F, 6, 0, 1);
  ColourCurve curve{still, luma_of(still), cv::Mat(kSize, CV_32F, cv::Scalar(1))};
  FrameFinisher finisher{model, curve, own_colour, still};

  Parts() {
    // A matte with whole fluid, holes, margins, and rows without any.
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        float& f = fluid.at<float>(y, x);
        if (x < 5 + y % 7 || x > 70 || y % 10 == 9) f = 0;
        if ((x / 8 + y / 8) % 5 == 0) f = 0;
        if ((x / 8 + y / 8) % 5 == 1 && f > 0) f = 1;
      }
  }
};

/// A carried frame of the picture in motion.
CarriedFrame carried_frame() {
  const cv::Mat picture = noise(kSize, CV_32FC3, 7, 0, 1);
  const cv::Mat matte(kSize, CV_32F, cv::Scalar(1));
  const CarriedBase base(continued(fluid_planes(picture, luma_of(picture), matte), matte, {}),
                         {.edge_px = 4});
  const cv::Size samples = base.places().own().size();
  const cv::Mat whole(samples, CV_32F, cv::Scalar(1));
  const std::vector<CopyMap> copies{{0.6 * whole, cv::Mat(samples, CV_32FC2, cv::Scalar(-4, 2))},
                                    {0.4 * whole, cv::Mat(samples, CV_32FC2, cv::Scalar(7, -3))}};
  return base.frame(copies);
}

/// One pixel in doubles, as the header says it. brought: null, or blue, green and red less luma, as the luminance is
/// now, and the fraction of it.
struct Brought {
  double chroma[3], fraction;
};
cv::Vec3d finished(const Parts& parts, int y, int x, const Brought* brought) {
  cv::Vec3d out;
  const double luma = parts.luma.at<float>(y, x), fluid = parts.fluid.at<float>(y, x);
  for (int k = 0; k < 3; ++k) {
    const double slope = parts.model.slope.at<cv::Vec3f>(y, x)[k];
    const double rest = static_cast<double>(parts.model.offset.at<cv::Vec3f>(y, x)[k]) +
                        parts.own_colour.at<cv::Vec3f>(y, x)[k];
    double lit = luma + slope * luma + rest;
    if (brought) {
      // It keeps its colour, and changes it along the curve where its luminance is another now.
      const double carried = luma + brought->chroma[k];
      lit += brought->fraction * (carried - lit);
    }
    out[k] = 255 * (fluid * std::clamp(lit, 0.0, 1.0) + (1 - fluid) * parts.still.at<cv::Vec3f>(y, x)[k]);
  }
  return out;
}

void expect_near(const cv::Mat& frame, const cv::Vec3d& expected, int y, int x) {
  for (int k = 0; k < 3; ++k)
    ASSERT_LE(std::abs(frame.at<cv::Vec3b>(y, x)[k] - expected[k]), kRounded) << x << " " << y << " " << k;
}

TEST(FrameFinisher, ColoursLuminanceAndLaysItIntoTheStillPicture) {
  const Parts parts;
  const cv::Mat frame = parts.finisher.finish(parts.luma, parts.fluid, nullptr);
  ASSERT_EQ(frame.type(), CV_8UC3);
  ASSERT_EQ(frame.size(), kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) expect_near(frame, finished(parts, y, x, nullptr), y, x);
}

TEST(FrameFinisher, WhatWasCarriedBringsItsColour) {
  const Parts parts;
  const CarriedFrame carried = carried_frame();
  const cv::Mat frame = parts.finisher.finish(parts.luma, parts.fluid, &carried);
  std::vector<float> blue(kSize.width), red(kSize.width), fraction(kSize.width);
  double most = 0;
  for (int y = 0; y < kSize.height; ++y) {
    colour_row(carried, y, kSize.width, blue.data(), red.data(), fraction.data());
    for (int x = 0; x < kSize.width; ++x) {
      // Changed along the curve where the luminance is another now. Green is what keeps luma.
      parts.curve.follow(carried.luma.ptr<std::int16_t>(y) + x, parts.luma.ptr<float>(y) + x, 1, &blue[x],
                         &red[x]);
      const Brought brought{{blue[x], -(0.114 * blue[x] + 0.299 * red[x]) / 0.587, red[x]}, fraction[x]};
      most = std::max(most, brought.fraction);
      expect_near(frame, finished(parts, y, x, &brought), y, x);
    }
  }
  EXPECT_GT(most, 0.5) << "hardly anything was carried";
}

TEST(FrameFinisher, MakesNoColourThatThePictureHasNot) {
  const Parts parts;
  cv::Mat grey, light = noise(kSize, CV_32F, 9, 0, 1);
  cv::merge(std::vector<cv::Mat>(3, light), grey);
  const cv::Mat all(kSize, CV_32F, cv::Scalar(1));
  const FrameFinisher free(parts.model, parts.curve, parts.own_colour, grey),
      finisher(parts.model, parts.curve, parts.own_colour, grey, ColourRange(grey, luma_of(grey), all));
  const CarriedFrame carried = carried_frame();
  for (const CarriedFrame* brought : {static_cast<const CarriedFrame*>(nullptr), &carried}) {
    const auto most_colour = [&](const FrameFinisher& by) {
      std::vector<cv::Mat> channels;
      cv::split(by.finish(light, all, brought), channels);
      return std::max(cv::norm(channels[0], channels[1], cv::NORM_INF),
                      cv::norm(channels[2], channels[1], cv::NORM_INF));
    };
    EXPECT_GT(most_colour(free), 20);
    EXPECT_LE(most_colour(finisher), 1);
  }
}

TEST(FrameFinisher, LeavesTheStillPictureAsItIsWhereThereIsNoFluid) {
  Parts parts;
  cv::Mat bytes(kSize, CV_8UC3);
  cv::RNG(8).fill(bytes, cv::RNG::UNIFORM, 0, 256);
  cv::Mat still;
  bytes.convertTo(still, CV_32F, 1.0 / 255);
  const FrameFinisher finisher(parts.model, parts.curve, parts.own_colour, still);
  const CarriedFrame carried = carried_frame();
  for (const CarriedFrame* brought : {static_cast<const CarriedFrame*>(nullptr), &carried}) {
    const cv::Mat frame = finisher.finish(parts.luma, parts.fluid, brought);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        if (parts.fluid.at<float>(y, x) == 0) {
          ASSERT_EQ(frame.at<cv::Vec3b>(y, x), bytes.at<cv::Vec3b>(y, x)) << x << " " << y;
        }
    const cv::Mat none = finisher.finish(parts.luma, cv::Mat::zeros(kSize, CV_32F), brought);
    EXPECT_EQ(cv::norm(none, bytes, cv::NORM_INF), 0);
  }
}

TEST(FrameFinisher, WhereThereIsNoFluidItIsTheSameWhateverLiesBesideIt) {
  const Parts parts;  // a still of levels between the whole ones
  const cv::Mat frame = parts.finisher.finish(parts.luma, parts.fluid, nullptr),
                none = parts.finisher.finish(parts.luma, cv::Mat::zeros(kSize, CV_32F), nullptr);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      if (parts.fluid.at<float>(y, x) == 0) {
        ASSERT_EQ(frame.at<cv::Vec3b>(y, x), none.at<cv::Vec3b>(y, x)) << x << " " << y;
      }
}

TEST(FinishedFrame, TheFluidAloneOverTheStillIsTheWholeFrame) {
  const Parts parts;
  const CarriedFrame carried = carried_frame();
  for (const CarriedFrame* brought : {static_cast<const CarriedFrame*>(nullptr), &carried}) {
    const cv::Mat whole = parts.finisher.finish(parts.luma, parts.fluid, brought);
    const cv::Mat fluid = parts.finisher.finish_fluid(parts.luma, parts.fluid, brought);
    ASSERT_EQ(fluid.type(), CV_32FC4);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const cv::Vec4f& f = fluid.at<cv::Vec4f>(y, x);
        EXPECT_EQ(f[3], parts.fluid.at<float>(y, x));
        for (int k = 0; k < 3; ++k)
          ASSERT_NEAR(255 * (f[k] + (1 - f[3]) * parts.still.at<cv::Vec3f>(y, x)[k]),
                      whole.at<cv::Vec3b>(y, x)[k], kRounded);
      }
  }
}

TEST(FinishedFrame, TheFluidAloneGoesAboveWhiteWhereTheStillDoes) {
  const Parts parts;
  cv::Mat bright = parts.still.clone();
  bright.at<cv::Vec3f>(3, 3)[2] = 1.15f;
  const FrameFinisher finisher(parts.model, parts.curve, parts.own_colour, bright);
  double most = 0;
  cv::minMaxLoc(finisher.finish_fluid(parts.luma, parts.fluid, nullptr).reshape(1), nullptr, &most);
  EXPECT_GT(most, 1.0);
  EXPECT_LE(most, 1.15f);
}

}  // namespace
}  // namespace freshet::synth::animate
