#include "studio/ways/way_plan.h"

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

TEST(WayPlan, WantsASource) {
  Document document = designed();
  document.design.sources.erase(document.design.sources.begin());
  EXPECT_THROW(plan_way("design", document, kPicture), Error);
  EXPECT_THROW(plan_way("elsewhere", designed(), kPicture), Error);
}

}  // namespace
}  // namespace freshet::studio
