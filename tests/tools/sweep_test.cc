// freshet synth sweep, and --cache of the commands that label.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

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

/// The animations that a sweep reports; none where it failed.
std::vector<json> animations(const WorkFolder& folder, std::vector<std::string> more) {
  more.emplace_back("--json");
  const Outcome outcome = sweep(folder, std::move(more));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.exit_code == 0 ? json::parse(outcome.out)["animations"].get<std::vector<json>>()
                                : std::vector<json>();
}

/// What animate makes by itself, in a file of this ending.
std::string alone(const WorkFolder& folder, const std::string& ending, std::vector<std::string> more) {
  std::vector<std::string> arguments{"synth",       "animate",      sample().store,  sample().still,
                                     "--matte",     sample().matte, "--frames",      "8",
                                     "--overwrite", "-o",           "alone" + ending};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = folder.freshet(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return text_of(folder / ("alone" + ending));
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Sweep, MakesAllCombinationsAndAPageThatNamesOnlyItsOwnFiles) {
  const WorkFolder folder;
  const std::vector<json> made =
      animations(folder, {"--vary", "speed=0.5,1", "--vary", "method=carried,paper"});
  ASSERT_EQ(made.size(), 4U);
  EXPECT_EQ(made[1]["settings"], (json{{"speed", "0.5"}, {"method", "paper"}}));
  EXPECT_EQ(made[0]["changed"], 0);
  EXPECT_EQ(made[0]["energy"], made[2]["energy"]);
  const std::string page = text_of(folder / "out/index.html");
  for (const json& one : made) {
    EXPECT_GT(fs::file_size(folder / "out" / one["video"].get<std::string>()), 500U);
    EXPECT_TRUE(holds(page, "src=\"" + one["video"].get<std::string>() + "\""));
    EXPECT_TRUE(holds(page, one["result"]));
    EXPECT_EQ(one["gap_reached"], one["gap"].get<double>() <= 0.01);
  }
  EXPECT_TRUE(holds(page, "speed 0.5, method paper"));
  EXPECT_TRUE(holds(page, "How fast everything plays")) << "what differs, in animate's own words";
  EXPECT_FALSE(holds(page, "http"));
  EXPECT_FALSE(holds(page, "{title"));
  EXPECT_GE(cv::imread(folder / "out/sheet.png").cols, 2 * 100);
  EXPECT_TRUE(json::parse(text_of(folder / "out/sweep.json")).contains("seconds"));
  EXPECT_FALSE(fs::exists(folder / "out/.labels")) << "what labellings shared is gone with the sweep";
}

TEST(Sweep, EachPointIsTheSingleRunWithItsOptionsWhateverTheyAre) {
  const WorkFolder folder;
  folder.file("across.svg", "<svg viewBox='0 0 192 144'><path d='M60 40L140 100'/></svg>");
  folder.file("down.svg", "<svg viewBox='0 0 192 144'><path d='M60 40L60 100' data-speed='60'/></svg>");
  const std::vector<json> made =
      animations(folder, {"--vary", "strokes=-,across.svg,down.svg", "--vary", "exclude=-,fall/1.mkv"});
  ASSERT_EQ(made.size(), 6U);
  std::size_t i = 0;
  for (const char* strokes : {"", "across.svg", "down.svg"})
    for (const char* excluded : {"", "fall/1.mkv"}) {
      std::vector<std::string> words;
      if (*strokes != '\0') words.insert(words.end(), {"--strokes", strokes});
      if (*excluded != '\0') words.insert(words.end(), {"--exclude", excluded});
      EXPECT_TRUE(text_of(folder / "out" / made[i]["file"].get<std::string>()) ==
                  alone(folder, ".mp4", words))
          << made[i]["settings"];
      ++i;
    }
}

TEST(Sweep, WeightsPresetsAndFlagsAreSweptToo) {
  const WorkFolder folder;
  const std::vector<json> made = animations(folder, {"--vary", "sigma=0.125,40", "--vary", "loop=on,off"});
  ASSERT_EQ(made.size(), 4U);
  EXPECT_TRUE(text_of(folder / "out/03.mp4") == alone(folder, ".mp4", {"--sigma", "40", "--loop"}));
  const std::vector<json> presets = animations(folder, {"--vary", "preset=-,archive", "--overwrite"});
  ASSERT_EQ(presets.size(), 2U);
  EXPECT_EQ(presets[1]["file"], "02.mkv");
  EXPECT_EQ(presets[1]["video"], "02_page.mp4") << "what browsers do not play has a stand-in on the page";
  EXPECT_TRUE(text_of(folder / "out/02.mkv") == alone(folder, ".mkv", {"--preset", "archive"}));
}

TEST(Sweep, EqualResultsAreRenderedOnce) {
  const WorkFolder folder;
  // One value in three writings; a default that is said; an option that changes no frame.
  std::vector<json> made = animations(folder, {"--vary", "speed=-,1,1.0,2"});
  ASSERT_EQ(made.size(), 4U);
  EXPECT_EQ(made[1]["same_as"], "01");
  EXPECT_EQ(made[2]["same_as"], "01");
  EXPECT_FALSE(made[3].contains("same_as"));
  EXPECT_FALSE(fs::exists(folder / "out/02.mp4"));
  made = animations(folder, {"--overwrite", "--vary", "memory=1,2000"});
  ASSERT_EQ(made.size(), 2U);
  EXPECT_EQ(made[1]["result"], "the same frames as 01");
  EXPECT_EQ(made[1]["file"], "01.mp4");
  const std::string page = text_of(folder / "out/index.html");
  EXPECT_EQ(page.find("<video"), page.rfind("<video"));
}

TEST(Sweep, LabelsAreSharedAndWhatIsSaidOfAllIsSaidOnce) {
  const WorkFolder folder;
  const Outcome outcome = sweep(folder, {"--vary", "renewal=0,0.5", "--direction", "down"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(holds(outcome.err, "the whole labelling reused")) << outcome.err;
  EXPECT_TRUE(holds(outcome.out, "the same patches as in 01")) << outcome.out;
  const std::string of_all = "freshet: all: ";  // patches in the store
  EXPECT_TRUE(holds(outcome.err, of_all));
  EXPECT_EQ(outcome.err.find(of_all), outcome.err.rfind(of_all)) << outcome.err;
}

TEST(Sweep, APictureOf16BitsIsSweptAsDeepAsAnimateMakesIt) {
  const WorkFolder folder;
  cv::Mat deep;
  cv::imread(sample().still, cv::IMREAD_COLOR).convertTo(deep, CV_16U, 257, 100);
  cv::imwrite(folder / "deep.png", deep);
  const Outcome outcome =
      folder.freshet({"synth", "sweep", sample().store, "deep.png", "--matte", sample().matte, "--frames",
                      "4", "--preset", "archive", "--vary", "speed=1,2", "-o", "out"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  ASSERT_EQ(folder
                .freshet({"synth", "animate", sample().store, "deep.png", "--matte", sample().matte,
                          "--frames", "4", "--preset", "archive", "-o", "alone.mkv"})
                .exit_code,
            0);
  EXPECT_TRUE(text_of(folder / "out/01.mkv") == text_of(folder / "alone.mkv"));
}

/// Every file below a folder, by name, but for what a sweep took of time.
std::map<std::string, std::string> files_below(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::string text = text_of(entry.path());
    if (entry.path().filename() == "sweep.json") {
      json report = json::parse(text);
      report.erase("seconds");
      text = report.dump();
    }
    files[fs::relative(entry.path(), folder).string()] = text;
  }
  return files;
}

TEST(Sweep, ShardsAndAGatheringLeaveWhatOneRunLeaves) {
  const WorkFolder folder;
  // Six points: a file that browsers do not play, equal ones in one shard and in two.
  const std::vector<std::string> axes{"--vary", "preset=-,archive", "--vary", "speed=-,1.0,2"};
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.end(), axes.begin(), axes.end());
    return sweep(folder, more);
  };
  ASSERT_EQ(run({}).exit_code, 0);
  const auto whole = files_below(folder / "out");
  fs::remove_all(folder / "out");
  for (const char* shard : {"3/3", "1/3"}) ASSERT_EQ(run({"--shard", shard}).exit_code, 0);
  const Outcome early = run({"--gather"});
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_TRUE(holds(early.err, "not yet made: 02, 05")) << early.err;
  ASSERT_EQ(run({"--shard", "2/3", "-j", "1"}).exit_code, 0);
  // Again: all is there. Another sweep's parts are not taken.
  const fs::file_time_type made = fs::last_write_time(folder / "out/parts/02/02.mp4");
  EXPECT_EQ(run({"--shard", "1/1"}).out, "");
  EXPECT_EQ(fs::last_write_time(folder / "out/parts/02/02.mp4"), made);
  const Outcome other = run({"--shard", "1/1", "--direction", "left"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_TRUE(holds(other.err, "parts/01: was made by another command")) << other.err;
  ASSERT_EQ(run({"--gather"}).exit_code, 0);
  const auto gathered = files_below(folder / "out");
  EXPECT_EQ(gathered.size(), whole.size());
  for (const auto& [name, text] : whole) {
    ASSERT_TRUE(gathered.contains(name)) << name;
    EXPECT_TRUE(gathered.at(name) == text) << name;
  }
  EXPECT_EQ(run({"--shard", "4/3"}).exit_code, 2);
}

TEST(Sweep, WhatIsGatheredIsNotMadeAgain) {
  const WorkFolder folder;
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--vary", "speed=-,1.0,2"});
    return sweep(folder, more);
  };
  const auto shard = [&] { return run({"--shard", "1/1"}); };
  ASSERT_EQ(shard().exit_code, 0);
  const Outcome first = run({"--gather"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const auto gathered = files_below(folder / "out");
  const fs::file_time_type made = fs::last_write_time(folder / "out/03.mp4");
  EXPECT_EQ(shard().out, "");
  EXPECT_FALSE(fs::exists(folder / "out/parts"));
  EXPECT_EQ(run({"--gather"}).out, first.out);
  EXPECT_EQ(json::parse(run({"--gather", "--json"}).out), json::parse(text_of(folder / "out/sweep.json")));
  EXPECT_EQ(fs::last_write_time(folder / "out/03.mp4"), made);
  // Another command's films are not taken for these, nor what is missing or empty for whole.
  EXPECT_EQ(run({"--gather", "--direction", "left"}).exit_code, 1);
  EXPECT_TRUE(files_below(folder / "out") == gathered) << "nor is anything of them lost";
  for (const bool removed : {true, false}) {
    if (removed)
      fs::remove(folder / "out/03.mp4");
    else
      folder.file("out/03.mp4", "");
    EXPECT_TRUE(holds(run({"--gather"}).err, "not yet made: 01, 02, 03"));
    EXPECT_TRUE(holds(shard().out, "parts/03"));
    ASSERT_EQ(run({"--gather"}).exit_code, 0);
    EXPECT_TRUE(files_below(folder / "out") == gathered);
  }
}

TEST(Sweep, SaysWhatIsWrongWithItsText) {
  const WorkFolder folder;
  for (const auto& [text, message] : std::initializer_list<std::pair<const char*, const char*>>{
           {"sigma", "no \"=\""},
           {"=1", "has no option --"},
           {"colour=red", "has no option --colour"},
           {"output=a,b", "has no option --output"},
           {"sheet=a,b", "has no option --sheet"},
           {"sigma=", "a value is missing"},
           {"sigma=1,,2", "a value is missing"},
           {"sigma=1,", "a value is missing"},
           {"sigma=1,one", "sigma one"},
           {"sigma=-1", "sigma"},
           {"sigma=nan", "not a number"},
           {"sigma=1,1", "given twice"},
           {"max-gain=0.5", "max-gain 0.5"},
           {"frames=8,9", "--frames is given for all, too"},
           {"solver=trw-s,best", "solver best"}}) {
    const Outcome outcome = sweep(folder, {"--vary", text});
    EXPECT_EQ(outcome.exit_code, 2) << text;
    EXPECT_TRUE(holds(outcome.err, message)) << text << ": " << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
  EXPECT_TRUE(holds(sweep(folder, {"--vary", "rho=1", "--vary", "rho=2"}).err, "varied twice"));
  EXPECT_TRUE(holds(sweep(folder, {"--vary", "rho=1,2,3,4,5,6,7,8,9", "--vary", "sigma=1,2,3,4,5,6,7,8"}).err,
                    "64 at most"));
  EXPECT_TRUE(holds(sweep(folder, {}).err, "--vary is required"));
}

TEST(Sweep, WhatIsWrongWithOnePointIsSaidBeforeTheFirstIsMade) {
  const WorkFolder folder;
  folder.file("lines.svg", "<svg viewBox='0 0 192 144'><path d='M60 40L140 100'/></svg>");
  const Outcome file = sweep(folder, {"--vary", "strokes=lines.svg,missing.svg"});
  EXPECT_NE(file.exit_code, 0);
  EXPECT_TRUE(holds(file.err, "missing.svg")) << file.err;
  EXPECT_FALSE(fs::exists(folder / "out/01.mp4"));
  const Outcome pair = sweep(folder, {"--vary", "layer=whole,light"});
  EXPECT_EQ(pair.exit_code, 2);
  EXPECT_TRUE(holds(pair.err, "--layer light")) << pair.err;
  EXPECT_FALSE(fs::exists(folder / "out/01.mp4"));
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
