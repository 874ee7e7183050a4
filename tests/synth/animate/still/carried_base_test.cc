#include "synth/animate/still/carried_base.h"

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
namespace {

constexpr int kWidth = 160, kHeight = 96, kStep = 4;
constexpr double kFps = 25;

double stripes(double x, double y) { return 0.5 + 0.25 * std::sin(x / 5) + 0.15 * std::cos(y / 7); }

cv::Mat picture() {
  cv::Mat luma(kHeight, kWidth, CV_32F);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) luma.at<float>(y, x) = static_cast<float>(stripes(x, y));
  return luma;
}
cv::Mat bgr_of(const cv::Mat& luma) {
  cv::Mat bgr;
  cv::merge(std::vector<cv::Mat>(3, luma), bgr);
  return bgr;
}
cv::Mat whole() { return cv::Mat(kHeight, kWidth, CV_32F, cv::Scalar(1)); }
cv::Mat motion(float u, float v) { return cv::Mat(kHeight, kWidth, CV_32FC2, cv::Scalar(u, v)); }
cv::Mat grey(double level) { return cv::Mat(kHeight, kWidth, CV_32F, cv::Scalar(level)); }

/// A picture and its copies, carried along a steady motion.
class Carried {
 public:
  /// motion   CV_32FC2, px/s. half_life_s of detail.
  Carried(const cv::Mat& bgr, const cv::Mat& luma, const cv::Mat& matte, const cv::Mat& motion,
          double half_life_s, double edge_px = 32, int loop = 0, int step = kStep)
      : base_(continued(fluid_planes(bgr, luma, matte), matte, {}), {.edge_px = edge_px, .step = step}),
        maps_(steady(motion, half_life_s, loop, base_.places(), step)) {}
  CarriedFrame frame(int i) {
    maps_.prepare(i, 1);
    return base_.frame(maps_.at(i));
  }
  std::vector<CopyMap> maps(int i) {
    maps_.prepare(i, 1);
    return maps_.at(i);
  }
  int own_frame(int copy) const { return maps_.own_frame(copy); }

 private:
  static CopyMaps steady(const cv::Mat& motion, double half_life_s, int loop, const CopyPlaces& places,
                         int step) {
    cv::Mat coarse;
    cv::resize(motion / kFps, coarse, {(motion.cols + step - 1) / step, (motion.rows + step - 1) / step}, 0,
               0, cv::INTER_AREA);
    return CopyMaps([coarse](int) { return coarse; }, places, step,
                    {.interval = CopyMaps::interval_of(half_life_s, kFps, loop),
                     .loop_frames = loop,
                     .wander = 20,
                     .patch = 3});
  }
  CarriedBase base_;
  CopyMaps maps_;
};

/// Luma of the base over an exposure.
cv::Mat shown(Carried& carried, int i, const cv::Mat& exposure) {
  cv::Mat luma;
  show_carried(carried.frame(i), exposure, luma);
  return luma;
}
cv::Mat shown(Carried& carried, int i) { return shown(carried, i, grey(0.1)); }

const cv::Rect kMiddle(50, 30, 60, 36);

TEST(CarriedBase, WithoutMotionIsThePicture) {
  Carried base(bgr_of(picture()), picture(), whole(), motion(0, 0), 1);
  for (const int i : {0, 3, 25}) EXPECT_LT(cv::norm(shown(base, i), picture(), cv::NORM_INF), 1e-4);
}

TEST(CarriedBase, LooksCountAsMuchAsTheyAreAsked) {
  const ContinuedFluid fluid = continued(fluid_planes(bgr_of(picture()), picture(), whole()), whole(), {});
  std::vector<cv::Mat> all, half;
  cv::split(CarriedBase(fluid, {}).places().all, all);
  cv::split(CarriedBase(fluid, {.looks = 0.5}).places().all, half);
  EXPECT_EQ(cv::norm(half[0], all[0], cv::NORM_INF), 0);  // how deep a place lies
  for (const int k : {1, 2, 3}) EXPECT_LT(cv::norm(half[k], 0.5 * all[k], cv::NORM_INF), 1e-6) << k;
  EXPECT_GT(cv::norm(all[1], cv::NORM_INF), 0.1);
}

TEST(CarriedBase, MapsAreAsCoarseAsMotionIsTold) {
  EXPECT_EQ(step_of_maps(1), 4);
  EXPECT_EQ(step_of_maps(1.5), 8);
  EXPECT_EQ(step_of_maps(2.5), 8);
  EXPECT_EQ(step_of_maps(3), 16);
  EXPECT_EQ(step_of_maps(16), 16);
}

TEST(CarriedBase, IsCopiesReadWhereTheirMapsSay) {
  for (const int step : {4, 8, 16}) {
    Carried carried(bgr_of(picture()), picture(), whole(), motion(40, -20), 0.15, 1, 0, step);
    int compared = 0;
    for (int i = 0; i < 30; ++i) {
      const std::vector<CopyMap> copies = carried.maps(i);
      const cv::Mat frame = shown(carried, i);
      double worst = 0;
      // Between the samples of weights: in the middle of two by two of them.
      for (int y = kMiddle.y; y < kMiddle.br().y; ++y)
        for (int x = kMiddle.x; x < kMiddle.br().x; ++x) {
          const double at_x = (x + 0.5) / step - 0.5, at_y = (y + 0.5) / step - 0.5;
          const int x0 = static_cast<int>(at_x), y0 = static_cast<int>(at_y);
          double expected = 0, all = 0;
          for (const CopyMap& copy : copies) {
            const auto weight = [&](int column, int row) { return copy.weight.at<float>(row, column); };
            const double fx = at_x - x0, fy = at_y - y0;
            const double upper = (1 - fx) * weight(x0, y0) + fx * weight(x0 + 1, y0);
            const double lower = (1 - fx) * weight(x0, y0 + 1) + fx * weight(x0 + 1, y0 + 1);
            const auto source = copy.source.at<cv::Vec2f>(y0, x0);  // the same everywhere
            const double here = (1 - fy) * upper + fy * lower;
            all += here;
            expected += here * stripes(x + source[0], y + source[1]);
          }
          // Where nearly all comes from beyond the picture, the exposure shows.
          if (all < 0.35) continue;
          ++compared;
          worst = std::max(worst, std::abs(expected / all - frame.at<float>(y, x)));
        }
      EXPECT_LT(worst, 6e-3) << i << " " << step;
    }
    EXPECT_GT(compared, 15 * kMiddle.area());
  }
}

TEST(CarriedBase, WeightsThatAreNotReadAreAsTheyWouldBeRead) {
  // Of a whole matte only what lies about a hole is read; of one that is all but whole, all. No side is a multiple of a
  // cell's.
  const cv::Size size(149, 91);
  cv::Mat luma(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) luma.at<float>(y, x) = static_cast<float>(stripes(x, y));
  const auto frame = [&](float of_matte, float of_hole) {
    cv::Mat matte(size, CV_32F, cv::Scalar(of_matte));
    matte(cv::Rect(70, 40, 9, 7)).setTo(of_hole);
    const CarriedBase base(continued(fluid_planes(bgr_of(luma), luma, matte), matte, {}), {.edge_px = 1});
    const cv::Size samples = base.places().own().size();
    std::vector<CopyMap> copies;
    for (const float shear : {0.06f, -0.09f}) {
      CopyMap copy{.weight = cv::Mat(samples, CV_32F, cv::Scalar(0.5)), .source = cv::Mat(samples, CV_32FC2)};
      for (int y = 0; y < samples.height; ++y)
        for (int x = 0; x < samples.width; ++x)
          copy.source.at<cv::Vec2f>(y, x) = kStep * shear *
                                            cv::Vec2f(static_cast<float>(y - samples.height / 2),
                                                      static_cast<float>(x - samples.width / 2));
      copies.push_back(copy);
    }
    return base.frame(copies).luma;
  };
  const cv::Mat unread = frame(1, 0.2f), read = frame(0.9998f, 0.2f), without = frame(1, 1);
  const cv::Rect inside(12, 12, size.width - 24, size.height - 24);
  EXPECT_LT(cv::norm(unread(inside), read(inside), cv::NORM_INF), 2e-3 * CarriedFrame::kOne);
  EXPECT_GT(cv::norm(unread(inside), without(inside), cv::NORM_INF), 0.02 * CarriedFrame::kOne);
}

TEST(CarriedBase, ACopyThatHardlyShowsDoesNotTakeOverThinFluid) {
  // Thin dark fluid on the left, dense bright fluid on the right; a copy that brings the one to the other.
  cv::Mat luma = grey(0.2), matte(kHeight, kWidth, CV_32F, cv::Scalar(0.2));
  const cv::Rect dense(80, 0, kWidth - 80, kHeight);
  luma(dense).setTo(0.9);
  matte(dense).setTo(1);
  const CarriedBase base(continued(fluid_planes(bgr_of(luma), luma, matte), matte, {}), {.edge_px = 32});
  const auto copy = [&](float weight, float from) {
    const cv::Size size = base.places().own().size();
    return CopyMap{.weight = cv::Mat(size, CV_32F, cv::Scalar(weight)),
                   .source = cv::Mat(size, CV_32FC2, cv::Scalar(from, 0))};
  };
  const CarriedFrame frame = base.frame(std::vector<CopyMap>{copy(0.95f, 0), copy(0.05f, 80)});
  const double seen = frame.luma.at<std::int16_t>(kHeight / 2, 40) / static_cast<double>(CarriedFrame::kOne);
  EXPECT_LT(seen, 0.2 + 0.7 * 0.2) << "without a limit .85";
  EXPECT_GT(seen, 0.2);
}

TEST(CarriedBase, BeginsAsThePicture) {
  Carried carried(bgr_of(picture()), picture(), whole(), motion(40, -20), 0.3, 1);
  EXPECT_LT(cv::norm(shown(carried, 0), picture(), cv::NORM_INF), 1e-3);
  EXPECT_GT(cv::norm(shown(carried, 3)(kMiddle), picture()(kMiddle), cv::NORM_INF), 0.02);
}

TEST(CarriedBase, NeitherLevelNorContrastPulses) {
  cv::Mat noise(kHeight, kWidth, CV_32F), coarse;
  cv::RNG random(3);
  random.fill(noise, cv::RNG::UNIFORM, 0.2, 0.8);
  Carried base(bgr_of(noise), noise, whole(), motion(60, 0), 0.3);
  double minimum = 1, maximum = 0;
  for (int i = 0; i < 30; ++i) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(shown(base, i)(kMiddle), mean, deviation);
    EXPECT_NEAR(mean[0], 0.5, 0.02);
    minimum = std::min(minimum, deviation[0]);
    maximum = std::max(maximum, deviation[0]);
  }
  EXPECT_LT(maximum / minimum, 1.6);  // two unlike copies lose 1.41; restore_contrast brings it back
}

TEST(CarriedBase, BringsTheColoursAlong) {
  // Red on the left, blue on the right, equally bright, going right: the border passes the middle.
  cv::Mat luma = grey(0.4), bgr(kHeight, kWidth, CV_32FC3);
  const cv::Vec3f red(0.4f, 0.4f - 0.3f * 0.299f / 0.587f, 0.7f),
      blue(0.7f, 0.4f - 0.3f * 0.114f / 0.587f, 0.4f);
  bgr(cv::Rect(0, 0, 80, kHeight)).setTo(cv::Scalar(red[0], red[1], red[2]));
  bgr(cv::Rect(80, 0, 80, kHeight)).setTo(cv::Scalar(blue[0], blue[1], blue[2]));
  Carried base(bgr, luma, whole(), motion(25, 0), 0.3);
  struct Brought {
    float luma, blue, red, fraction;
  };
  const auto at = [&](const CarriedFrame& frame, int x, int y) {
    std::vector<float> b(kWidth), r(kWidth), fraction(kWidth);
    colour_row(frame, y, kWidth, b.data(), r.data(), fraction.data());
    return Brought{static_cast<float>(frame.luma.at<std::int16_t>(y, x)) / CarriedFrame::kOne, b[x], r[x],
                   fraction[x]};
  };
  // Some copies of the border have gone ten pixels on, others have yet to come.
  float reddest = 0, bluest = 0;
  for (int i = 20; i < 60; ++i) {
    const Brought middle = at(base.frame(i), 84, 48);
    reddest = std::max(reddest, middle.red);
    bluest = std::max(bluest, middle.blue);
  }
  EXPECT_GT(reddest, 0.2);
  EXPECT_GT(bluest, 0.2);
  const CarriedFrame frame = base.frame(60);
  const Brought left = at(frame, 40, 48), right = at(frame, 120, 48);
  EXPECT_NEAR(left.luma, 0.4, 1e-3);
  EXPECT_NEAR(left.red, 0.3, 1e-3);  // less luma
  EXPECT_NEAR(left.blue, 0, 1e-3);
  EXPECT_NEAR(right.blue, 0.3, 1e-3);
  EXPECT_NEAR(right.fraction, 1, 0.02);
}

TEST(CarriedBase, BringsNothingThatIsNotFluid) {
  cv::Mat luma = picture(), matte = whole();
  luma(cv::Rect(0, 0, kWidth, 30)).setTo(100);  // rock, and it would be seen
  matte(cv::Rect(0, 0, kWidth, 30)).setTo(0);
  Carried base(bgr_of(luma), luma, matte, motion(0, 100), 0.3);
  for (int i = 0; i < 25; ++i) {
    double maximum = 0;
    cv::minMaxLoc(shown(base, i)(cv::Rect(0, 31, kWidth, kHeight - 31)), nullptr, &maximum);
    EXPECT_LT(maximum, 1.5) << i;
  }
}

TEST(CarriedBase, ThinWeightsBringNeitherLightNorDark) {
  // Fluid of one level in a matte of hairs and haze: whatever its weights come to, no other level comes out.
  cv::Mat matte = cv::Mat::zeros(kHeight, kWidth, CV_32F), luma = grey(100);
  cv::RNG random(4);
  for (int i = 0; i < 40; ++i)
    cv::line(matte, {random.uniform(0, kWidth), random.uniform(0, kHeight)},
             {random.uniform(0, kWidth), random.uniform(0, kHeight)}, cv::Scalar(random.uniform(0.2, 1.0)));
  luma.setTo(0.5, matte > 0);
  Carried base(bgr_of(luma), luma, matte, motion(30, 45), 0.3);
  for (int i = 0; i < 8; ++i) {
    const cv::Mat frame = shown(base, i, grey(0.5));
    double minimum = 0, maximum = 0;
    cv::minMaxLoc(frame, &minimum, &maximum, nullptr, nullptr, matte > 0.2);
    EXPECT_GT(minimum, 0.45) << i;
    EXPECT_LT(maximum, 0.55) << i;
  }
}

TEST(CarriedBase, HoldsItsColoursAtTheEdgesOfOddSizes) {
  const cv::Rect odd(0, 0, kWidth - 1, kHeight - 1);
  cv::Mat bgr = bgr_of(grey(0.4)(odd).clone());
  bgr += cv::Scalar(0.1, 0, 0);
  cv::Mat luma = grey(0.4)(odd).clone();
  Carried base(bgr, luma, whole()(odd).clone(), motion(0, 0)(odd).clone(), 1, 0);
  const CarriedFrame frame = base.frame(3);
  std::vector<float> blue(odd.width), red(odd.width), fraction(odd.width);
  for (const int y : {0, 1, odd.height - 2, odd.height - 1}) {
    colour_row(frame, y, odd.width, blue.data(), red.data(), fraction.data());
    for (const int x : {0, 1, odd.width / 2, odd.width - 2, odd.width - 1}) {
      EXPECT_NEAR(blue[x], 0.1, 1e-3) << x << ' ' << y;
      EXPECT_NEAR(red[x], 0, 1e-3) << x << ' ' << y;
      EXPECT_NEAR(fraction[x], 1, 1e-3) << x << ' ' << y;
    }
  }
}

TEST(CarriedBase, RepeatsInALoopOfAnyLengthAndIsCarriedInAll) {
  for (const int loop : {50, 51, 97, 7, 500}) {
    Carried base(bgr_of(picture()), picture(), whole(), motion(30, 10), 0.2, 1, loop);
    std::vector<cv::Mat> first;
    for (const int i : {0, 1, 5}) first.push_back(shown(base, i));
    EXPECT_LT(cv::norm(first[0], picture(), cv::NORM_INF), 1e-3) << loop;
    EXPECT_GT(cv::norm(first[0](kMiddle), first[1](kMiddle), cv::NORM_INF), 0.005) << loop;
    int k = 0;
    for (const int i : {0, 1, 5})
      EXPECT_EQ(cv::norm(first[k++], shown(base, i + loop), cv::NORM_INF), 0) << loop;
  }
}

TEST(CarriedBase, BeyondItsSidesThePictureGoesOnMirrored) {
  const CarriedBase base(continued(fluid_planes(bgr_of(picture()), picture(), whole()), whole(), {}), {});
  const cv::Size samples = base.places().own().size();
  const CopyMap copy{cv::Mat(samples, CV_32F, cv::Scalar(1)),
                     cv::Mat(samples, CV_32FC2, cv::Scalar(-30, 60))};
  // Without a rim of a fiftieth.
  const auto folded = [](double at, double size) {
    const double low = size / 50 - 0.5, high = size - 1 - low;
    return at < low ? 2 * low - at : at > high ? 2 * high - at : at;
  };
  cv::Mat luma;
  show_carried(base.frame({&copy, 1}), grey(0), luma);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      ASSERT_NEAR(luma.at<float>(y, x), stripes(folded(x - 30, kWidth), folded(y + 60, kHeight)), 6e-3)
          << x << ", " << y;
}

TEST(CarriedBase, BeyondASideLiesWhatItIsContinuedBy) {
  const ContinuedFluid fluid =
      continued(fluid_planes(bgr_of(picture()), picture(), whole()), whole(), {.left = 40, .top = 24});
  const CarriedBase base(fluid, {});
  const cv::Size samples = base.places().own().size();
  const CopyMap copy{cv::Mat(samples, CV_32F, cv::Scalar(1)),
                     cv::Mat(samples, CV_32FC2, cv::Scalar(-20, -12))};
  cv::Mat luma;
  show_carried(base.frame({&copy, 1}), grey(0), luma);
  // Without a rim, which is seen twice to both sides of the picture's border.
  const auto found = [](int at, int size) { return at < size / 50.0 - 0.5 ? at - 2 * size / 50.0 : at; };
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const cv::Point2f at(static_cast<float>(40 + found(x - 20, kWidth)),
                           static_cast<float>(24 + found(y - 12, kHeight)));
      cv::Mat expected;
      cv::getRectSubPix(fluid.planes.luma, {1, 1}, at, expected);
      ASSERT_NEAR(luma.at<float>(y, x), expected.at<float>(0), 0.02) << x << ", " << y;
    }
}

}  // namespace
}  // namespace freshet::synth::animate
