// Edits, plans and their frames.
#include "synth/stills/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include <oneapi/tbb/global_control.h>

#include "freshet/error.h"
#include "synth/stills/rendering.h"
#include "synth/stills/stills_page.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"
#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

const std::vector<std::string> kNames{"a.png", "b.png", "c.png", "d.png", "e.png"};

struct Scene {
  std::vector<cv::Mat> stills = made_pendulum({0, .25, .5, .75, 1});
  std::vector<Region> regions{{.name = "1", .mask = cv::Mat(96, 160, CV_8U, cv::Scalar(0)), .parent = {}}};
  Scene() { regions[0].mask(cv::Rect(16, 20, 128, 56)).setTo(255); }
};

class Edits : public testing::Test {
 protected:
  std::vector<RegionEdits> read(const std::string& text) const { return all(text).regions; }
  StillsEdits all(const std::string& text) const {
    std::ofstream(file_) << text;
    return read_edits(file_);
  }
  std::string fault(const std::string& text) const {
    return fault_of([&] { read(text); });
  }
  const ScratchFolder folder_;
  const std::filesystem::path file_ = folder_ / "edits.toml";
};

TEST_F(Edits, SpeedAndPathsOfOneRegionAreHeeded) {
  const Scene scene;
  PlanOptions options{.seconds = 4};
  const Plan plain = make_plan(scene.stills, kNames, scene.regions, options);
  options.edits = read("[[region]]\nname = \"1\"\nspeed = 0.5\nturn = [[\"a.png\", \"e.png\"]]\n");
  const Plan edited = make_plan(scene.stills, kNames, scene.regions, options);
  EXPECT_EQ(plain.regions[0].paths.size(), 2u);
  ASSERT_EQ(edited.regions[0].paths.size(), 1u);
  EXPECT_EQ(edited.regions[0].paths[0], (Path{0, 1, 2, 3, 4}));
  const auto mean_step = [](const Plan& plan) {
    return plan.regions[0].timeline.seconds() / static_cast<double>(plan.regions[0].sequence.size() - 1);
  };
  EXPECT_NEAR(mean_step(edited), 2 * mean_step(plain), .3 * mean_step(plain));
}

TEST_F(Edits, ASequenceByHandIsShownAsItStands) {
  const Scene scene;
  PlanOptions options{.seconds = 2, .edits = read("sequence = [\"c.png\", \"a.png\", \"e.png\"]\n")};
  EXPECT_EQ(make_plan(scene.stills, kNames, scene.regions, options).regions[0].sequence,
            (std::vector<int>{2, 0, 4}));
}

TEST_F(Edits, AnEdgeThatIsCutIsWalkedNoMore) {
  const Scene scene;
  PlanOptions options{.seconds = 8, .edits = read("cut = [[\"b.png\", \"c.png\"]]\n")};
  const Plan plan = make_plan(scene.stills, kNames, scene.regions, options);
  const std::vector<int>& shown = plan.regions[0].sequence;
  for (std::size_t k = 0; k + 1 < shown.size(); ++k)
    EXPECT_FALSE(std::minmax(shown[k], shown[k + 1]) == std::minmax(1, 2)) << "step " << k;
}

TEST_F(Edits, MistakesAreNamedWithTheirLine) {
  EXPECT_NE(fault("\nspede = 2\n").find(":2"), std::string::npos) << fault("\nspede = 2\n");
  EXPECT_NE(fault("speed = 99\n").find("out of range"), std::string::npos);
  EXPECT_NE(fault("refuse = [[\"a.png\"]]\n").find("refuse"), std::string::npos);
  EXPECT_NE(fault("[[region]]\nspeed = 2\n").find("name"), std::string::npos);
  EXPECT_NE(fault("speed = [\n").find(file_.filename().string()), std::string::npos);
  const Scene scene;
  for (const char* text :
       {"cut = [[\"a.png\", \"x.png\"]]\n", "refuse = [[\"a.png\", \"e.png\", \"b.png\"]]\n",
        "[[region]]\nname = \"9\"\nspeed = 2\n"}) {
    PlanOptions options{.edits = read(text)};
    EXPECT_THROW(make_plan(scene.stills, kNames, scene.regions, options), Error) << text;
  }
}

std::vector<cv::Mat> frames_of(const Scene& scene, const PlanOptions& options, int threads) {
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(threads));
  const Plan plan = make_plan(scene.stills, kNames, scene.regions, options);
  std::vector<cv::Mat> frames;
  render_frames(plan, scene.stills,
                {.fps = 10, .frames = 20, .flow_side = 160, .grown_px = 1, .feather_px = 2},
                [&](const cv::Mat& frame) { frames.push_back(frame.clone()); });
  return frames;
}

TEST(Rendering, IsTheSameForAnyNumberOfThreads) {
  const Scene scene;
  const PlanOptions options{.seconds = 2};
  const std::vector<cv::Mat> one = frames_of(scene, options, 1), two = frames_of(scene, options, 2);
  ASSERT_EQ(one.size(), 20u);
  for (std::size_t i = 0; i < one.size(); ++i)
    EXPECT_EQ(cv::norm(one[i], two[i], cv::NORM_INF), 0) << "frame " << i;
}

TEST(Rendering, StandsStillOutsideOfRegionsAndPopsNowhere) {
  const Scene scene;
  const std::vector<cv::Mat> frames = frames_of(scene, {.seconds = 2, .loop = true}, 2);
  double most = 0, least = 1e9;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const cv::Mat& next = frames[(i + 1) % frames.size()];
    EXPECT_EQ(cv::norm(frames[i](cv::Rect(0, 0, 160, 10)), next(cv::Rect(0, 0, 160, 10)), cv::NORM_INF), 0);
    const double change = cv::norm(frames[i], next, cv::NORM_L2);
    most = std::max(most, change);
    least = std::min(least, change);
  }
  double leap = 0;
  for (const cv::Mat& other : frames) leap = std::max(leap, cv::norm(frames[0], other, cv::NORM_L2));
  EXPECT_GT(leap, 0) << "something moves";
  EXPECT_LT(most, .7 * leap) << "and no frame follows another, nor the last the first, by a leap";
}

TEST(Page, HoldsEveryStillAndPathAndEscapesNames) {
  const Scene scene;
  std::vector<std::string> names = kNames;
  names[0] = "<a>.png";
  const Plan plan = make_plan(scene.stills, names, scene.regions, {.seconds = 2});
  const std::string page = stills_page(
      plan, scene.stills, {}, {.title = "x & y", .video = {}, .names = names, .notices = {}, .seconds = 2});
  EXPECT_EQ(page.find("<a>"), std::string::npos);
  EXPECT_NE(page.find("&lt;a&gt;"), std::string::npos);
  EXPECT_NE(page.find("refuse = "), std::string::npos);
  for (int i = 0; i < 5; ++i) EXPECT_NE(page.find("id=\"s0-" + std::to_string(i) + "\""), std::string::npos);
}

TEST(Page, LaysOutALineAsALine) {
  Square<double> distances(4);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) distances(i, j) = std::abs(i - j);
  const std::vector<cv::Point2d> at = laid_out(distances);
  for (int i = 0; i + 1 < 4; ++i) EXPECT_NEAR(std::abs(at[i + 1].x - at[i].x), 2. / 3, 1e-6);
}

/// Two fields of texture, with a calm band between them, that slide to and fro together.
struct Sea {
  std::vector<cv::Mat> stills;
  std::vector<Region> regions{
      {.name = "sea", .mask = cv::Mat(200, 320, CV_8U, cv::Scalar(255)), .parent = {}}};
  Sea() {
    for (const int shift : {0, 6, 12, 18, 24}) {
      cv::Mat still(200, 320, CV_8UC3, cv::Scalar(90, 80, 70));
      for (const int top : {0, 115}) {
        cv::Mat noise(85, 400, CV_8UC3);
        cv::RNG(static_cast<std::uint64_t>(top) + 1).fill(noise, cv::RNG::UNIFORM, 0, 255);
        cv::GaussianBlur(noise, noise, {}, 3);
        cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
        noise(cv::Rect(40 - shift, 0, 320, 85)).copyTo(still(cv::Rect(0, top, 320, 85)));
      }
      stills.push_back(still);
    }
  }
};

/// Share of the steps in which a part goes the way of the one that it follows.
double together(const Sea& sea, double follow) {
  int steps = 0, same = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    PlanOptions options{.seconds = 20, .split = 2, .follow = follow};
    options.sampling.seed = seed;
    options.sampling.irregularity = 0;
    const Plan plan = make_plan(sea.stills, kNames, sea.regions, options);
    EXPECT_EQ(plan.regions.size(), 2u);
    if (plan.regions.size() != 2) return 0;
    EXPECT_EQ(plan.regions[0].reference, "");
    EXPECT_EQ(plan.regions[1].reference, plan.regions[0].region.name);
    const std::vector<int>&first = plan.regions[0].sequence, &other = plan.regions[1].sequence;
    for (std::size_t k = 0; k + 1 < std::min(first.size(), other.size()); ++k) {
      ++steps;
      same += (first[k + 1] > first[k]) == (other[k + 1] > other[k]);
    }
  }
  return same / static_cast<double>(steps);
}

TEST(Plan, PartsOfARegionFollowEachOtherAsEquation3Says) {
  const Sea sea;
  const double alone = together(sea, 0), led = together(sea, PlanOptions{}.follow);
  EXPECT_EQ(PlanOptions{}.follow, 0.05) << "as printed";
  EXPECT_LT(alone, 0.55);
  EXPECT_GT(led, 0.65);
}

}  // namespace
}  // namespace freshet::synth::stills
