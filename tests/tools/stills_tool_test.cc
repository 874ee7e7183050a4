// freshet synth stills from end to end, and what it answers to bad input.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

class StillsTool : public testing::Test {
 protected:
  StillsTool() {
    fs::create_directory(folder_ / "stills");
    cv::Mat ground(96, 160, CV_8UC3);
    cv::RNG random(5);
    random.fill(ground, cv::RNG::UNIFORM, 20, 120);
    cv::GaussianBlur(ground, ground, {}, 2);
    const int order[5] = {3, 0, 4, 1, 2};
    for (int i = 0; i < 5; ++i) {
      cv::Mat still = ground.clone();
      cv::circle(still, {40 + 20 * order[i], 48}, 14, cv::Scalar(210, 230, 250), cv::FILLED, cv::LINE_AA);
      cv::imwrite(folder_ / ("stills/" + std::to_string(i) + ".png"), still);
    }
  }
  Outcome stills(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"synth", "stills", "stills", "--seconds", "1", "--fps", "8"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder_.freshet(arguments);
  }
  const WorkFolder folder_;
};

TEST_F(StillsTool, MakesALoopWithAPageASheetAndJson) {
  const Outcome made = stills({"-o", "out/%05d.png", "--loop", "--json", "--page", "page.html", "--sheet",
                               "sheet.png", "--cache", "kept"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const nlohmann::json report = nlohmann::json::parse(made.out);
  ASSERT_EQ(report["paths"].size(), 1u);
  nlohmann::json path = report["paths"][0];
  if (path[0] != "1.png") std::reverse(path.begin(), path.end());
  EXPECT_EQ(path, (nlohmann::json{"1.png", "3.png", "4.png", "0.png", "2.png"}));
  EXPECT_EQ(report["sequence"].front(), report["sequence"].back());
  EXPECT_EQ(report["regions"][0]["kind"], "independent");
  EXPECT_EQ(read_frames(folder_ / "out").size(), 8u);
  EXPECT_NE(text_of(folder_ / "page.html").find("<svg"), std::string::npos);
  EXPECT_FALSE(cv::imread(folder_ / "sheet.png").empty());

  // With an edit, from the kept flow.
  folder_.file("edits.toml", "speed = 0.5\n");
  EXPECT_EQ(stills({"-o", "slow/%05d.png", "--edits", "edits.toml", "--cache", "kept"}).exit_code, 0);
  // And the flow that is kept changes nothing.
  EXPECT_EQ(stills({"-o", "again/%05d.png", "--loop", "--cache", "kept"}).exit_code, 0);
  const std::vector<cv::Mat> first = read_frames(folder_ / "out"), again = read_frames(folder_ / "again");
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(cv::norm(first[i], again[i], cv::NORM_INF), 0);
}

TEST_F(StillsTool, PinsChangeTheFramesBetweenTheirStillsAndAreRefusedByName) {
  const std::string order = "sequence = [\"3.png\", \"2.png\"]\n";
  const auto frames = [&](const std::string& edits, const std::string& out) {
    folder_.file("edits.toml", edits);
    const Outcome made = stills({"-o", out + "/%05d.png", "--one-region", "--edits", "edits.toml"});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return read_frames(folder_ / out);
  };
  // Its disc has gone 60 px.
  const std::string pin =
      "[[pin]]\nfrom = \"3.png\"\nto = \"2.png\"\nat = [60, 48]\ngoes = [120, 48]\nreach = 30\n";
  const std::vector<cv::Mat> without = frames(order, "without"), with = frames(order + pin, "with");
  ASSERT_EQ(with.size(), without.size());
  EXPECT_EQ(cv::norm(without[0], with[0], cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(without[2], with[2], cv::NORM_INF), 50);

  folder_.file("edits.toml", "[[pin]]\nfrom = \"3.png\"\nto = \"2.png\"\nat = [60, 48]\ngoes = [400, 48]\n");
  const Outcome refused = stills({"-o", "o.mkv", "--edits", "edits.toml"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(
      refused.err.find("pin 1 (3.png to 2.png): goes: [400, 48] lies outside 2.png, which is 160 x 96 px"),
      std::string::npos)
      << refused.err;
  EXPECT_FALSE(fs::exists(folder_ / "o.mkv"));
}

TEST_F(StillsTool, BadInputIsSaidAndLeavesNothing) {
  const auto refused = [&](const Outcome& outcome, const std::string& word, int code) {
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(folder_ / "o.mkv"));
  };
  const auto run = [&](const std::string& name) {
    return folder_.freshet({"synth", "stills", name, "-o", "o.mkv", "--seconds", "1"});
  };
  refused(run("nowhere"), "nowhere", 1);
  refused(stills({"-o", "o.mkv", "--regions", "x.png", "--one-region"}), "more than once", 2);
  refused(stills({"-o", "o.mkv", "--edits", "none.toml"}), "none.toml", 1);
  fs::create_directory(folder_ / "same");
  for (const char* name : {"a.png", "b.png", "c.png"}) {
    cv::Mat still = cv::imread(folder_ / "stills/0.png");
    still.at<cv::Vec3b>(0, name[0] - 'a')[0] ^= 1;
    cv::imwrite(folder_ / ("same/" + std::string(name)), still);
  }
  refused(run("same"), "nothing moves", 1);
}

TEST_F(StillsTool, PrintsItsKeys) {
  const Outcome keys = folder_.freshet({"synth", "stills", "--keys"});
  EXPECT_EQ(keys.exit_code, 0) << keys.err;
  EXPECT_NE(keys.out.find("irregularity"), std::string::npos);
  EXPECT_NE(keys.out.find("[[pin]]"), std::string::npos);
}

}  // namespace
}  // namespace freshet::tools
