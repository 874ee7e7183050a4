#include "synth/animate/forms/own_flames.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/synth/animate/forms/burnt_film.h"
#include "tests/synth/animate/measured_clip.h"

namespace freshet::synth::animate {
namespace {

/// A clip whose flames rise by 40 px/s everywhere.
FlowingClip rising(const std::string& class_name = "fire") {
  FlowingClip clip = BurningClip{}.clip();
  clip.class_name = class_name;
  clip.steady = {0, -1.6f};
  clip.varying = 0.4f;
  return measured(clip);
}

Made made_with(const FlowingStore& store, const AnimateOptions& options) {
  return made_with(store, options, cv::Mat(kPicture.size, CV_8U, cv::Scalar(255)));
}

AnimateOptions by_itself(int frames = 20) {
  AnimateOptions options;
  options.frames = frames;
  return options;
}

TEST(OwnFlames, AreTakenByThemselvesForAFireAndNothingElse) {
  const Made fire = made_with(FlowingStore({rising()}), by_itself());
  EXPECT_EQ(fire.report.method, "forms");
  EXPECT_EQ(fire.report.flames, "own");
  EXPECT_TRUE(fire.report.by_itself);
  const Made water = made_with(FlowingStore({rising("water")}), by_itself());
  EXPECT_EQ(water.report.method, "carried");
  EXPECT_FALSE(water.report.by_itself);
}

TEST(OwnFlames, YieldToAMethodThatIsNamedAndToAMovingOutline) {
  const FlowingStore store({rising()});
  AnimateOptions options = by_itself(4);
  options.for_fires.reset();
  EXPECT_EQ(made_with(store, options).report.method, "carried");
  options = by_itself(4);
  options.outline.kind = outline::Outline::kMoving;
  options.outline.background = kPicture.draw();
  EXPECT_EQ(made_with(store, options).report.method, "carried");
}

TEST(OwnFlames, BurnOverAGroundThatStands) {
  const Made made = made_with(FlowingStore({rising()}), by_itself());
  const cv::Mat picture = kPicture.draw();
  ASSERT_EQ(made.frames.size(), 20);
  EXPECT_EQ(apart(made.frames[0], picture), 0);
  const cv::Rect flame(90, 50, 40, 80), below(90, 136, 40, 20), beside(0, 0, 40, 160);
  for (std::size_t i = 4; i < made.frames.size(); ++i) {
    EXPECT_GT(apart(made.frames[i](flame), picture(flame)), 20) << i;
    // In the dark all of it brightens and darkens with the fire, and no flame comes over it: it stays blue.
    EXPECT_LT(apart(made.frames[i](below), picture(below)), 12) << i;
    EXPECT_LT(apart(made.frames[i](beside), picture(beside)), 15) << i;
    std::vector<cv::Mat> colours;
    cv::split(made.frames[i](beside), colours);
    EXPECT_EQ(cv::countNonZero(colours[2] > colours[0]), 0) << i;
  }
}

AnimateOptions with_layout(Layout layout, int frames) {
  AnimateOptions options = by_itself(frames);
  options.method = FormsOptions{.flames = Flames::kOwn, .carried = {.layout = layout}};
  return options;
}

/// How much the mean of a place of frames goes up and down at this pace, grey levels.
double swing(const std::vector<cv::Mat>& frames, const cv::Rect& where, double per_frame) {
  std::complex<double> sum = 0;
  double mean = 0, count = 0;
  for (std::size_t i = 5; i < frames.size(); ++i, ++count) mean += cv::mean(frames[i](where))[0];
  for (std::size_t i = 5; i < frames.size(); ++i)
    sum +=
        (cv::mean(frames[i](where))[0] - mean / count) * std::polar(1.0, per_frame * static_cast<double>(i));
  return 2 * std::abs(sum) / count;
}

TEST(OwnFlames, TheGroundGlowsAsThatOfTheClipsDoes) {
  constexpr double kPace = 0.8;  // rad a frame
  const cv::Rect beside(0, 0, 40, 160);
  const Made even = made_with(FlowingStore({rising()}), by_itself(40));
  FlowingClip glowing = rising();
  glowing.drawn = [](int i) {
    cv::Mat frame = BurningClip{}.frame(i);
    return cv::Mat(frame + cv::Scalar(15 + 12 * std::sin(kPace * i)));
  };
  const Made made = made_with(FlowingStore({glowing}), by_itself(40));
  EXPECT_GT(swing(made.frames, beside, kPace), 2 * swing(even.frames, beside, kPace));
  // As light: it gets no other forms.
  for (const cv::Mat& frame : made.frames) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(frame(cv::Rect(4, 60, 24, 24)), mean, deviation);
    EXPECT_LT(deviation[0], 3);
  }
}

TEST(OwnFlames, LeapAndDieDownAsThoseOfTheClipDo) {
  constexpr double kPace = 0.8;  // rad a frame
  const cv::Rect flames(120, 96, 24, 24), beside(0, 96, 24, 24);
  const auto made = [](double halves_apart) {
    FlowingClip clip = rising();
    clip.drawn = [=](int i) {
      cv::Mat frame = BurningClip{}.frame(i);
      for (int half = 0; half < 2; ++half)
        frame.colRange(half * 60, half == 0 ? 60 : frame.cols) +=
            cv::Scalar::all(40 + 40 * std::sin(kPace * i + half * halves_apart));
      return frame;
    };
    return made_with(FlowingStore({clip}), by_itself(40)).frames;
  };
  const std::vector<cv::Mat> apart = made(CV_PI), together = made(0);
  EXPECT_GT(swing(apart, flames, kPace), 2 * swing(apart, beside, kPace));
  // A fire does not beat as a whole.
  EXPECT_LT(swing(together, flames, kPace), 1.3 * swing(together, beside, kPace));
}

/// How light frames are there, of the picture's, at the darkest.
double darkest(const std::vector<cv::Mat>& frames, const cv::Rect& where) {
  const double own = cv::mean(kPicture.draw()(where))[2];
  double least = 1;
  for (const cv::Mat& frame : frames) least = std::min(least, cv::mean(frame(where))[2] / own);
  return least;
}

TEST(OwnFlames, AFootBurnsOnWhileItsFlamesGoUp) {
  const Made made = made_with(FlowingStore({rising()}), with_layout(Layout::kGoes, 24));
  EXPECT_GT(darkest(made.frames, {104, 116, 12, 12}), 0.8);
}

TEST(OwnFlames, AHoleInTheMatteDoesNotGoUpAsADarkOne) {
  const FlowingStore store({rising()});
  const cv::Rect hole(106, 106, 10, 10), above(106, 70, 10, 10);
  cv::Mat matte(kPicture.size, CV_8U, cv::Scalar(255));
  const double whole = darkest(made_with(store, by_itself(24), matte).frames, above);
  matte(hole) = 0;
  const Made made = made_with(store, by_itself(24), matte);
  EXPECT_GT(darkest(made.frames, above), 0.97 * whole);
  for (const cv::Mat& frame : made.frames) EXPECT_EQ(apart(frame(hole), kPicture.draw()(hole)), 0);
}

TEST(OwnFlames, KeepTheirPlaceWhereTheirLayoutStands) {
  const FlowingStore store({rising()});
  const cv::Rect tip(90, 0, 40, 60);
  const auto changed = [&](Layout layout) {
    const Made made = made_with(store, with_layout(layout, 20));
    return cv::norm(made.frames.back()(tip), kPicture.draw()(tip), cv::NORM_L1);
  };
  EXPECT_LT(changed(Layout::kStands), 0.5 * changed(Layout::kGoes));
}

TEST(OwnFlames, KeepTheirLayoutAtTheirFootAlone) {
  FlowingClip clip = rising();
  clip.contrast = contrasts(0.8f, 0.2f);
  const FlowingStore store({clip});
  const cv::Rect tip(90, 40, 40, 36), foot(84, 116, 52, 12);
  const auto changed = [&](Layout layout, const cv::Rect& where) {
    double sum = 0;
    for (const cv::Mat& frame : made_with(store, with_layout(layout, 20)).frames)
      sum += cv::norm(frame(where), kPicture.draw()(where), cv::NORM_L1);
    return sum;
  };
  EXPECT_GT(changed(Layout::kMeasured, tip), 0.9 * changed(Layout::kGoes, tip));
  EXPECT_GT(std::abs(changed(Layout::kMeasured, foot) / changed(Layout::kGoes, foot) - 1), 0.2);
}

TEST(OwnFlames, AreCarriedFasterThanTheyAreToBeSeenToGo) {
  const FlowingStore store({rising()});
  const auto mean_step = [&](AnimateOptions options) {
    cv::Scalar sum;
    options.motion_sink = [&](const cv::Mat& motion) { sum += cv::mean(motion); };
    made_with(store, options);
    return sum[1] / options.frames;
  };
  AnimateOptions whole = by_itself(12);
  whole.method = CarriedOptions{};
  for (const AnimateOptions& options : {by_itself(12), whole})
    EXPECT_NEAR(mean_step(options), -1.25 * 1.6, 0.1);
}

TEST(OwnFlames, TurnNeitherGreyNorBlue) {
  for (const cv::Mat& frame : made_with(FlowingStore({rising()}), by_itself()).frames)
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols; ++x)
        if (const cv::Vec3b c = frame.at<cv::Vec3b>(y, x); c[2] > 60) {
          EXPECT_GT(c[2], c[0]) << x << ", " << y;
        }
}

TEST(OwnFlames, AreTheSameForAnyThreadsAndAnyRange) {
  expect_same_for_any_threads_and_range(FlowingStore({rising()}), by_itself(), 15,
                                        cv::Mat(kPicture.size, CV_8U, cv::Scalar(255)));
}

TEST(OwnFlames, AreTheSameInManyBatches) {
  const FlowingStore store({rising()});
  AnimateOptions options = by_itself(40);
  const Made whole = made_with(store, options);
  options.memory_bytes = 1;
  const Made in_batches = made_with(store, options);
  ASSERT_EQ(whole.frames.size(), in_batches.frames.size());
  for (std::size_t i = 0; i < whole.frames.size(); ++i)
    EXPECT_EQ(apart(whole.frames[i], in_batches.frames[i]), 0) << i;
}

TEST(OwnFlames, TheFluidOverThePictureIsTheFrame) {
  const FlowingStore store({rising()});
  const Made whole = made_with(store, by_itself(8));
  AnimateOptions options = by_itself(8);
  options.form = FrameForm::kFluid;
  const Made fluid = made_with(store, options);
  for (std::size_t i = 0; i < whole.frames.size(); ++i)
    for (int y = 0; y < kPicture.size.height; ++y)
      for (int x = 0; x < kPicture.size.width; ++x)
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR(255 * fluid.frames[i].at<cv::Vec4f>(y, x)[k], whole.frames[i].at<cv::Vec3b>(y, x)[k],
                      0.51);
}

TEST(OwnFlames, AskedOfAPictureWithoutFlamesAreRefused) {
  AnimateOptions options = by_itself(4);
  options.method = FormsOptions{.flames = Flames::kOwn};
  cv::Mat dark(kPicture.size, CV_8UC3, cv::Scalar(60, 40, 20));
  const FlowingStore store({rising()});
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  placement.patches.push_back(
      {.piece = {0, 0}, .clip = store.id(), .variant = {}, .patch = {0, 0}, .speed = 1});
  EXPECT_THROW(
      animate(store.snapshot(), store.settings(), dark, cv::Mat(kPicture.size, CV_8U, cv::Scalar(255)),
              placement, options, [](const cv::Mat&) {}),
      Error);
}

}  // namespace
}  // namespace freshet::synth::animate
