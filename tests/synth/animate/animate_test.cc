#include "synth/animate/animate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <ostream>
#include <stop_token>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "tests/harness/fault.h"
#include "tests/synth/animate/carried_error.h"
#include "tests/synth/animate/flowing_clip.h"
#include "tests/synth/animate/measured_clip.h"

namespace freshet::synth::animate {
namespace {

using Frames = std::vector<cv::Mat>;

/// A way to make frames, and what it made of the scene below when its golden hash was taken.
struct Case {
  std::string name;
  AnimateOptions options;
  std::uint64_t golden = 0;
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

Case with(std::string name, std::uint64_t golden, decltype(AnimateOptions::method) method, bool loop = false,
          outline::Outline boundary = outline::Outline::kStatic) {
  Case one{.name = std::move(name), .options = {}, .golden = golden};
  one.options.frames = 20;
  one.options.loop = loop;
  one.options.outline.kind = boundary;
  one.options.method = std::move(method);
  return one;
}

std::vector<Case> cases() {
  const CarriedOptions motion_alone{.innovations = std::nullopt};
  CarriedOptions layout, goes;
  layout.layout = Layout::kStands;
  goes.layout = Layout::kGoes;
  const PaperOptions by_frame{.matching = AppearanceMatching::kFrame},
      nearest{.resampling = Resampling::kNearest};
  return {with("Carried", 0x534e492df7c77c27, CarriedOptions{}),
          with("CarriedLoop", 0x36e27fe761023ab4, CarriedOptions{}, true),
          with("CarriedMoving", 0xe82f901b2df53aa2, CarriedOptions{}, false, outline::Outline::kMoving),
          with("Goes", 0xd62f022c6224d873, goes),
          with("Layout", 0x90bd28c311bc7068, layout),
          with("LayoutLoop", 0x099665e54d2e0226, layout, true),
          with("MotionAlone", 0xf5fe457b7cccdc0d, motion_alone),
          with("MotionAloneMoving", 0xd575d8671dec47a, motion_alone, false, outline::Outline::kMoving),
          with("Paper", 0x766e084f56b9d34e, PaperOptions{}),
          with("PaperByFrame", 0x850851d95d502cce, by_frame),
          with("PaperLoopOfWholeFrames", 0x773eac3116f75d0d, nearest, true),
          with("PaperMoving", 0xbd60be059ec845fe, PaperOptions{}, false, outline::Outline::kMoving)};
}

/// A picture whose fluid two clips move; of the second the layout stands.
class Animated : public testing::TestWithParam<Case> {
 protected:
  static void SetUpTestSuite() {
    scene_ = new Scene;
    for (int y = 0; y + 48 <= 110; y += 24)
      for (int x = 0; x + 48 <= 150; x += 24)
        scene_->placement.patches.push_back({.piece = {x, y},
                                             .clip = scene_->store.id(x < 60 ? 0 : 1),
                                             .variant = {},
                                             .patch = {x, y},
                                             .speed = x < 60 ? 1 : 0.8});
    cv::RNG(3).fill(scene_->picture, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(scene_->picture, scene_->picture, {}, 2);
    scene_->matte(cv::Rect(10, 10, 120, 80)).setTo(255);
    cv::blur(scene_->matte, scene_->matte, {7, 7});
  }
  static void TearDownTestSuite() { delete scene_; }

  struct Made {
    Frames frames;
    AnimateReport report;
  };
  static Made animated(const AnimateOptions& options, std::stop_token stop = {}) {
    Made made;
    made.report = animate(
        scene_->store.snapshot(), scene_->store.settings(), scene_->picture, scene_->matte, scene_->placement,
        options, [&](const cv::Mat& frame) { made.frames.push_back(frame.clone()); }, {}, std::move(stop));
    return made;
  }
  /// Of the parameter's options, made once.
  static const Frames& whole() {
    static std::string of;
    static Frames frames;
    if (of != GetParam().name) {
      of = GetParam().name;
      frames = animated(GetParam().options).frames;
    }
    return frames;
  }
  static const cv::Mat& picture() { return scene_->picture; }
  static const cv::Mat& matte() { return scene_->matte; }

 private:
  struct Scene {
    FlowingStore store{
        {measured({.frames = 26, .life = living(0.5f)}), measured({.frames = 26,
                                                                   .steady = {2, 1},
                                                                   .seed = 5,
                                                                   .life = living(0.5f),
                                                                   .contrast = contrasts(0.8f, 0.2f)})}};
    Placement placement{.side = 48, .stride = 24, .patches = {}};
    cv::Mat picture = cv::Mat(100, 144, CV_8UC3), matte = cv::Mat(100, 144, CV_8U, cv::Scalar(0));
  };
  inline static Scene* scene_ = nullptr;
};

bool same(const cv::Mat& one, const cv::Mat& other) {
  if (one.size() != other.size() || one.type() != other.type()) return false;
  for (int y = 0; y < one.rows; ++y)
    if (std::memcmp(one.ptr(y), other.ptr(y), static_cast<std::size_t>(one.cols) * one.elemSize()) != 0)
      return false;
  return true;
}

void expect_same(const Frames& one, const Frames& other) {
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(same(one[i], other[i])) << "frame " << i;
}

/// FNV-1a.
std::uint64_t hash_of(const Frames& frames) {
  std::uint64_t hash = 1469598103934665603u;
  for (const cv::Mat& frame : frames)
    for (int y = 0; y < frame.rows; ++y)
      for (std::size_t i = 0; i < frame.cols * frame.elemSize(); ++i)
        hash = (hash ^ frame.ptr(y)[i]) * 1099511628211u;
  return hash;
}

TEST_P(Animated, FramesAreThoseOfTheGoldenHash) { EXPECT_EQ(hash_of(whole()), GetParam().golden); }

TEST_F(Animated, WideFormsGoWhereTheyAreNotToStand) {
  const auto changed = [](double wide_layout) {
    AnimateOptions options;
    options.frames = 20;
    options.method = CarriedOptions{.wide_layout = wide_layout, .holds_light = false};
    cv::Mat last, still;
    animated(options).frames.back().convertTo(last, CV_32F);
    picture().convertTo(still, CV_32F);
    cv::Mat wide = last - still;
    cv::GaussianBlur(wide, wide, {}, 6);
    return cv::norm(wide({84, 20, 36, 60}), cv::NORM_L1);  // where the layout stands
  };
  EXPECT_GT(changed(0), 1.25 * changed(1));
}

TEST_F(Animated, WhatIsFreedGoes) {
  const auto made_with = [](const CarriedOptions& carried) {
    AnimateOptions options;
    options.frames = 20;
    options.method = carried;
    return animated(options).frames;
  };
  const cv::Rect standing(84, 20, 36, 60);
  cv::Mat freed = cv::Mat::ones(picture().size(), CV_32F);
  const Frames all = made_with({.freed = freed}), measured = made_with({});
  expect_same(all, made_with({.layout = Layout::kGoes}));
  EXPECT_FALSE(same(all.back()(standing), measured.back()(standing)));
  // One half: what stands in the other does as before, but near it.
  freed.rowRange(0, 50).setTo(0);
  const Frames half = made_with({.freed = freed});
  const auto differ = [&](const cv::Rect& where) {
    return cv::norm(half.back()(where), measured.back()(where), cv::NORM_L1) / where.area();
  };
  EXPECT_GT(differ({84, 64, 36, 20}), 4 * differ({84, 8, 36, 20}));
}

TEST_P(Animated, FramesAreTheSameForAnyMemory) {
  AnimateOptions options = GetParam().options;
  options.memory_bytes = 1;
  const Made small = animated(options);
  const auto* const carried = std::get_if<CarriedOptions>(&options.method);
  EXPECT_EQ(small.report.batches, carried != nullptr && !carried->innovations ? 1 : 2);
  expect_same(whole(), small.frames);
}

TEST_P(Animated, FramesAreTheSameForAnyNumberOfThreads) {
  for (const std::size_t threads : {1, 3}) {
    const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    expect_same(whole(), animated(GetParam().options).frames);
  }
}

TEST_P(Animated, APartIsThatPartOfTheWhole) {
  for (const std::size_t memory : {std::size_t{1}, std::size_t{1} << 31})
    for (const auto& [from, until] : {std::pair{0, 3}, {9, 13}, {17, 0}}) {
      AnimateOptions options = GetParam().options;
      options.memory_bytes = memory;
      options.from = from;
      options.until = until;
      const Frames frames(whole().begin() + from, until == 0 ? whole().end() : whole().begin() + until);
      expect_same(frames, animated(options).frames);
    }
}

TEST_P(Animated, WhereTheMatteIs0AFrameIsThePicture) {
  if (GetParam().options.moving()) return;  // the outline goes beyond the matte
  for (const cv::Mat& frame : whole()) {
    cv::Mat different;
    cv::absdiff(frame, picture(), different);
    different.setTo(cv::Scalar::all(0), matte());
    EXPECT_EQ(cv::countNonZero(different.reshape(1)), 0);
  }
}

TEST_P(Animated, TheFluidMoves) {
  for (std::size_t i = 1; i < whole().size(); ++i) {
    cv::Mat different;
    cv::absdiff(whole()[i], whole()[i - 1], different);
    EXPECT_GT(cv::mean(different, matte())[0], 0.3) << i;
  }
}

TEST_P(Animated, TheFluidAloneOverThePictureIsTheWhole) {
  if (GetParam().options.moving()) return;  // it lies over what is behind the fluid
  AnimateOptions options = GetParam().options;
  options.form = FrameForm::kFluid;
  const Frames fluid = animated(options).frames;
  ASSERT_EQ(fluid.size(), whole().size());
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    ASSERT_EQ(fluid[i].type(), CV_32FC4);
    double worst = 0;
    for (int y = 0; y < picture().rows; ++y)
      for (int x = 0; x < picture().cols; ++x)
        for (int c = 0; c < 3; ++c) {
          const cv::Vec4f& over = fluid[i].at<cv::Vec4f>(y, x);
          const float laid =
              255 * over[c] + (1 - over[3]) * static_cast<float>(picture().at<cv::Vec3b>(y, x)[c]);
          worst = std::max(
              worst, std::abs(double{std::clamp(laid, 0.f, 255.f)} - whole()[i].at<cv::Vec3b>(y, x)[c]));
        }
    EXPECT_LE(worst, 1) << "frame " << i;
  }
}

TEST_P(Animated, EachFrameHasItsMatteAndItsMotion) {
  AnimateOptions options = GetParam().options;
  options.from = 5;
  Frames mattes, motions;
  options.matte_sink = [&](const cv::Mat& matte) { mattes.push_back(matte.clone()); };
  options.motion_sink = [&](const cv::Mat& motion) { motions.push_back(motion.clone()); };
  const Frames frames = animated(options).frames;
  EXPECT_EQ(frames.size(), 15u);
  EXPECT_EQ(mattes.size(), frames.size());
  EXPECT_EQ(motions.size(), frames.size());
  for (const cv::Mat& matte : mattes) EXPECT_EQ(matte.type(), CV_32F);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    EXPECT_EQ(motions[i].type(), CV_32FC2);
    EXPECT_GT(cv::norm(motions[i], cv::NORM_INF), 0.5);
    cv::Mat beside = motions[i].clone();
    beside.setTo(cv::Scalar::all(0), mattes[i] > 0);
    EXPECT_EQ(cv::norm(beside, cv::NORM_INF), 0);
  }
}

TEST(AnimatedMotion, LeadsToTheNextFrame) {
  // Texture that goes as its flow says.
  const FlowingStore store({measured({.frames = 26, .steady = {2, 1}, .varying = 0, .anew = 0})});
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  for (int y = 0; y + 48 <= 110; y += 24)
    for (int x = 0; x + 48 <= 150; x += 24)
      placement.patches.push_back(
          {.piece = {x, y}, .clip = store.id(0), .variant = {}, .patch = {x, y}, .speed = 1});
  cv::Mat picture(100, 144, CV_8UC3);
  cv::RNG(3).fill(picture, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(picture, picture, {}, 2);
  const cv::Mat matte(picture.size(), CV_8U, cv::Scalar(255));
  const cv::Mat inside = cv::Mat(matte).clone();
  cv::rectangle(inside, {0, 0}, {143, 99}, 0, 12);
  for (const Method& method : {Method(CarriedOptions{}), Method(PaperOptions{})})
    for (const double fps : {25.0, 50.0}) {
      AnimateOptions options;
      options.frames = 20, options.fps = fps;
      options.method = method;
      Frames frames, motions;
      options.motion_sink = [&](const cv::Mat& motion) { motions.push_back(motion.clone()); };
      animate(store.snapshot(), store.settings(), picture, matte, placement, options,
              [&](const cv::Mat& frame) { frames.push_back(frame.clone()); });
      EXPECT_LT(carried_error(frames, motions, inside), 0.5) << method.index() << " at " << fps;
    }
}

TEST_P(Animated, StopsWhereItIsAskedTo) {
  std::stop_source stop;
  AnimateOptions options = GetParam().options;
  options.matte_sink = [&](const cv::Mat&) { stop.request_stop(); };
  fault_of(ErrorKind::kCancelled, [&] { animated(options, stop.get_token()); });
}

INSTANTIATE_TEST_SUITE_P(Methods, Animated, testing::ValuesIn(cases()),
                         [](const auto& one) { return one.param.name; });

struct Carried : Animated {};

TEST_P(Carried, BeginsAsThePicture) {
  cv::Mat different;
  cv::absdiff(whole().front(), picture(), different);
  // Colour is carried at half the size: of this noise a little is lost.
  EXPECT_LE(cv::norm(different, cv::NORM_INF), 8);
  EXPECT_LT(cv::mean(different, matte())[0], 2);
}

TEST_P(Carried, ALayoutStandsInsideAFixedOutlineAlone) {
  AnimateOptions options = GetParam().options;
  std::get<CarriedOptions>(options.method).layout = Layout::kStands;
  if (options.moving()) {
    EXPECT_THROW(animated(options), Error);
    return;
  }
  cv::Mat different;
  cv::absdiff(animated(options).frames.front(), picture(), different);
  EXPECT_LE(cv::norm(different, cv::NORM_INF), 8);
}

INSTANTIATE_TEST_SUITE_P(
    Methods, Carried,
    testing::Values(with("Static", 0, CarriedOptions{}), with("Loop", 0, CarriedOptions{}, true),
                    with("Moving", 0, CarriedOptions{}, false, outline::Outline::kMoving)),
    [](const auto& one) { return one.param.name; });

struct Paper : Animated {
  static AnimateOptions printed(AppearanceMatching matching) {
    AnimateOptions options = GetParam().options;
    std::get<PaperOptions>(options.method).matching = matching;
    return options;
  }
  /// Standard deviation of luma inside the matte.
  static double contrast(const cv::Mat& frame) {
    cv::Mat luma;
    cv::cvtColor(frame, luma, cv::COLOR_BGR2GRAY);
    cv::Scalar mean, deviation;
    cv::meanStdDev(luma, mean, deviation, matte() == 255);
    return deviation[0];
  }
  /// The least and the most of any frame, in the picture's.
  static std::pair<double, double> contrasts(AppearanceMatching matching) {
    double least = 1e9, most = 0;
    for (const cv::Mat& frame : animated(printed(matching)).frames) {
      least = std::min(least, contrast(frame) / contrast(picture()));
      most = std::max(most, contrast(frame) / contrast(picture()));
    }
    return {least, most};
  }
};

TEST_P(Paper, MatchingByFrameGivesEveryFrameThePicturesContrast) {
  const auto [least, most] = contrasts(AppearanceMatching::kFrame);
  EXPECT_GT(least, 0.8);
  EXPECT_LT(most, 1.2);
  const auto [least_sequence, most_sequence] = contrasts(AppearanceMatching::kSequence);
  EXPECT_GT(most_sequence - least_sequence, 1.5 * (most - least)) << "one model leaves frames their own";
  const auto [least_raw, most_raw] = contrasts(AppearanceMatching::kNone);
  EXPECT_GT(least_raw, 1.5) << "the clips have more of it";
}

TEST_P(Paper, ALoopOfWholeFramesBeginsAtTheLeastChange) {
  AnimateOptions options = printed(AppearanceMatching::kNone);
  std::get<PaperOptions>(options.method).resampling = Resampling::kNearest;
  options.loop = true;
  const Frames frames = animated(options).frames;
  std::vector<double> changes;
  for (std::size_t i = 0; i < frames.size(); ++i)
    changes.push_back(cv::norm(frames[i], frames[(i + 1) % frames.size()], cv::NORM_L1));
  // What changes least is estimated from the clips' frames, before they are blended.
  const auto smaller = std::ranges::count_if(changes, [&](double change) { return change < changes.back(); });
  EXPECT_LE(smaller, 3);
}

INSTANTIATE_TEST_SUITE_P(Methods, Paper, testing::Values(with("Printed", 0, PaperOptions{})),
                         [](const auto& one) { return one.param.name; });

TEST(PaperBlend, BandsGoOverFromPieceToPieceOverTheirOwnWidths) {
  // To the left a level that swings and a fine grating that flickers, to the right nothing.
  const auto left = [](int i) {
    cv::Mat out(110, 150, CV_8U);
    for (int x = 0; x < out.cols; ++x)
      out.col(x).setTo(128 + (i % 2 == 0 ? 1 : -1) * (30 + (x % 4 < 2 ? 30 : -30)));
    return out;
  };
  const auto right = [](int) { return cv::Mat(110, 150, CV_8U, cv::Scalar(128)); };
  const FlowingStore store({measured({.frames = 20, .varying = 0, .drawn = left}),
                            measured({.frames = 20, .varying = 0, .drawn = right})});
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  for (int y = 0; y + 48 <= 96; y += 24)
    for (int x = 0; x + 48 <= 144; x += 24)
      placement.patches.push_back(
          {.piece = {x, y}, .clip = store.id(x < 60 ? 0 : 1), .variant = {}, .patch = {0, 0}});
  AnimateOptions options;
  options.frames = 10;
  options.method = PaperOptions{.resampling = Resampling::kNearest,
                                .blend = {.weights = BlendWeights::kPaper, .low_band = LowBand::kKeep},
                                .matching = AppearanceMatching::kNone};
  Frames frames;
  animate(store.snapshot(), store.settings(), cv::Mat(96, 144, CV_8UC3, cv::Scalar::all(128)),
          cv::Mat(96, 144, CV_8U, cv::Scalar(255)), placement, options,
          [&](const cv::Mat& frame) { frames.push_back(frame.clone()); });
  cv::Mat first, luma;
  cv::cvtColor(frames[0], first, cv::COLOR_BGR2GRAY);
  first.convertTo(luma, CV_32F, 1, -128);
  // Of four columns, one period of the grating.
  const auto level = [&](int x) { return std::abs(cv::mean(luma(cv::Rect(x, 40, 4, 8)))[0]); };
  const auto grating = [&](int x) {
    return std::abs(cv::mean(luma(cv::Rect(x, 40, 2, 8)))[0] - cv::mean(luma(cv::Rect(x + 2, 40, 2, 8)))[0]) /
           2;
  };
  // Its owner changes at 84: a level goes over within the whole overlap, fine detail within a few px.
  EXPECT_NEAR(level(60), 30, 1);
  EXPECT_LT(level(76), 26);
  EXPECT_GT(grating(76), 28);
  EXPECT_GT(level(88), 5);
  EXPECT_LT(grating(88), 3);
  EXPECT_LT(level(100), 1);
}

}  // namespace
}  // namespace freshet::synth::animate
