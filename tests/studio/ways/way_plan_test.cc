#include "studio/ways/way_plan.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "tests/tools/sample.h"

namespace freshet::studio {
namespace {

Document designed() {
  Document document;
  document.design.sources = {
      {.points = {{40, 130}, {60, 132}, {90, 130}}, .width = 10, .adds = true, .is_area = false},
      {.points = {{60, 100}}, .width = 12, .adds = false, .is_area = false},
      {.points = {{0, 0}, {20, 0}, {0, 20}}, .width = 0, .adds = false, .is_area = true}};
  document.design.winds = {{.points = {{10, 10}, {60, 20}}, .speed = {}}};
  document.design.frames = 3;
  return document;
}

const cv::Mat kPicture(151, 193, CV_8UC3, cv::Scalar(40, 60, 80));

TEST(WayPlan, EveryFluidIsASceneThatTheCommandLineTakes) {
  for (const char* fluid : {"smoke", "fire", "water"}) {
    const tools::WorkFolder folder;
    Document document = designed();
    document.design.fluid = fluid;
    const WayPlan plan = plan_way("design", document, kPicture);
    ASSERT_EQ(plan.commands.size(), 1u);
    std::filesystem::create_directories(folder / "ways/design");
    for (const WayFile& file : plan.files) folder.file("ways/design/" + file.name, file.bytes);
    const tools::Outcome outcome = folder.freshet(plan.commands[0]);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(folder / plan.film)) << fluid;
  }
}

TEST(WayPlan, ALookIsASecondCommandOverThePicture) {
  Document document = designed();
  document.design.look = "fire/1.mp4";
  document.store = "/a/fire.freshet";
  const WayPlan plan = plan_way("design", document, kPicture);
  ASSERT_EQ(plan.commands.size(), 2u);
  EXPECT_EQ(plan.commands[1][1], "transfer");
  EXPECT_EQ(plan.files.back().name, "behind.png");
  document.store.clear();
  EXPECT_THROW(plan_way("design", document, kPicture), Error);
}

TEST(WayPlan, WhatIsSaidOfStillsIsHeededByTheCommandLine) {
  const tools::WorkFolder folder;
  std::filesystem::create_directories(folder / "ways/stills/pictures");
  for (const std::string seed : {"1", "2", "3", "4", "5", "6", "7", "8"}) {
    const tools::Outcome made =
        folder.freshet({"synth", "simulate", "fire", "--size", "160x120", "--frames", "1", "--seed", seed,
                        "-o", "ways/stills/pictures/" + seed + ".png"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  Document document;
  document.stills.seconds = 1;
  const auto run = [&] {
    const WayPlan plan = plan_way("stills", document, kPicture);
    for (const WayFile& file : plan.files) folder.file("ways/stills/" + file.name, file.bytes);
    const tools::Outcome outcome = folder.freshet(plan.commands.at(0));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(folder / plan.film));
    for (const std::string& shown : plan.shown)
      EXPECT_TRUE(std::filesystem::exists(folder / ("ways/stills/" + shown))) << shown;
    return nlohmann::json::parse(outcome.out).at("regions").at(0);
  };
  const nlohmann::json before = run();
  const auto first = before.at("paths").at(0).get<std::vector<std::string>>();
  document.stills.paths = {{.region = before.at("name"), .names = first, .refused = true}};
  const nlohmann::json after = run();
  for (const nlohmann::json& path : after.at("paths")) EXPECT_NE(path.get<std::vector<std::string>>(), first);
}

/// Runs a plan's only command in a project's folder.
nlohmann::json run_in(const tools::WorkFolder& folder, const WayPlan& plan) {
  std::filesystem::create_directories(folder / ("ways/" + plan.folder));
  for (const WayFile& file : plan.files) folder.file("ways/" + plan.folder + "/" + file.name, file.bytes);
  const tools::Outcome outcome = folder.freshet(plan.commands.at(0));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const std::string& shown : plan.shown)
    EXPECT_TRUE(std::filesystem::exists(folder / ("ways/" + plan.folder + "/" + shown))) << shown;
  return outcome.exit_code == 0 ? nlohmann::json::parse(outcome.out) : nlohmann::json();
}

TEST(WayPlan, AClipGoesOnAlongLinesThatWereMoved) {
  const tools::WorkFolder folder;
  Document document;
  document.store = tools::sample().store;
  document.endless.clip = "fall/1.mkv";
  document.endless.frames = 20;
  EXPECT_GT(run_in(folder, plan_way("lines", document, kPicture))["lines"], 0);
  document.endless.lines = {{.id = "a", .points = {{80, 10}, {80, 130}}, .speeds = {}},
                            {.id = "b", .points = {{100, 10}, {100, 130}}, .speeds = {}}};
  document.endless.edited = {{.id = "a", .points = {{70, 10}, {60, 130}}, .speeds = {2}},
                             {.id = "b-2", .points = {{110, 10}, {120, 130}}, .speeds = {0.5f, 1}}};
  const WayPlan plan = plan_way("flowlines", document, kPicture);
  const nlohmann::json report = run_in(folder, plan);
  EXPECT_EQ(report["lines"], 2);
  EXPECT_TRUE(std::filesystem::exists(folder / plan.film));
  EXPECT_NE(tools::text_of(folder / "ways/flowlines/edited.svg").find("data-speed=\"0.5 1\""),
            std::string::npos);
}

TEST(WayPlan, AClipIsTheStoresOrTheProjects) {
  Document document;
  EXPECT_THROW(plan_way("flowlines", document, kPicture), Error);
  document.endless.clip = "--draw";
  EXPECT_THROW(plan_way("lines", document, kPicture), Error) << "of no store";
  document.store = "/a/b.freshet";
  const std::vector<std::string> stored = plan_way("lines", document, kPicture).commands[0];
  EXPECT_EQ(stored[3], "--clip=--draw");
  document.endless.dropped = true;
  document.endless.clip = "fall.mp4";
  EXPECT_EQ(plan_way("lines", document, kPicture).commands[0][2], "ways/flowlines/clips/fall.mp4");
  document.endless.moving_camera = true;
  document.endless.loop = true;
  const std::vector<std::string> words = plan_way("flowlines", document, kPicture).commands[0];
  for (const char* word : {"--moving-camera", "--loop"})
    EXPECT_NE(std::find(words.begin(), words.end(), word), words.end()) << word;
}

TEST(WayPlan, WantsASource) {
  Document document = designed();
  document.design.sources.erase(document.design.sources.begin());
  EXPECT_THROW(plan_way("design", document, kPicture), Error);
  EXPECT_THROW(plan_way("elsewhere", designed(), kPicture), Error);
}

}  // namespace
}  // namespace freshet::studio
