// freshet synth simulate: what a design's folder holds, and what is refused.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kSmall{"--size", "96x64", "--grid", "32", "--frames", "3"};

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(SimulateTool, LeavesAFolderThatSaysWhatItsNumbersMean) {
  const WorkFolder folder;
  const auto run = [&](std::vector<std::string> more = {}) {
    return folder.freshet(with(with({"synth", "simulate", "plume", "-o", "plume"}, kSmall), more));
  };
  Outcome outcome = run();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* name : {"alpha/00000.png", "alpha/00002.png", "flow/00000.flo", "flow/00002.exr",
                           "emitters/00001.png", "preview.mp4", "scene.toml"})
    EXPECT_TRUE(fs::exists(folder / "plume" / name)) << name;
  EXPECT_FALSE(fs::exists(folder / "plume/alpha/00003.png"));
  const cv::Mat alpha = cv::imread((folder / "plume/alpha/00002.png").string(), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(alpha.type(), CV_8U);
  EXPECT_EQ(alpha.size(), cv::Size(96, 64));
  const auto description = nlohmann::json::parse(text_of(folder / "plume/design.json"));
  EXPECT_EQ(description["frames"], 3);
  EXPECT_EQ(description["first_number"], 0);
  EXPECT_EQ(description["emitters"]["frames_with"].size(), 3u);
  EXPECT_EQ(description["emitters"]["names"][0], "vent");

  // Made again, it holds the same, and nothing of the longer one before it.
  folder.file("plume/alpha/00003.png", "old");
  EXPECT_NE(run().err.find("plume: something lies in this folder, and is kept"), std::string::npos);
  const std::string before = text_of(folder / "plume/flow/00002.flo");
  outcome = run({"--overwrite"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_FALSE(fs::exists(folder / "plume/alpha/00003.png"));
  EXPECT_EQ(text_of(folder / "plume/flow/00002.flo"), before);
}

TEST(SimulateTool, LeavesAFolderOfSomethingElseAlone) {
  const WorkFolder folder;
  fs::create_directory(folder / "mine");
  folder.file("mine/letter.txt", "dear");
  const Outcome outcome =
      folder.freshet(with({"synth", "simulate", "plume", "-o", "mine", "--overwrite"}, kSmall));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("something else than a design"), std::string::npos) << outcome.err;
  EXPECT_EQ(text_of(folder / "mine/letter.txt"), "dear");
  EXPECT_FALSE(fs::exists(folder / "mine/alpha"));
}

TEST(SimulateTool, APrintedPresetIsASceneThatGivesTheSame) {
  const WorkFolder folder;
  const Outcome printed = folder.freshet({"synth", "simulate", "--print-scene", "fireball"});
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  folder.file("mine.toml", printed.out);
  const auto flow = [&](const std::string& scene, const std::string& out) {
    const Outcome outcome =
        folder.freshet(with({"synth", "simulate", scene, "-o", out, "--alpha-bits", "16"}, kSmall));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return text_of(folder / out / "flow/00002.flo");
  };
  EXPECT_EQ(flow("mine.toml", "a"), flow("fireball", "b"));
  EXPECT_EQ(cv::imread((folder / "a/alpha/00002.png").string(), cv::IMREAD_UNCHANGED).type(), CV_16U);
}

TEST(SimulateTool, AFaultOfASceneNamesFileAndLine) {
  const WorkFolder folder;
  folder.file("bad.toml",
              "frames = 3\n[[emitter]]\nshape = \"disc\"\nplace = [0.5, 0.5]\nposition = [0.5, 0.5]\n");
  Outcome outcome = folder.freshet({"synth", "simulate", "bad.toml", "-o", "out"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("bad.toml:4: emitter 1.place: no such key"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(folder / "out"));
  outcome = folder.freshet({"synth", "simulate", "absent.toml", "-o", "out"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("absent.toml: there is no such file"), std::string::npos) << outcome.err;
  EXPECT_EQ(folder.freshet({"synth", "simulate", "fire", "-o", "a.mkv", "--grid", "64"}).exit_code, 2);
  EXPECT_EQ(folder.freshet({"synth", "simulate", "fire", "-o", "a.mkv", "--motion", "a.flo"}).exit_code, 2);
}

}  // namespace
}  // namespace freshet::tools
