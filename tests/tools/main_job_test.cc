// From simulated clips to an animation: the job that the README describes.

#include <gtest/gtest.h>

#include <algorithm>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kAnimated = 16;

/// query label of the sample's still; assignment.json in the folder.
Outcome label(const WorkFolder& folder, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{"query",   "label",        sample().store, sample().still,
                                     "--matte", sample().matte, "--frames",     std::to_string(kAnimated)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return folder.freshet(arguments);
}

std::vector<cv::Mat> animate(const WorkFolder& folder, const std::string& name, const std::string& threads) {
  fs::create_directories(folder / name);
  const Outcome outcome = folder.freshet(
      {"synth", "animate", sample().store, sample().still, "--matte", sample().matte, "--assignment",
       "assignment.json", "--frames", std::to_string(kAnimated), "-j", threads, "-o", name + "/%05d.png"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, name + "/%05d.png\n");
  return read_frames(folder / name);
}

TEST(MainJob, StoreInfoListsTheClipsThatWereIngested) {
  const Outcome outcome = WorkFolder().freshet({"store", "info", sample().store, "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const json info = json::parse(outcome.out);
  ASSERT_EQ(info["clips"].size(), 3U);
  EXPECT_EQ(info["clips"][0]["name"], "fall/1.mkv");
  EXPECT_EQ(info["clips"][0]["class"], "fall");
  EXPECT_EQ(info["clips"][0]["frames"], kFrames);
  EXPECT_EQ(info["clips"][0]["width"], kWidth);
  EXPECT_EQ(info["clips"][0]["height"], kHeight);
  EXPECT_EQ(info["clips"][0]["fps"], 25.0);
  EXPECT_EQ(info["clips"][2]["name"], "river/1.mkv");
  EXPECT_EQ(info["clips"][2]["frames"], kRiverFrames);
  for (const json& clip : info["clips"]) EXPECT_GT(clip["patches"], 10);
}

TEST(MainJob, TheBestCandidateComesFirstAndASheetShowsThem) {
  const WorkFolder folder;
  const Outcome outcome =
      folder.freshet({"query", "candidates", sample().store, sample().still, "--matte", sample().matte,
                      "--frames", "16", "-k", "5", "--coherent", "0", "--sheet", "sheet.png", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json found = json::parse(outcome.out);
  ASSERT_GT(found["pieces"].size(), 4U);
  for (const json& piece : found["pieces"]) {
    ASSERT_EQ(piece["candidates"].size(), 5U);
    for (std::size_t i = 1; i < 5; ++i)
      EXPECT_GE(piece["candidates"][i - 1]["score"], piece["candidates"][i]["score"]);
  }
  EXPECT_GE(cv::imread(folder / "sheet.png").cols, kWidth);
}

TEST(MainJob, AnEnergyIsNotBelowItsBoundAndTheAssignmentIsWrittenAsPrinted) {
  const WorkFolder folder;
  const Outcome outcome = label(folder, {"-o", "assignment.json", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json printed = json::parse(outcome.out);
  EXPECT_GE(printed["energy"].get<double>(), printed["lower_bound"].get<double>() - 1e-6);
  EXPECT_GT(printed["energy"].get<double>(), 0);
  const json written = json::parse(text_of(folder / "assignment.json"));
  EXPECT_EQ(written, printed["assignment"]);
  EXPECT_EQ(written["pieces"].size(), printed["pieces"].get<std::size_t>());
}

TEST(MainJob, LabellingSaysWhetherItsGapIsAsSmallAsItShouldBe) {
  const std::vector<std::string> kCut{"--lambda", "1", "--vote", "0", "--iterations", "1"};
  const WorkFolder folder;
  const auto printed = [&](std::vector<std::string> more) {
    more.push_back("--json");
    const Outcome outcome = label(folder, more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(outcome.out);
  };
  const json whole = printed({}), cut = printed(kCut), icm = printed({"--solver", "icm"});
  EXPECT_LE(whole["gap"].get<double>(), 0.01);
  EXPECT_EQ(whole["gap_aimed"], 0.01);
  EXPECT_EQ(whole["gap_reached"], true);
  EXPECT_GT(cut["gap"].get<double>(), 0.01);
  EXPECT_EQ(cut["gap_reached"], false);
  EXPECT_FALSE(icm.contains("gap"));
  EXPECT_EQ(icm["gap_reached"], false);
  const auto says = [](const std::string& text, const std::string& words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  const std::string text = label(folder).out;
  for (const char* words : {", energy ", ", bound ", ", gap ", "%, at most 1% as it should be"})
    says(text, words);
  says(label(folder, kCut).out, "%, more than the 1% aimed at");
  says(label(folder, {"--solver", "icm"}).out, "no bound, so that a gap of at most 1% is not known");
  const Outcome animated = folder.freshet({"synth", "animate", sample().store, sample().still, "--matte",
                                           sample().matte, "--frames", "8", "-o", "out.mkv"});
  ASSERT_EQ(animated.exit_code, 0) << animated.err;
  for (const char* words : {", energy ", ", bound ", ", gap ", "%, at most 1% as it should be"})
    says(animated.err, words);
}

TEST(MainJob, AnimatingPrintsWhatItDidAsJson) {
  const WorkFolder folder;
  const std::vector<std::string> command{
      "synth", "animate", sample().store, sample().still, "--matte",   sample().matte, "--frames",
      "8",     "-o",      "out.mkv",      "--sheet",      "sheet.png", "--json"};
  const Outcome labelled = folder.freshet(command);
  ASSERT_EQ(labelled.exit_code, 0) << labelled.err;
  const json printed = json::parse(labelled.out);
  EXPECT_EQ(printed["files"], json({"out.mkv", "sheet.png"}));
  EXPECT_EQ(printed["frames"], 8);
  EXPECT_EQ(printed["width"], cv::imread(sample().still).cols);
  EXPECT_EQ(printed["labelling"]["pieces"], printed["pieces"]);
  EXPECT_LE(printed["labelling"]["gap"].get<double>(), 0.01);
  EXPECT_GE(printed["seconds"]["total"], printed["seconds"]["render"]);
  // What an assignment from a file was labelled with is in that file.
  ASSERT_EQ(label(folder, {"-o", "assignment.json"}).exit_code, 0);
  std::vector<std::string> again = command;
  again.insert(again.end(), {"--assignment", "assignment.json", "--overwrite"});
  const Outcome given = folder.freshet(again);
  ASSERT_EQ(given.exit_code, 0) << given.err;
  EXPECT_TRUE(json::parse(given.out)["labelling"].is_null());
}

TEST(MainJob, OneThreadAndTwoChooseTheSame) {
  const WorkFolder folder;
  ASSERT_EQ(label(folder, {"-o", "one.json", "-j", "1"}).exit_code, 0);
  ASSERT_EQ(label(folder, {"-o", "two.json", "-j", "2"}).exit_code, 0);
  EXPECT_EQ(text_of(folder / "one.json"), text_of(folder / "two.json"));
}

TEST(MainJob, OutsideTheMatteEveryPixelIsThePicturesAndInsideItMoves) {
  const WorkFolder folder;
  ASSERT_EQ(label(folder, {"-o", "assignment.json"}).exit_code, 0);
  const std::vector<cv::Mat> frames = animate(folder, "one", "1"), again = animate(folder, "two", "2");
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kAnimated));
  ASSERT_EQ(again.size(), frames.size());
  const cv::Mat still = cv::imread(sample().still, cv::IMREAD_COLOR);
  const cv::Mat matte = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE);
  const cv::Mat outside = matte == 0, inside = matte == 255;
  ASSERT_GT(cv::countNonZero(outside), 100);
  ASSERT_GT(cv::countNonZero(inside), 100);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_EQ(frames[i].size(), cv::Size(kWidth, kHeight));
    EXPECT_EQ(cv::norm(frames[i], still, cv::NORM_INF, outside), 0) << "frame " << i;
    EXPECT_EQ(cv::norm(frames[i], again[i], cv::NORM_INF), 0) << "one thread and two differ in frame " << i;
    if (i > 0) {
      EXPECT_GT(cv::norm(frames[i], frames[i - 1], cv::NORM_L1, inside), 0) << "frame " << i;
    }
  }
}

TEST(MainJob, AClassAndADirectionNarrowWhatIsSearched) {
  const auto patches = [](std::vector<std::string> more) {
    std::vector<std::string> arguments{"query",    "candidates", sample().store, sample().still,
                                       "--frames", "16",         "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = WorkFolder().freshet(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(outcome.out);
  };
  const json all = patches({}), fall = patches({"--class", "fall"}),
             down = patches({"--direction", "down", "--hint-search", "narrow"}),
             wide = patches({"--direction", "down"});
  const auto last = [](const json& found) { return found["filters"]["steps"].back(); };
  EXPECT_EQ(last(all)["clips"], 3);
  EXPECT_EQ(last(fall)["clips"], 2);
  EXPECT_LT(last(fall)["patches"], last(all)["patches"]);
  EXPECT_LT(last(down)["patches"], last(all)["patches"]);
  EXPECT_EQ(last(wide)["patches"], last(all)["patches"]) << "a direction is a price";
  for (const json& piece : fall["pieces"])
    for (const json& candidate : piece["candidates"])
      EXPECT_EQ(candidate["clip"].get<std::string>().substr(0, 5), "fall/");
  for (const json& piece : down["pieces"])
    for (const json& candidate : piece["candidates"])
      EXPECT_EQ(candidate["clip"].get<std::string>().substr(0, 5), "fall/") << "rivers do not fall";
}

TEST(MainJob, SharesAreToldAndOneClipEverywhereIsWarnedOf) {
  const WorkFolder folder;
  const Outcome text = label(folder, {"--class", "river", "-o", "assignment.json"});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_NE(text.out.find("largest share of a clip 100%"), std::string::npos) << text.out;
  EXPECT_NE(text.err.find("100% of the pieces come from one clip, river/"), std::string::npos) << text.err;
  EXPECT_NE(text.err.find("--exclude river/"), std::string::npos) << text.err;
  const json told = json::parse(label(folder, {"--class", "river", "--json"}).out);
  EXPECT_EQ(told["shares"]["largest_clip"], 1);
  EXPECT_GT(told["shares"]["largest_patch"], 0);
  EXPECT_TRUE(told["shares"]["warning"].is_string());
  const Outcome rendered =
      folder.freshet({"synth", "animate", sample().store, sample().still, "--whole", "--assignment",
                      "assignment.json", "--frames", "8", "-o", "out.mkv", "--json"});
  ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
  EXPECT_EQ(json::parse(rendered.out)["shares"]["largest_clip"], 1);
  EXPECT_NE(rendered.err.find("--exclude river/"), std::string::npos) << rendered.err;
}

TEST(MainJob, AConditionThatAnAssignmentOverridesIsSaidToHaveNoEffect) {
  const WorkFolder folder;
  ASSERT_EQ(label(folder, {"-o", "assignment.json"}).exit_code, 0);
  const Outcome outcome = folder.freshet({"synth", "animate", sample().store, sample().still, "--matte",
                                          sample().matte, "--assignment", "assignment.json", "--direction",
                                          "up", "--frames", "8", "-o", "out.mkv"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("--direction has no effect: assignment.json says"), std::string::npos)
      << outcome.err;
}

TEST(MainJob, WithoutAMatteOneIsAskedForAndWholeMeansAllOfThePicture) {
  const WorkFolder folder;
  const Outcome asked =
      folder.freshet({"synth", "animate", sample().store, sample().still, "--frames", "16", "-o", "all.mkv"});
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_NE(asked.err.find("nothing says where its fluid is. Give --matte (freshet synth matte makes one"),
            std::string::npos)
      << asked.err;
  EXPECT_FALSE(fs::exists(folder / "all.mkv"));
  const Outcome outcome = folder.freshet({"synth", "animate", sample().store, sample().still, "--whole",
                                          "--frames", "16", "-o", "all.mkv", "--sheet", "sheet.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "all.mkv\nsheet.png\n");
  EXPECT_FALSE(cv::imread(folder / "sheet.png").empty());
  EXPECT_TRUE(fs::exists(folder / "all.mkv"));
}

}  // namespace
}  // namespace freshet::tools
