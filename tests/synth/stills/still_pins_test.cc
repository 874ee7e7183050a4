// Pins in an edits file: read, laid onto the stills, refused by name, and shown.
#include "synth/stills/still_pins.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <oneapi/tbb/global_control.h>
#include <opencv2/imgcodecs.hpp>

#include "cache/result_cache.h"
#include "freshet/error.h"
#include "synth/stills/film.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"
#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

const char* const kPin = "[[pin]]\nfrom = \"a.png\"\nto = \"b.png\"\nat = [60, 48]\ngoes = [200, 50]\n";

/// Three stills of a small ball that leaps over a ground that stands.
class Pins : public testing::Test {
 protected:
  Pins() {
    std::filesystem::create_directory(folder_ / "stills");
    const cv::Point at[3] = {{60, 48}, {200, 50}, {60, 140}};
    for (int i = 0; i < 3; ++i) {
      cv::Mat still = made_ground({320, 192});
      cv::circle(still, at[i], 8, {40, 90, 240}, cv::FILLED, cv::LINE_AA);
      cv::imwrite(folder_ / "stills" / (std::string(1, static_cast<char>('a' + i)) + ".png"), still);
    }
  }
  StillsEdits edits(const std::string& text) const {
    std::ofstream(folder_ / "edits.toml") << text;
    return read_edits(folder_ / "edits.toml");
  }
  FilmOptions options(const std::string& text, bool preview = false) const {
    edits(text);
    FilmOptions options{.seconds = 2,
                        .fps = 10,
                        .preview = preview,
                        .camera = "tripod",
                        .one_region = true,
                        .edits = folder_ / "edits.toml"};
    settle(options);
    return options;
  }
  Film film(const FilmOptions& options) const {
    return plan_film(read_stills(folder_ / "stills", largest_side(options)), options, {});
  }
  Film film(const std::string& text) const { return film(options(text)); }
  std::string fault(const std::string& text) const {
    return fault_of([&] { film(text); });
  }
  static std::vector<cv::Mat> frames(const Film& film, cache::ResultCache* cache = nullptr) {
    RenderOptions render = film.render;
    render.cache = cache;
    std::vector<cv::Mat> out;
    render_frames(film.plan, film.stills.pictures, render,
                  [&](const cv::Mat& frame) { out.push_back(frame.clone()); });
    return out;
  }
  static bool same(const std::vector<cv::Mat>& a, const std::vector<cv::Mat>& b) {
    for (std::size_t i = 0; i < a.size(); ++i)
      if (cv::norm(a[i], b[i], cv::NORM_INF) != 0) return false;
    return a.size() == b.size();
  }
  const ScratchFolder folder_;
};

TEST_F(Pins, AreReadAndLaidOntoTheStillsEitherWayRound) {
  const Film one = film(kPin),
             other = film(
                 "[[pin]]\nfrom = \"b.png\"\nto = \"a.png\"\nat = [200, 50]\ngoes = [60, 48]\nreach = 40\n");
  for (const Film* each : {&one, &other}) {
    ASSERT_EQ(each->render.pins.size(), 1u);
    const PlacedPin& pin = each->render.pins[0];
    EXPECT_EQ(pin.from, 0);
    EXPECT_EQ(pin.to, 1);
    EXPECT_EQ(pin.at, cv::Point2d(60, 48));
    EXPECT_EQ(pin.goes, cv::Point2d(200, 50));
  }
  EXPECT_DOUBLE_EQ(one.render.pins[0].reach, .08 * 320);
  EXPECT_DOUBLE_EQ(other.render.pins[0].reach, 40);
}

TEST_F(Pins, LieOnTheSameThingWhereStillsAreReduced) {
  // 640 px, of which a preview keeps 480.
  for (const char* name : {"a.png", "b.png", "c.png"}) {
    cv::Mat still = cv::imread(folder_ / "stills" / name);
    cv::resize(still, still, {}, 2, 2, cv::INTER_CUBIC);
    cv::imwrite(folder_ / "stills" / name, still);
  }
  const PlacedPin pin =
      film(options("[[pin]]\nfrom = \"a.png\"\nto = \"b.png\"\nat = [120.5, 96.5]\ngoes = [400.5, "
                   "100.5]\nreach = 64\n",
                   true))
          .render.pins.at(0);
  EXPECT_NEAR(pin.at.x, 121 * .75 - .5, 1e-9);
  EXPECT_NEAR(pin.goes.y, 101 * .75 - .5, 1e-9);
  EXPECT_NEAR(pin.reach, 48, 1e-9);
}

TEST_F(Pins, LieOnTheSameThingWhereStillsAreAligned) {
  StillSet set = read_stills(folder_ / "stills");
  // As aligning leaves it: 7 px to the left and 4 up were cut off.
  for (cv::Matx33d& map : set.from_file) map = cv::Matx33d(1, 0, -7, 0, 1, -4, 0, 0, 1) * map;
  for (cv::Mat& picture : set.pictures) picture = picture(cv::Rect(7, 4, 300, 180)).clone();
  const PlacedPin pin = placed_pins(edits(kPin).pins, set).at(0);
  EXPECT_EQ(pin.at, cv::Point2d(53, 44));
  const std::string cut = fault_of([&] {
    placed_pins(edits("[[pin]]\nfrom = \"a.png\"\nto = \"b.png\"\nat = [3, 48]\ngoes = [200, 50]\n").pins,
                set);
  });
  EXPECT_NE(cut.find("pin 1 (a.png to b.png): at: [3, 48] of a.png was cut off"), std::string::npos) << cut;
}

TEST_F(Pins, MistakesAreNamedWithTheirRemedy) {
  const auto pin = [](const std::string& from, const std::string& to, const std::string& at,
                      const std::string& goes) {
    return "[[pin]]\nfrom = \"" + from + "\"\nto = \"" + to + "\"\nat = " + at + "\ngoes = " + goes + "\n";
  };
  const auto says = [&](const std::string& text, std::initializer_list<const char*> words) {
    const std::string said = fault(text);
    for (const char* word : words)
      EXPECT_NE(said.find(word), std::string::npos) << word << " is not in: " << said;
  };
  says(pin("a.png", "x.png", "[60, 48]", "[200, 50]"),
       {"pin 1", "no still \"x.png\"", "a.png, b.png, c.png"});
  says(pin("a.png", "a.png", "[60, 48]", "[200, 50]"), {"pin 1", "itself", "Name two stills"});
  says(pin("a.png", "b.png", "[60, 248]", "[200, 50]"), {"at", "[60, 248] lies outside a.png", "320 x 192"});
  says(pin("a.png", "b.png", "[60, 48]", "[320, 50]"), {"goes", "lies outside b.png"});
  says(pin("a.png", "b.png", "[60, 48]", "[-1, 50]"), {"edits.toml:5", "goes", "out of range"});
  says(pin("a.png", "b.png", "[60]", "[200, 50]"), {"edits.toml:4", "at"});
  says("[[pin]]\nfrom = \"a.png\"\nto = \"b.png\"\nat = [1, 2]\n", {"edits.toml:1", "it needs goes"});
  says(std::string(kPin) + kPin, {"pin 2 (a.png to b.png)", "same point as pin 1", "Take one"});
  says(kPin + pin("b.png", "a.png", "[200, 50]", "[60, 48]"),
       {"pin 2 (b.png to a.png)", "same point as pin 1"});
  says(kPin + pin("a.png", "b.png", "[60, 48]", "[20, 50]"), {"pin 2", "contradicts pin 1", "one thing"});
  says(kPin + pin("a.png", "b.png", "[90, 90]", "[200, 50]"), {"pin 2", "contradicts pin 1"});
  EXPECT_NO_THROW(film(kPin + pin("a.png", "c.png", "[60, 48]", "[60, 140]"))) << "another pair of stills";
  EXPECT_NO_THROW(film(kPin + pin("a.png", "b.png", "[62, 50]", "[202, 52]"))) << "near, and they agree";
}

TEST_F(Pins, WhatNoRegionHoldsIsRefusedAndWhatIsNeverShownIsTold) {
  FilmOptions outside = options(kPin);
  cv::Mat regions(192, 320, CV_8UC3, cv::Scalar::all(0));
  regions(cv::Rect(20, 10, 70, 160)).setTo(cv::Scalar::all(255));
  cv::imwrite(folder_ / "regions.png", regions);
  outside.one_region = false;
  outside.regions = folder_ / "regions.png";
  const std::string said = fault_of([&] { film(outside); });
  EXPECT_NE(said.find("pin 1 (a.png to b.png)"), std::string::npos) << said;
  EXPECT_NE(said.find("no region that flows holds both its ends"), std::string::npos) << said;

  const std::string unseen =
      "sequence = [\"a.png\", \"c.png\", \"a.png\", \"c.png\", \"a.png\", \"c.png\"]\n";
  const Film without = film(unseen), with = film(unseen + kPin);
  ASSERT_FALSE(with.notices.empty());
  EXPECT_NE(with.notices.back().find("never shown one after the other"), std::string::npos)
      << with.notices.back();
  EXPECT_TRUE(same(frames(without), frames(with)));
}

TEST_F(Pins, ChangeTheFramesBetweenTheirStillsForAnyNumberOfThreads) {
  const std::string order = "sequence = [\"a.png\", \"b.png\", \"c.png\"]\nstep = 1\n";
  const Film without = film(order), with = film(order + kPin);
  const std::vector<cv::Mat> before = frames(without), after = frames(with);
  const double change = with.plan.regions[0].timeline.times()[1];
  for (std::size_t i = 1; i < after.size(); ++i)
    EXPECT_EQ(cv::norm(before[i], after[i], cv::NORM_INF) == 0, static_cast<double>(i) / 10 >= change)
        << "frame " << i;
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(same(frames(with), after));
}

TEST_F(Pins, AreHeededByWhatIsKept) {
  const std::string order = "sequence = [\"a.png\", \"b.png\", \"c.png\"]\nstep = 1\n";
  const Film without = film(order), with = film(order + kPin);
  const auto kept = [&](const Film& film) {
    cache::ResultCache cache(folder_ / "kept");
    return frames(film, &cache);
  };
  EXPECT_TRUE(same(kept(without), frames(without)));
  EXPECT_TRUE(same(kept(with), frames(with)));
  EXPECT_TRUE(same(kept(with), frames(with)));
  EXPECT_TRUE(same(kept(without), frames(without)));
}

}  // namespace
}  // namespace freshet::synth::stills
