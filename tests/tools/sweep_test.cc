// freshet synth sweep, and --cache of the commands that label.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Outcome sweep(const WorkFolder& folder, std::vector<std::string> more) {
  std::vector<std::string> arguments{"synth",   "sweep",        sample().store, sample().still,
                                     "--matte", sample().matte, "--frames",     "8",
                                     "-o",      "out"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return folder.freshet(arguments);
}

TEST(Sweep, MakesAllCombinationsAndAPageThatNamesOnlyItsOwnFiles) {
  const WorkFolder folder;
  const Outcome outcome =
      sweep(folder, {"--sweep", "sigma=0.125,40", "--sweep", "blend=variance,paper", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  ASSERT_EQ(report["combinations"].size(), 4U);
  EXPECT_EQ(report["labellings"], 2);
  EXPECT_EQ(report["combinations"][1]["settings"], (json{{"sigma", "0.125"}, {"blend", "paper"}}));
  EXPECT_EQ(report["combinations"][0]["energy"], report["combinations"][1]["energy"]);
  EXPECT_EQ(report["combinations"][0]["changed"], 0);
  for (const json& one : report["combinations"])
    EXPECT_EQ(one["gap_reached"], one["gap"].get<double>() <= 0.01);
  const std::string page = text_of(folder / "out/index.html");
  for (const json& one : report["combinations"]) {
    EXPECT_GT(fs::file_size(folder / "out" / one["video"].get<std::string>()), 500U);
    EXPECT_NE(page.find("src=\"" + one["video"].get<std::string>() + "\""), std::string::npos);
  }
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_EQ(page.find('{' + std::string("title")), std::string::npos);
  EXPECT_GE(cv::imread(folder / "out/sheet.png").cols, 2 * kWidth);
  EXPECT_TRUE(json::parse(text_of(folder / "out/sweep.json")).contains("seconds"));
}

TEST(Sweep, ACombinationIsTheSingleRunWithItsOptions) {
  const WorkFolder folder;
  const Outcome outcome =
      sweep(folder, {"--sweep", "sigma=0.125,40", "--sweep", "costs=log,power", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json combinations = json::parse(outcome.out)["combinations"];
  for (const json& one : combinations) {
    const Outcome alone =
        folder.freshet({"query", "label", sample().store, sample().still, "--matte", sample().matte,
                        "--frames", "8", "--sigma", one["settings"]["sigma"], "--costs",
                        one["settings"]["costs"], "-o", "alone.json", "--overwrite"});
    ASSERT_EQ(alone.exit_code, 0) << alone.err;
    EXPECT_EQ(text_of(folder / "alone.json"), text_of(folder / "out" / one["assignment"].get<std::string>()));
  }
}

TEST(Sweep, StrokesSteerItsFramesAsTheySteerTheSingleRuns) {
  const WorkFolder folder;
  // Across the fall: what is not turned to the strokes is carried down.
  folder.file("lines.svg", "<svg viewBox='0 0 192 144'><path d='M60 40L140 100'/></svg>");
  const Outcome outcome =
      sweep(folder, {"--sweep", "blend=variance,paper", "--strokes", "lines.svg", "--tolerance", "90"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Outcome alone = folder.freshet({"synth", "animate", sample().store, sample().still, "--matte",
                                        sample().matte, "--frames", "8", "--strokes", "lines.svg",
                                        "--tolerance", "90", "--blend", "paper", "-o", "alone.mp4"});
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  EXPECT_TRUE(text_of(folder / "out/02.mp4") == text_of(folder / "alone.mp4"));
}

TEST(Sweep, SaysWhatIsWrongWithItsText) {
  const WorkFolder folder;
  for (const auto& [text, message] :
       std::initializer_list<std::pair<const char*, const char*>>{{"sigma", "no \"=\""},
                                                                  {"=1", "cannot be swept"},
                                                                  {"direction=up", "it has lambda, sigma"},
                                                                  {"sigma=", "a value is missing"},
                                                                  {"sigma=1,,2", "a value is missing"},
                                                                  {"sigma=1,", "a value is missing"},
                                                                  {"sigma=one", "no number from 0"},
                                                                  {"sigma=-1", "no number from 0"},
                                                                  {"sigma=nan", "no number from 0"},
                                                                  {"sigma=1e99", "no number from 0"},
                                                                  {"sigma=1,1.0", "given twice"},
                                                                  {"max-gain=0.5", "no number from 1 to 20"},
                                                                  {"solver=best", "It takes trw-s"}}) {
    const Outcome outcome = sweep(folder, {"--sweep", text});
    EXPECT_EQ(outcome.exit_code, 2) << text;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << text << ": " << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
  EXPECT_NE(sweep(folder, {"--sweep", "rho=1", "--sweep", "rho=2"}).err.find("given twice"),
            std::string::npos);
  EXPECT_NE(sweep(folder, {"--sweep", "rho=1,2,3,4,5,6,7,8,9", "--sweep", "sigma=1,2,3,4,5,6,7,8"})
                .err.find("64 at most"),
            std::string::npos);
  EXPECT_NE(sweep(folder, {}).err.find("--sweep is required"), std::string::npos);
}

TEST(Cache, TheSameAgainIsReusedAndADamagedPackIsNot) {
  const WorkFolder folder;
  const auto label = [&](const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> arguments{
        "query", "label", sample().store, sample().still, "--matte", sample().matte, "--frames", "8",
        "-o",    out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder.freshet(arguments);
  };
  ASSERT_EQ(label("none.json", {}).exit_code, 0);
  const std::string expected = text_of(folder / "none.json");
  EXPECT_NE(label("cold.json", {"--cache", "c"}).err.find(" 0 of "), std::string::npos);
  EXPECT_EQ(text_of(folder / "cold.json"), expected);
  EXPECT_NE(label("warm.json", {"--cache", "c"}).err.find("the whole labelling reused"), std::string::npos);
  EXPECT_EQ(text_of(folder / "warm.json"), expected);
  for (const auto& entry : fs::directory_iterator(folder / "c"))
    fs::resize_file(entry.path(), fs::file_size(entry.path()) / 2);
  const Outcome damaged = label("damaged.json", {"--cache", "c"});
  EXPECT_EQ(damaged.exit_code, 0);
  EXPECT_NE(damaged.err.find("damaged, or of another version"), std::string::npos);
  EXPECT_EQ(text_of(folder / "damaged.json"), expected);
  folder.file("plain", "");
  EXPECT_EQ(label("x.json", {"--cache", "plain"}).exit_code, 1);
}

TEST(Cache, AnotherBlendOnlyRenders) {
  const WorkFolder folder;
  const auto animate = [&](const char* blend) {
    return folder
        .freshet({"synth", "animate", sample().store, sample().still, "--matte", sample().matte, "--frames",
                  "8", "--cache", "c", "--blend", blend, "-o", "a.mkv", "--overwrite"})
        .err;
  };
  EXPECT_EQ(animate("variance").find("whole labelling"), std::string::npos);
  EXPECT_NE(animate("paper").find("the whole labelling reused"), std::string::npos);
}

}  // namespace
}  // namespace freshet::tools
