#include "synth/animate/forms/form_choice.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "synth/animate/forms/clip_forms.h"
#include "tests/synth/animate/forms/burning.h"

namespace freshet::synth::animate {
namespace {

PartedStill parted(const BurningPicture& picture) {
  return part(picture.units(), cv::Mat(picture.size, CV_32F, cv::Scalar(1)));
}

TEST(ClipForms, LightIsWhatThePlaceIsNotAtItsDarkest) {
  const FlowingStore store({BurningClip{}.clip()});
  const ClipForms forms = clip_forms(store.snapshot(), store.id(), 480);
  ASSERT_EQ(forms.levels.size(), 40);
  ASSERT_EQ(forms.seats.size(), 1);
  EXPECT_NEAR(forms.seats[0].bed, 100, 6);
  EXPECT_NEAR((forms.seats[0].left + forms.seats[0].right) / 2, 80, 4);
  EXPECT_EQ(forms.mean.at<float>(10, 10), 0);
  EXPECT_GT(forms.mean.at<float>(90, 80), 0.5);
}

TEST(Darkest, AFlameThatIsAlwaysThereIsNoGround) {
  std::vector<cv::Mat> frames;
  for (int i = 0; i < 20; ++i) {
    cv::Mat frame(40, 40, CV_8U, cv::Scalar(10));
    frame(cv::Rect(15, 15, 10, 10)).setTo(150 + 5 * i);  // burns
    frame(cv::Rect(2, 2, 8, 8)).setTo(150);              // stands: a lit wall
    frames.push_back(frame);
  }
  const cv::Mat dark = darkest(frames);
  EXPECT_LT(dark.at<std::uint8_t>(20, 20), 20);
  EXPECT_EQ(dark.at<std::uint8_t>(5, 5), 150);
  EXPECT_EQ(dark.at<std::uint8_t>(35, 35), 10);
}

TEST(ChooseForms, TheClipWhoseFlamesAreAlikeBurnsOnThePicturesBed) {
  const FlowingStore store({BurningClip{.width = 110, .height = 25}.clip(), BurningClip{}.clip()});
  const std::vector<ClipForms> clips{clip_forms(store.snapshot(), store.id(0), 480),
                                     clip_forms(store.snapshot(), store.id(1), 480)};
  const BurningPicture picture;
  const std::vector<ChosenForm> forms = choose_forms(parted(picture), clips, 0.5);
  ASSERT_EQ(forms.size(), 1);
  EXPECT_EQ(forms[0].clip, 1);
  EXPECT_GT(forms[0].fit, 0.6);
  const auto across = forms[0].to.width / forms[0].from.width,
             down = forms[0].to.height / forms[0].from.height;
  const double bed = forms[0].to.y + (100 - forms[0].from.y) * down;
  const double axis = forms[0].mirrored ? forms[0].to.br().x - (80 - forms[0].from.x) * across
                                        : forms[0].to.x + (80 - forms[0].from.x) * across;
  EXPECT_NEAR(bed, picture.bed.y, 6);
  EXPECT_NEAR(axis, picture.bed.x, 5);
  EXPECT_NEAR(down, 80 / 60.0, 0.25);
  EXPECT_NEAR(overall_fit(forms), forms[0].fit, 1e-9);
}

TEST(ChooseForms, EnoughOfTheClipIsLeftAfterItsFirstFrame) {
  const FlowingStore store({BurningClip{.frames = 60}.clip()});
  const std::vector<ClipForms> clips{clip_forms(store.snapshot(), store.id(), 480)};
  const std::vector<ChosenForm> forms = choose_forms(parted({}), clips, 1.2);
  ASSERT_EQ(forms.size(), 1);
  EXPECT_LT(forms[0].first, 30);
}

TEST(ChooseForms, WithoutFlamesInClipOrPictureThereAreNone) {
  const FlowingStore store({FlowingClip{
      .size = {160, 120}, .drawn = [](int) { return cv::Mat(120, 160, CV_8U, cv::Scalar(40)); }}});
  const std::vector<ClipForms> clips{clip_forms(store.snapshot(), store.id(), 480)};
  EXPECT_TRUE(choose_forms(parted({}), clips, 1).empty());
  EXPECT_EQ(overall_fit({}), 0);
}

TEST(BeatsAsOne, AreALampsAndNotAFires) {
  std::vector<cv::Mat> lamp, fire;
  for (int i = 0; i < 30; ++i) {
    cv::Mat lit, burning = cv::Mat::zeros(90, 120, CV_32F);
    const cv::Mat shade = flame({120, 90}, {60, 80}, 60, 60);
    cv::Mat((0.6 + 0.4 * std::sin(0.8 * i)) * 255 * shade).convertTo(lit, CV_8U);
    lamp.push_back(lit.clone());
    for (int k = 0; k < 5; ++k)
      burning = cv::max(burning, flame({120, 90}, {15 + 22 * k, 80}, 16,
                                       cvRound(40 + 20 * std::sin((0.7 + 0.23 * k) * i + k))));
    cv::Mat(255 * burning).convertTo(lit, CV_8U);
    fire.push_back(lit);
  }
  EXPECT_GT(beats_as_one(lamp), 0.95);
  EXPECT_LT(beats_as_one(fire), 0.4);
  EXPECT_EQ(beats_as_one({lamp[0], lamp[0]}), 0);
}

}  // namespace
}  // namespace freshet::synth::animate
