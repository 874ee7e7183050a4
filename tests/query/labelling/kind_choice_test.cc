#include "query/labelling/kind_choice.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "query/index/index_builder.h"
#include "query/labelling/label_request.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

/// Tongues from red at their rim to yellow at their heart, on black.
struct Burning {
  cv::Mat picture{240, 320, CV_8UC3, cv::Scalar(4, 4, 6)}, matte{240, 320, CV_8U, cv::Scalar(0)};
  Burning() {
    for (int x = 110; x <= 210; x += 25) {
      cv::ellipse(picture, {x, 170}, {22, 62}, 0, 0, 360, {15, 70, 210}, cv::FILLED);
      cv::ellipse(picture, {x, 180}, {14, 45}, 0, 0, 360, {40, 150, 250}, cv::FILLED);
      cv::ellipse(picture, {x, 190}, {7, 25}, 0, 0, 360, {130, 235, 255}, cv::FILLED);
      cv::ellipse(matte, {x, 170}, {24, 64}, 0, 0, 360, 255, cv::FILLED);
    }
  }
};

class Kinds : public testing::Test {
 protected:
  void fill(const std::vector<MadeClip>& clips) {
    store::Store store = made_store(folder_.path() / "a.store", clips);
    build_index(store);
    snapshot_.emplace(store.snapshot());
    base_.emplace(open_search(*snapshot_));
  }
  PreparedLabelling prepared(const std::string& class_name, double duration_s = .5) {
    LabelRequest request{.duration_s = duration_s, .guesses = false};
    request.options.candidates.k = 8;
    request.options.candidates.class_name = class_name;
    return prepare(*snapshot_, *base_, fire_.picture, fire_.matte, request);
  }
  Labelling labelled(const LabelOptions& options) {
    return label(*snapshot_, *base_, fire_.picture, fire_.matte, options);
  }
  static bool has(const Assignment& assignment, const std::string& class_name) {
    return std::ranges::any_of(assignment.clips,
                               [&](const AssignedClip& clip) { return clip.class_name == class_name; });
  }

  const ScratchFolder folder_;
  const Burning fire_;
  std::optional<store::Snapshot> snapshot_;
  std::optional<SearchBase> base_;
};

const std::vector<MadeClip> kMixed{{.name = "fall", .class_name = "water", .texture = 3},
                                   {.name = "camp", .class_name = "fire", .motion = {0, -50}, .texture = 5},
                                   {.name = "torch", .class_name = "fire", .motion = {5, -50}, .texture = 6},
                                   {.name = "sea", .class_name = "water", .motion = {30, 0}, .texture = 7}};

TEST_F(Kinds, ASureLookTakesItsClassAloneAndSaysHowToOverruleIt) {
  fill(kMixed);
  const PreparedLabelling seen = prepared("");
  EXPECT_EQ(seen.kind.taken, "fire");
  EXPECT_EQ(seen.options.candidates.class_name, "fire");
  EXPECT_NE(seen.kind.words.find("fire only; --class any"), std::string::npos) << seen.kind.words;
  EXPECT_FALSE(has(labelled(seen.options).assignment, "water"));
}

TEST_F(Kinds, FlamesThatAreAskedToGoAreChosenByTheirLooks) {
  fill(kMixed);
  const cv::Size picture = fire_.picture.size();
  LabelRequest request{.duration_s = .5, .guesses = false};
  request.options.candidates.k = 8;
  const auto price = [&] {
    const GuideCosts costs =
        prepare(*snapshot_, *base_, fire_.picture, fire_.matte, request).options.guide_costs;
    return costs.direction + costs.speed + costs.unsteady;
  };
  request.options.guide.direction = cv::Mat(picture, CV_32FC2, cv::Scalar(0, -1));
  EXPECT_GT(price(), 0);
  request.options.guide.speed = cv::Mat(picture, CV_32F, cv::Scalar(20));
  EXPECT_EQ(price(), 0);
  request.options.guide.speed.setTo(8, fire_.matte);  // what is asked beside them does not count
  EXPECT_GT(price(), 0);
  request.options.guide.speed.setTo(20);
  request.options.hint_search = HintSearch::kNarrow;
  EXPECT_GT(price(), 0);
  request.options.hint_search = HintSearch::kWide;
  request.options.candidates.class_name = "water";
  EXPECT_GT(price(), 0);
}

TEST_F(Kinds, WhatIsHeldBackCountsToTheLook) {
  fill(kMixed);
  LabelRequest request{.duration_s = .5, .guesses = false};
  request.options.candidates.k = 8;
  // Of the flames their black rims alone: no fire, by themselves.
  cv::Mat rims = fire_.matte.clone(), bright;
  cv::extractChannel(fire_.picture, bright, 2);
  rims.setTo(0, bright > 30);
  EXPECT_NE(prepare(*snapshot_, *base_, fire_.picture, rims, request).kind.taken, "fire");
  request.looked_at = fire_.matte;
  EXPECT_EQ(prepare(*snapshot_, *base_, fire_.picture, rims, request).kind.taken, "fire");
}

TEST_F(Kinds, AnyMixesAsASearchThatNamesNoClass) {
  fill(kMixed);
  const PreparedLabelling any = prepared("any");
  EXPECT_EQ(any.kind.taken, "");
  EXPECT_EQ(any.kind.words, "");
  LabelOptions plain = any.options;
  plain.candidates.class_name.clear();
  const Labelling mixed = labelled(any.options), all = labelled(plain);
  EXPECT_EQ(mixed.labels, all.labels);
  EXPECT_EQ(mixed.search.candidates.rows, all.search.candidates.rows);
  EXPECT_GT(mixed.search.filtered.rows.count(), labelled(prepared("").options).search.filtered.rows.count());
}

TEST_F(Kinds, AClassThatIsSaidHolds) {
  fill(kMixed);
  const PreparedLabelling said = prepared("water");
  EXPECT_EQ(said.options.candidates.class_name, "water");
  EXPECT_EQ(said.kind.words, "");
  EXPECT_EQ(said.kind.look.name(), "fire") << "the look is told all the same";
}

TEST_F(Kinds, AStoreWithoutTheKindMixesAndSaysSo) {
  fill({{.name = "fall", .class_name = "water"}, {.name = "sky", .class_name = "clouds", .texture = 4}});
  const PreparedLabelling seen = prepared("");
  EXPECT_EQ(seen.options.candidates.class_name, "");
  EXPECT_NE(seen.kind.words.find("no clip of it"), std::string::npos) << seen.kind.words;
}

TEST_F(Kinds, ClipsThatAreTooShortAreNotTaken) {
  fill({{.name = "fall", .class_name = "water", .seconds = 4},
        {.name = "spark", .class_name = "fire", .seconds = 1, .texture = 4}});
  EXPECT_EQ(prepared("", .5).kind.taken, "fire");
  const PreparedLabelling longer = prepared("", 3);
  EXPECT_EQ(longer.kind.taken, "");
  EXPECT_NO_THROW(labelled(longer.options));
}

TEST_F(Kinds, AStoreOfOneClassIsNotAskedAbout) {
  fill({{.name = "fall", .class_name = "water"}});
  EXPECT_EQ(prepared("").kind.words, "");
}

TEST_F(Kinds, AnUnsureLookTakesTheLikeliestClassAndAsks) {
  fill(kMixed);
  CandidateOptions candidates;
  const cv::Mat flat(240, 320, CV_8UC3, cv::Scalar::all(90)), all(240, 320, CV_8U, cv::Scalar(255));
  const KindChoice choice = choose_kind(*snapshot_, *base_, flat, all, {}, candidates);
  ASSERT_FALSE(choice.look.sure());
  EXPECT_EQ(choice.taken, choice.look.name());
  EXPECT_EQ(candidates.class_name, choice.taken);
  EXPECT_NE(choice.words.find("unsure"), std::string::npos) << choice.words;
  EXPECT_NE(choice.words.find("--class says which"), std::string::npos) << choice.words;
  EXPECT_THROW(choose_kind(*snapshot_, *base_, flat, all.rowRange(0, 9), {}, candidates), Error);
  const MotionGuide smaller{.direction = cv::Mat(120, 160, CV_32FC2, cv::Scalar(1, 0))};
  candidates.class_name.clear();
  EXPECT_THROW(choose_kind(*snapshot_, *base_, flat, all, smaller, candidates), Error);
}

TEST_F(Kinds, AnUnsureLookGoesAsItsClassDoes) {
  fill({{.name = "fall", .class_name = "water", .texture = 3},
        {.name = "sky", .class_name = "clouds", .motion = {30, 0}, .texture = 5}});
  // From crumbs to blots, until it may be either.
  const cv::Size size(320, 240);
  const cv::Mat all(size, CV_8U, cv::Scalar(255));
  cv::Mat noise(size, CV_32FC3), picture;
  cv::RNG(7).fill(noise, cv::RNG::NORMAL, 0, 1);
  const auto may_be = [&](std::size_t kind) {
    return vision::fluid_kind(vision::fluid_look(picture, all)).share[kind];
  };
  double sigma = 1;
  do {
    sigma *= 1.02;
    cv::GaussianBlur(noise, picture, {}, sigma);
    cv::normalize(picture, picture, 0, 255, cv::NORM_MINMAX);
    picture.convertTo(picture, CV_8U, 0.5, 60);
  } while (sigma < 40 && (may_be(0) < 0.15 || may_be(3) < 0.15));
  ASSERT_GT(may_be(0), 0.15);
  ASSERT_GT(may_be(3), 0.15);
  const auto taken = [&](const cv::Scalar& way) {
    CandidateOptions candidates;
    const MotionGuide guide{.direction = cv::Mat(size, CV_32FC2, way)};
    return choose_kind(*snapshot_, *base_, picture, all, guide, candidates).taken;
  };
  EXPECT_EQ(taken({0, 1}), "water") << "a fall goes down";
  EXPECT_EQ(taken({1, 0}), "clouds") << "a sky goes right";
}

}  // namespace
}  // namespace freshet::query
