#include "synth/animate/forms/forms_renderer.h"

#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "synth/animate/animate.h"
#include "tests/synth/animate/carried_error.h"
#include "tests/synth/animate/forms/burnt_film.h"

namespace freshet::synth::animate {
namespace {

cv::Mat matte() {
  cv::Mat out = cv::Mat::zeros(kPicture.size, CV_8U);
  out(cv::Rect(60, 20, 100, 120)).setTo(255);
  return out;
}

Made made_with(const FlowingStore& store, const AnimateOptions& options) {
  return made_with(store, options, matte());
}

AnimateOptions forms(int frames = 24) {
  AnimateOptions options;
  options.frames = frames;
  options.method = FormsOptions{};
  return options;
}

TEST(Forms, TheFirstFrameIsThePictureAndFlamesLeapAfterIt) {
  const FlowingStore store({BurningClip{}.clip()});
  const Made made = made_with(store, forms());
  ASSERT_EQ(made.frames.size(), 24);
  EXPECT_EQ(apart(made.frames[0], kPicture.draw()), 0);
  const cv::Mat outside = matte() == 0;
  for (std::size_t i = 1; i < made.frames.size(); ++i) {
    EXPECT_EQ(cv::norm(made.frames[i], kPicture.draw(), cv::NORM_INF, outside), 0) << i;
    EXPECT_GT(apart(made.frames[i], made.frames[i - 1]), 20) << i;
  }
  EXPECT_EQ(made.report.method, "forms");
  ASSERT_EQ(made.report.forms.size(), 1);
  EXPECT_EQ(made.report.forms[0].clip, store.id());
}

TEST(Forms, NeitherGreyNorBlueComesIntoTheFlames) {
  const FlowingStore store({BurningClip{}.clip()});
  for (const cv::Mat& frame : made_with(store, forms()).frames)
    for (int y = 20; y < 140; ++y)
      for (int x = 60; x < 160; ++x) {
        const cv::Vec3b c = frame.at<cv::Vec3b>(y, x);
        if (c[2] > 60) {
          EXPECT_GT(c[2], c[0]) << x << ", " << y;
        }
      }
}

TEST(Forms, ALoopLeadsBackToThePicture) {
  const FlowingStore store({BurningClip{}.clip()});
  AnimateOptions options = forms();
  options.loop = true;
  const Made made = made_with(store, options);
  EXPECT_EQ(apart(made.frames[0], kPicture.draw()), 0);
  const auto changed = [](const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_L1); };
  EXPECT_LT(changed(made.frames.back(), made.frames[0]), 0.7 * changed(made.frames[12], made.frames[0]));
}

TEST(Forms, AreTheSameForAnyThreadsAndAnyRange) {
  expect_same_for_any_threads_and_range(FlowingStore({BurningClip{}.clip()}), forms(), 19, matte());
}

TEST(Forms, TheFluidOverThePictureIsTheFrame) {
  const FlowingStore store({BurningClip{}.clip()});
  const Made whole = made_with(store, forms(12));
  AnimateOptions options = forms(12);
  options.form = FrameForm::kFluid;
  const Made fluid = made_with(store, options);
  const cv::Mat picture = kPicture.units();
  for (std::size_t i = 0; i < whole.frames.size(); ++i)
    for (int y = 0; y < picture.rows; ++y)
      for (int x = 0; x < picture.cols; ++x) {
        const cv::Vec4f over = fluid.frames[i].at<cv::Vec4f>(y, x);
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR(255 * (over[k] + (1 - over[3]) * picture.at<cv::Vec3f>(y, x)[k]),
                      whole.frames[i].at<cv::Vec3b>(y, x)[k], 0.51);
      }
}

TEST(Forms, TheirMotionLeadsToTheNextFrame) {
  const FlowingStore store({BurningClip{}.clip()});
  for (const bool loop : {false, true}) {
    AnimateOptions options = forms();
    options.loop = loop;
    std::vector<cv::Mat> motions;
    options.motion_sink = [&](const cv::Mat& motion) { motions.push_back(motion.clone()); };
    std::vector<cv::Mat> frames = made_with(store, options).frames;
    ASSERT_EQ(motions.size(), frames.size());
    for (const cv::Mat& motion : motions) {
      EXPECT_EQ(motion.type(), CV_32FC2);
      EXPECT_EQ(cv::norm(motion, cv::NORM_INF, matte() == 0), 0);
      EXPECT_LT(cv::norm(motion.at<cv::Vec2f>(30, 65)), 0.01) << "dark ground";
    }
    if (loop) frames.push_back(frames.front()), motions.push_back({});
    EXPECT_LT(carried_error(frames, motions, matte()), 0.6) << loop;
  }
}

TEST(Forms, SayWhatIsLacking) {
  const FlowingStore store({BurningClip{}.clip()});
  AnimateOptions options = forms();
  std::get<FormsOptions>(options.method).excluded = {"0.mkv"};
  EXPECT_THROW(made_with(store, options), Error);
}

}  // namespace
}  // namespace freshet::synth::animate
